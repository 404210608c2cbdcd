#include "haptic_client/evaluation/between_samples.h"

#include <algorithm>
#include <cmath>

#include "common/ages.h"
#include "haptic_client/extrapolation/local_contact.h"

namespace palpate::client {
namespace {

constexpr double kNoPath = 1e-9;      // m: the tool rests
constexpr double kLeastDepth = 1e-7;  // m: a plane that is met by less says nothing of how force grows
constexpr double kMostPower = 3;      // of the depth
// How far the model may be off at a sample: of the larger force there, or of the largest at both.
constexpr double kBelievable = LocalContact::kBelievable, kAlways = 0.02;

double smooth(double s) {
  return s * s * (3 - 2 * s);
}

/// The slope of a sample, or nothing that can be used.
const Linearisation* slope(const Sample& sample) {
  return sample.at_tool && usable(*sample.at_tool) ? &*sample.at_tool : nullptr;
}

}  // namespace

std::string_view name_of(ReferenceKind kind) noexcept {
  constexpr std::array<std::string_view, kReferenceKinds> kNames{"line", "hermite", "contact"};
  return kNames[static_cast<std::size_t>(kind)];
}

BetweenSamples::BetweenSamples(const Sample& before, const Sample& after) noexcept
    : before_(before), after_(after), end_(after.p - organ(after.t) - before.p), place_(before.p) {
  missed_ = after.f - before.f;
  if (has_slopes()) missed_ -= 0.5 * (before.at_tool->tangent + after.at_tool->tangent) * end_;
}

/// Returns how far the organ has moved since t_n, m: as the velocities say, and to where it really came.
Vec3 BetweenSamples::organ(Time t) const noexcept {
  if (slope(before_) == nullptr || slope(after_) == nullptr) return Vec3::Zero();
  const double u = fraction(t), period = to_seconds(after_.t - before_.t);
  const Vec3 &v = before_.surface_v, faster = after_.surface_v - v;
  const Vec3 moved = period * (u * v + 0.5 * u * u * faster);
  if (!before_.surface || !after_.surface) return moved;
  return moved + smooth(u) * (after_.surface->shift - before_.surface->shift - period * (v + 0.5 * faster));
}

void BetweenSamples::add(const PathTick& tick) noexcept {
  if (!first_) first_ = tick;
  solved_ = solved_ && tick.contact;
  const Vec3 x = on_organ(tick);
  length_ += (x - place_).norm();
  place_ = x;
}

void BetweenSamples::close(const PathTick& last) noexcept {
  length_ += (before_.p + end_ - place_).norm();
  place_ = before_.p;
  kind_ = ReferenceKind::kLine;
  if (has_slopes()) kind_ = ReferenceKind::kHermite;
  if (solved_ && first_ && last.contact && ends_agree(last)) kind_ = ReferenceKind::kContact;
}

Vec3 BetweenSamples::at(const PathTick& tick) noexcept {
  const Vec3 x = on_organ(tick);
  done_ += (x - place_).norm();
  place_ = x;
  if (kind_ == ReferenceKind::kLine) return line(tick.t);
  const Vec3 f = kind_ == ReferenceKind::kContact
                     ? contact(tick)
                     : hermite(x, length_ > kNoPath ? std::min(done_ / length_, 1.0) : fraction(tick.t));
  return f.allFinite() ? f : line(tick.t);
}

/// True if both ends have slopes, and these lead from one to the other better than nothing does.
bool BetweenSamples::has_slopes() const noexcept {
  const Linearisation *first = slope(before_), *there = slope(after_);
  if (first == nullptr || there == nullptr) return false;
  const bool pushed = !before_.f.isZero(0), pushes = !after_.f.isZero(0);
  if (!pushed && !pushes) return true;
  if (pushed && pushes) {
    const double changed = (after_.f - before_.f).norm();
    const Vec3 missed = after_.f - before_.f - 0.5 * (first->tangent + there->tangent) * end_;
    return missed.norm() <=
           std::max({changed, (first->tangent * end_).norm(), (there->tangent * end_).norm()});
  }
  const Linearisation &free = pushed ? *there : *first, &touching = pushed ? *first : *there;
  const double depth = -(free.gap + free.normal_W.dot(pushed ? Vec3(-end_) : end_));
  return depth > kLeastDepth && -touching.f_W.dot(touching.tangent * free.normal_W) > 0;
}

Vec3 BetweenSamples::hermite(const Vec3& x, double fraction) const noexcept {
  const bool pushed = !before_.f.isZero(0), pushes = !after_.f.isZero(0);
  if (!pushed && !pushes) return Vec3::Zero();
  if (!pushed || !pushes) return onset(x);
  const Mat3 &k = before_.at_tool->tangent, stiffer = after_.at_tool->tangent - k;
  const Vec3 d = x - before_.p;
  return before_.f + k * d + fraction * (stiffer * (d - 0.5 * fraction * end_)) + smooth(fraction) * missed_;
}

/// The tool is free at one of the samples, and touches at the other.
Vec3 BetweenSamples::onset(const Vec3& x) const noexcept {
  const bool leaves = !before_.f.isZero(0);
  const Linearisation &free = leaves ? *after_.at_tool : *before_.at_tool,
                      &touching = leaves ? *before_.at_tool : *after_.at_tool;
  const Vec3& f = leaves ? before_.f : after_.f;
  const Vec3 free_at = leaves ? Vec3(before_.p + end_) : before_.p,
             touching_at = leaves ? before_.p : Vec3(before_.p + end_);
  const auto depth = [&](const Vec3& p) { return -(free.gap + free.normal_W.dot(p - free_at)); };
  const double deepest = depth(touching_at);
  const double power = -f.dot(touching.tangent * free.normal_W) * deepest / f.squaredNorm();
  return std::pow(std::max(depth(x), 0.0) / deepest, std::clamp(power, 1.0, kMostPower)) * f;
}

/// Returns what the model says at a tick, with the organ where it really was.
Vec3 BetweenSamples::local(const PathTick& tick) const noexcept {
  const PathTick::Contact& contact = *tick.contact;
  if (contact.force.isZero(0)) return contact.force;
  const Vec3 shift = before_.surface->shift + organ(tick.t);
  const Vec3 f = contact.force + contact.tangent * (contact.shift - shift);
  return f.dot(contact.force) > 0 ? f : Vec3(Vec3::Zero());
}

BetweenSamples::End BetweenSamples::end_of(const PathTick& tick, const Sample& sample) const noexcept {
  End end{.f = sample.f, .local = local(tick), .across = Vec3::Zero()};
  if (!end.local.isZero(0)) {
    const Vec3 off = sample.p - organ(sample.t) - on_organ(tick);
    end.local += tick.contact->tangent * off;
  }
  end.size = end.local.norm();
  end.pushes = !sample.f.isZero(0) && end.size > 0;
  if (end.pushes) {
    end.kappa = sample.f.dot(end.local) / (end.size * end.size);
    end.across = sample.f - end.kappa * end.local;
  }
  return end;
}

/// True if the model is about right at both samples, so that it may be believed between them.
bool BetweenSamples::ends_agree(const PathTick& last) noexcept {
  if (!before_.surface || !after_.surface || slope(before_) == nullptr || slope(after_) == nullptr)
    return false;
  const auto near = [&](const PathTick& tick, const Sample& sample) {
    return (tick.t > sample.t ? tick.t - sample.t : sample.t - tick.t) <= kTickGap &&
           (sample.p - organ(sample.t) - on_organ(tick)).norm() <= LocalContact::kTangentReach;
  };
  if (!near(*first_, before_) || !near(last, after_)) return false;
  ends_[0] = end_of(*first_, before_);
  ends_[1] = end_of(last, after_);
  const double largest = std::max(before_.f.norm(), after_.f.norm());
  return std::all_of(std::begin(ends_), std::end(ends_), [&](const End& end) {
    return (end.local - end.f).norm() <=
           std::max(kBelievable * std::max(end.f.norm(), end.size), kAlways * largest);
  });
}

Vec3 BetweenSamples::corrected(const End& end, const Vec3& local) noexcept {
  return end.kappa * local + std::min(LocalContact::kMostCorrection, local.norm() / end.size) * end.across;
}

Vec3 BetweenSamples::contact(const PathTick& tick) const noexcept {
  const Vec3 f = local(tick);
  const auto& [before, after] = ends_;
  if (!before.pushes && !after.pushes) return f;
  if (!before.pushes || !after.pushes) return corrected(before.pushes ? before : after, f);
  const double u = fraction(tick.t);
  return (1 - u) * corrected(before, f) + u * corrected(after, f);
}

}  // namespace palpate::client
