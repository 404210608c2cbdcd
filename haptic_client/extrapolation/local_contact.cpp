#include "haptic_client/extrapolation/local_contact.h"

#include <algorithm>

namespace palpate::client {
namespace {
// Of the largest force: below it, F_loc says little of how wrong the model is.
constexpr double kDoubt = 0.02;
constexpr double kFirm = 0.7;  // of the largest force: a touch that tells of the factor where tissue swings
constexpr double kFraction = 0.25, kMaxChange = 0.2;  // and how much of what it tells counts
constexpr double kAlways = 0.1;                       // N: an error that is never too large

constexpr std::uint64_t kNoSolve = ~std::uint64_t{0};  // no number of a solve

bool believable(const Vec3& local, const Vec3& right) noexcept {
  return (local - right).norm() <= LocalContact::kBelievable * std::max(local.norm(), right.norm()) + kAlways;
}
}  // namespace

void LocalContact::update(const Sample& sample) noexcept {
  without_.update(sample);
  if (!usable(sample) || (newest_.number > 0 && sample.t <= newest_.t)) return;
  newest_ = with_usable_parts(sample);
  if (swings() && newest_.others) {  // the modes know better what they do
    newest_.surface_v -= newest_.others->v_W;
    newest_.others.reset();
  }
  rendered_last_ = newest_.f;
  motion_.update(newest_);
  known_ = following_ = false;
  if (!swings()) {
    memory_.restart();
    swing_.setZero();
  }
  if (!newest_.surface || (swings() && !take_modes())) {
    rendered_.forget();
    memory_.restart();
    return;
  }
  const Vec3 p_rest = at_rest(sample.p, sample.t);
  auto local = stored(sample.t, p_rest + swing_ - memory_.drift());
  if (!local && newest_.surface->tool.friction > 0) {  // nothing to compare yet
    following_ = true;
    return;
  }
  if (!local) local = contact_.probe(*newest_.surface, p_rest, memory());
  known_ = local && believable(*local, sample.f);
  if (!known_) {
    contact_.separate();  // perhaps on a wrong side: it enters anew, where it is by then
    rendered_
        .forget();  // the path is lost, and with it what sticks: it is no measure of what would be from here
    memory_.restart();
    return;
  }
  if (swings()) {
    compare_swinging(*local);
    return;
  }
  compare(*local);
  const bool free = local->isZero(0) && sample.f.isZero(0);
  if (free && newest_.surface->tool.friction == 0) compare_ahead();
}

void LocalContact::store(Time t, const Vec3& p_rest, const Vec3& local) noexcept {
  if (Rendered* const rendered = rendered_.add(t)) *rendered = {p_rest, local, contact_.tangent()};
}

/// The force rendered at the tick of time `t`, or the one before it; at `p_rest`, which is where the tool is
/// thought to have been by now.
std::optional<Vec3> LocalContact::stored(Time t, const Vec3& p_rest) const noexcept {
  const Rendered* const rendered = rendered_.at(t);
  if (rendered == nullptr || (rendered->p_rest - p_rest).norm() > kTangentReach) return {};
  if (rendered->force.isZero(0)) return rendered->force;
  const Vec3 force = rendered->force + rendered->tangent * (p_rest - rendered->p_rest);
  return force.dot(rendered->force) > 0 ? force : Vec3(Vec3::Zero());
}

/// Updates the correction factor: the server found the force `right` where the model found `local`.
void LocalContact::learn_factor(const Vec3& right, const Vec3& local) noexcept {
  largest_ = std::max(largest_, right.norm());
  const double doubt = kDoubt * largest_ * kDoubt * largest_;  // a light touch tells little of the factor
  const double factor = (right.dot(local) + doubt * kappa_) / (local.squaredNorm() + doubt);
  kappa_ = std::clamp(factor, 1 / kMostCorrection, kMostCorrection);
}

/// Compares the model with a sample while the tissue swings. The error of a light touch is inertia that the
/// model does not have, and soon gone; that of a firm one is the law of the tissue. Which of both the first
/// touches are is not known yet: little of each counts.
void LocalContact::compare_swinging(const Vec3& local) noexcept {
  local_size_ = 0;
  remainder_.setZero();
  if (newest_.f.norm() <= kFirm * largest_) return;
  const double before = kappa_;
  learn_factor(newest_.f, local);
  kappa_ = before + kFraction * std::clamp(kappa_ - before, -kMaxChange, kMaxChange);
}

void LocalContact::compare(const Vec3& local) noexcept {
  local_size_ = local.norm();
  remainder_.setZero();
  if (!(local_size_ > 0) || newest_.f.isZero(0)) return;
  learn_factor(newest_.f, local);
  remainder_ = newest_.f - kappa_ * local;
}

/// The tool is free, but was expected to touch by now: the server has said what it would feel.
void LocalContact::compare_ahead() noexcept {
  if (!newest_.ahead || !newest_.ahead->f_W.allFinite() || newest_.ahead->f_W.isZero(0)) return;
  const auto local = contact_.probe(*newest_.surface, at_rest(newest_.ahead->p_W, newest_.t), memory());
  if (local && !local->isZero(0) && believable(*local, newest_.ahead->f_W))
    learn_factor(newest_.ahead->f_W, *local);
}

void LocalContact::restart() noexcept {
  without_.restart();
  contact_.separate();
  rendered_.forget();
  now_ = {};
  newest_ = {};
  motion_.restart();
  memory_.restart();
  swing_.setZero();
  known_ = following_ = false;
  kappa_ = 1;
  largest_ = 0;
}

Vec3 LocalContact::force(const Vec3& p, Time t) noexcept {
  if (!known_ && !following_) return without_.force(p, t);
  const auto local = follow(p, t);
  if (!local) {
    known_ = following_ = false;  // until the next sample: no going back and forth
    rendered_.forget();
    memory_.restart();
    return without_.force(p, t);
  }
  if (known_) {
    rendered_last_ = kappa_ * *local;
    if (local_size_ > 0)
      rendered_last_ += std::min(kMostCorrection, local->norm() / local_size_) * remainder_;
  }
  if (swings()) memory_.apply_loads(rendered_last_, contact_.loads());
  return known_ ? rendered_last_ : without_.force(p, t);
}

/// F_loc at the tick, remembered; nothing where it is not known.
std::optional<Vec3> LocalContact::follow(const Vec3& p, Time t) noexcept {
  const Time now = std::max(now_, t);
  if (swings()) {
    memory_.advance(now);
    if (!memory_.known()) return {};
    swing_ = memory_.displacement();
  }
  const Vec3 p_rest = at_rest(p, t) - moved_by_others(rendered_last_);
  const auto local = contact_.move_to(*newest_.surface, p_rest, memory());
  if (!local || (swings() && !find_footing(p_rest))) return {};
  store(now, p_rest + swing_, *local);
  return local;
}

/// Takes over where the newest sample says that the published modes are.
bool LocalContact::take_modes() noexcept {
  const Surface& surface = *newest_.surface;
  if (!memory_.is_placed() && !memory_.place_near(*surface.model, newest_.p - surface.shift)) return false;
  if (!memory_.take(surface, newest_.t, newest_.f)) return false;
  swing_ = memory_.displacement();
  bearing_ = kNoSolve;  // it may have begun anew
  return true;
}

/// Finds where the published modes hold and bear the surface that is near now, for the ticks to come.
bool LocalContact::find_footing(const Vec3& p_rest) noexcept {
  const SurfaceModel& model = *newest_.surface->model;
  if (!memory_.place_near(model, p_rest)) return false;
  contact_.rename(swing_ - memory_.displacement());  // 0 where it stands as before
  if (bearing_ == contact_.solves()) return true;
  bearing_ = contact_.solves();
  return memory_.carry(model, contact_.loads());
}

/// Returns where `p` is when the organ is at rest.
Vec3 LocalContact::at_rest(const Vec3& p, Time t) const noexcept {
  return p - newest_.surface->shift - motion_.since_sample(t) - swing_;
}

/// Returns how far the other tools give way to what this one pressed with, `rendered` (N), at the last tick.
Vec3 LocalContact::moved_by_others(const Vec3& rendered) const noexcept {
  if (!newest_.others) return Vec3::Zero();
  const Vec3 change = newest_.others->compliance * (newest_.f - rendered);
  return change * std::min(1.0, kTangentReach / change.norm());
}

}  // namespace palpate::client
