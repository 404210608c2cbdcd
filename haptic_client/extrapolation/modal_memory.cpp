#include "haptic_client/extrapolation/modal_memory.h"

#include <algorithm>
#include <limits>

namespace palpate::client {
namespace {
constexpr Time kStep = std::chrono::microseconds(500);  // what remains to a tick is by Taylor's series
constexpr Time kLongest = std::chrono::milliseconds(300);
constexpr double kFarthestSwing = 0.2;  // m: no organ swings so far
constexpr double kSamePlace = 1e-3;     // m
}  // namespace

ModalMemory::ModalMemory() = default;

void ModalMemory::restart() noexcept {
  known_ = standing_ = false;
  past_.forget();
}

bool ModalMemory::take_spectrum(const Surface& surface) noexcept {
  const auto spectrum = surface.model->spectrum();
  if (spectrum.size() != static_cast<std::size_t>(surface.modes.count)) return false;
  if (version_ == surface.model->generation()) return true;
  version_ = surface.model->generation();
  known_ = false;
  past_.forget();
  count_ = spectrum.size();
  for (std::size_t k = 0; k < count_; ++k) {
    w_[k] = spectrum[k].frequency;
    damping_[k] = spectrum[k].damping;
    const ModeStep step = ModeStep::over(to_seconds(kStep), w_[k], damping_[k]);
    q_of_q_[k] = step.q_of_q, q_of_v_[k] = step.q_of_v, q_of_p_[k] = step.q_of_p;
    v_of_q_[k] = step.v_of_q, v_of_v_[k] = step.v_of_v, v_of_p_[k] = step.v_of_p;
  }
  return true;
}

bool ModalMemory::take(const Surface& surface, Time t, const Vec3& f) noexcept {
  if (!take_spectrum(surface) || !standing_ || foot_version_ != version_) {
    restart();
    return false;
  }
  for (std::size_t k = 0; k < count_; ++k) {
    told_.q[k] = static_cast<double>(surface.modes.q[k]);
    told_.v[k] = static_cast<double>(surface.modes.v[k]);
  }
  if (at(told_.q).norm() > kFarthestSwing) {
    restart();
    return false;
  }
  drift_.setZero();
  const State* before = past_.at(t);
  State here;
  if (known_ && t > tick_) {  // without delay, the sample of this very tick
    advance(t);
    before = &(here = now(t));
  }
  present_ = told_.q;
  if (known_ && before != nullptr) {
    correct(*before, t);
    compared_ = t;
    if (!(at(state_.q).norm() <= kFarthestSwing)) begin(t, f);
  } else if (!known_ || t - compared_ > kLongest) {
    begin(t, f);
  }  // else it stood nowhere yet at that time
  return known_ = true;
}

void ModalMemory::begin(Time t, const Vec3& f) noexcept {
  state_ = told_;
  time_ = tick_ = tick_before_ = compared_ = t;
  bearing_ = foot_;
  force_ = force_of(f);
  corrections_ = {};
  past_.forget();
}

/// What the modes were off by at the tick of the sample goes on by itself, without any force. What was known
/// of that by now, from samples that came since that tick, is not counted twice.
void ModalMemory::correct(const State& before, Time t) noexcept {
  drift_ = at(told_.q) - at(before.q);
  Correction& correction = corrections_[next_correction_++ % corrections_.size()];
  State off;
  for (std::size_t k = 0; k < count_; ++k) {
    off.q[k] = told_.q[k] - before.q[k];
    off.v[k] = told_.v[k] - before.v[k];
  }
  for (const Correction& known : corrections_) {
    if (known.made <= t || &known == &correction) continue;
    const State gone_on = free_motion(known.off, t - known.of);
    for (std::size_t k = 0; k < count_; ++k) {
      off.q[k] -= gone_on.q[k];
      off.v[k] -= gone_on.v[k];
    }
  }
  correction = {t, tick_, off};
  const State now = free_motion(off, time_ - t);
  for (std::size_t k = 0; k < count_; ++k) {
    state_.q[k] += now.q[k];
    state_.v[k] += now.v[k];
  }
}

ModalMemory::State ModalMemory::free_motion(State state, Time time) const noexcept {
  const double seconds = to_seconds(time);
  for (std::size_t k = 0; k < count_; ++k)
    ModeStep::over(seconds, w_[k], damping_[k]).advance(state.q[k], state.v[k], 0);
  return state;
}

bool ModalMemory::bear(const SurfaceModel& model, std::span<const SurfaceLoad> loads) noexcept {
  Vec3 sum = Vec3::Zero();
  for (const SurfaceLoad& load : loads) sum += load.force;
  const double size = sum.squaredNorm();
  if (!(size > 0)) {
    bearing_ = foot_;
    return standing_;
  }
  std::fill_n(bearing_.begin(), count_, Vec3::Zero());
  return std::all_of(loads.begin(), loads.end(), [&](const SurfaceLoad& load) {
    return model.add_shapes(load.vertex, load.force.dot(sum) / size, bearing_);
  });
}

bool ModalMemory::stand_near(const SurfaceModel& model, const Vec3& p_rest) noexcept {
  if (standing_ && foot_version_ == model.generation() && (p_rest - foot_at_).norm() < kSamePlace)
    return true;
  if (!model.has_shape()) return standing_ = false;
  const auto rest = model.rest();
  int nearest = -1;
  double least = std::numeric_limits<double>::max();
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const double distance = (rest[v] - p_rest).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = static_cast<int>(v);
  }
  foot_at_ = p_rest;
  foot_version_ = model.generation();
  std::fill(foot_.begin(), foot_.end(), Vec3::Zero());
  return standing_ = nearest >= 0 && model.add_shapes(nearest, 1, foot_);
}

Vec3 ModalMemory::at(const Numbers& q) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < count_; ++k) sum += q[k] * foot_[k];
  return sum;
}

/// Of a force on the tool; the tissue feels the opposite.
ModalMemory::Numbers ModalMemory::force_of(const Vec3& f) const noexcept {
  Numbers force{};
  for (std::size_t k = 0; k < count_; ++k) force[k] = -f.dot(bearing_[k]);
  return force;
}

void ModalMemory::advance(Time t) noexcept {
  if (t - time_ > kLongest) return restart();
  auto& [q, v] = state_;
  for (; time_ + kStep <= t; time_ += kStep) {
    for (std::size_t k = 0; k < count_; ++k) {
      const double from = q[k];
      q[k] = q_of_q_[k] * from + q_of_v_[k] * v[k] + q_of_p_[k] * force_[k];
      v[k] = v_of_q_[k] * from + v_of_v_[k] * v[k] + v_of_p_[k] * force_[k];
    }
  }
  if (t > tick_) tick_before_ = tick_;  // else once more at the same tick, after a sample came
  tick_ = t;
  present_ = now(t).q;
}

/// At a time up to a step after `time_`.
ModalMemory::State ModalMemory::now(Time t) const noexcept {
  const double rest = to_seconds(t - time_);
  State at = state_;
  for (std::size_t k = 0; k < count_; ++k) {
    const double a = force_[k] - w_[k] * w_[k] * at.q[k] - damping_[k] * at.v[k];
    at.q[k] += rest * (at.v[k] + 0.5 * rest * a);
    at.v[k] += rest * a;
  }
  return at;
}

void ModalMemory::press(const Vec3& f) noexcept {
  // From the last tick to this one the force went from the last to this, not all at once: the mean counts.
  const Numbers force = force_of(f);
  const double half = 0.5 * to_seconds(tick_ - tick_before_);
  for (std::size_t k = 0; k < count_; ++k) state_.v[k] += half * (force[k] - force_[k]);
  if (State* const tick = past_.add(tick_)) *tick = now(tick_);
  force_ = force;
}

}  // namespace palpate::client
