#include "common/force_jumps.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/ages.h"

namespace palpate {
namespace {

constexpr double kCounts = 0.05;                    // of the peak
constexpr double kWithin = 0.5e-3, kAround = 1e-3;  // s
constexpr double kGapSamples = 1.5;                 // more: a sample is missing

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double squared = along.squaredNorm();
  const double fraction = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0;
  return (p - a - fraction * along).norm();
}

/// The tangent of a sample that is free says how stiff contact will be, which explains nothing alone.
Vec3 explained(const PublishedForce& sample, const Vec3& d) {
  return sample.f.isZero(0) ? Vec3::Zero() : Vec3(*sample.tangent * d);
}

std::size_t samples_in(double seconds, double rate_hz) {
  return std::max<std::size_t>(static_cast<std::size_t>(std::lround(seconds * rate_hz)), 1);
}

}  // namespace

void add_to(Json& report, const std::string& name, const std::optional<ForceJumps>& jumps) {
  if (!jumps) return;
  report[name + "s"] = jumps->count;
  report["largest_" + name + "_percent"] = jumps->largest_percent;
}

std::optional<ForceJumps> jumps_in(const Json& report, const std::string& name) {
  const auto count = report.find(name + "s");
  if (count == report.end() || count->is_null()) return std::nullopt;
  return ForceJumps{count->get<std::uint64_t>(), report.at("largest_" + name + "_percent").get<double>()};
}

std::string snaps_text(const ForceJumps& snaps) {
  return fmt::format("the force of the simulation itself jumped {} times, largest {:.1f} % of peak",
                     snaps.count, snaps.largest_percent);
}

std::string unexplained_text(const ForceJumps& jumps) {
  return fmt::format(
      "between two samples the force of the simulation jumped {} times by more than 5 % of peak beyond what "
      "the published tangents explain, largest {:.1f} %",
      jumps.count, jumps.largest_percent);
}

void JumpSizes::add(double newton) noexcept {
  if (!std::isfinite(newton)) return;
  largest_ = std::max(largest_, newton);
  nN_.add(static_cast<std::int64_t>(std::min(newton, 1e9) * 1e9));
}

void JumpSizes::see_force(double newton) noexcept {
  peak_ = std::max(peak_, newton);
}

std::optional<ForceJumps> JumpSizes::of_peak() const noexcept {
  if (!(peak_ > 0)) return {};
  const auto least = static_cast<std::int64_t>(kCounts * std::min(peak_, 1e9) * 1e9);
  return ForceJumps{static_cast<std::uint64_t>(nN_.count_above(least)), 100 * largest_ / peak_};
}

SnapCounter::SnapCounter(double rate_hz)
    : gap_(from_seconds(kGapSamples / std::max(rate_hz, 1.0))),
      within_(samples_in(kWithin, rate_hz)),
      around_(samples_in(kAround, rate_hz)),
      ring_(rate_hz >= kLeastRate ? within_ + 2 * around_ + 1 : 0, Vec3::Zero()) {}

void SnapCounter::add(const Vec3& force, Time t) {
  if (ring_.empty()) return;
  if (added_ > 0 && t - last_ > gap_) {
    sizes_.add(candidate_);
    added_ = candidate_at_ = 0;
    candidate_ = 0;
  }
  last_ = t;
  ring_[added_++ % ring_.size()] = force;
  sizes_.see_force(force.norm());
  if (added_ < ring_.size()) return;
  const double change = unexplained();
  if (added_ - candidate_at_ > within_) {
    sizes_.add(candidate_);
  } else if (change <= candidate_) {
    return;
  }
  candidate_ = change;
  candidate_at_ = added_;
}

std::optional<ForceJumps> SnapCounter::snaps() const {
  if (ring_.empty()) return {};
  JumpSizes all = sizes_;
  all.add(candidate_);
  return all.of_peak();
}

/// Returns the part of the change from 1.5 to 1 ms ago that the changes before and after do not explain, N.
double SnapCounter::unexplained() const {
  const double share = static_cast<double>(within_) / static_cast<double>(around_);
  const Vec3 &before = back(2 * around_ + within_), &begin = back(around_ + within_), &end = back(around_),
             &after = back(0);
  return distance_to_segment(end - begin, share * (begin - before), share * (after - end));
}

void UnexplainedJumps::add(const PublishedForce& sample) noexcept {
  sizes_.see_force(sample.f.norm());
  const std::optional<PublishedForce> before = std::exchange(last_, sample);
  if (!before || !before->tangent || !sample.tangent) return;
  if (sample.number <= before->number || sample.cuts != before->cuts) return;
  const Time passed = sample.t - before->t;
  if (passed <= Time::zero() || passed > kOutage) return;
  const Vec3 organ = 0.5 * to_seconds(passed) * (before->surface_v + sample.surface_v);
  const Vec3 d = sample.p - before->p - organ;
  sizes_.add(distance_to_segment(sample.f - before->f, explained(*before, d), explained(sample, d)));
  ++pairs_;
}

std::optional<ForceJumps> UnexplainedJumps::jumps() const noexcept {
  return pairs_ > 0 ? sizes_.of_peak() : std::nullopt;
}

}  // namespace palpate
