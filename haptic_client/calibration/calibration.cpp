#include "haptic_client/calibration/calibration.h"

#include <algorithm>
#include <cmath>

#include "common/ages.h"

namespace palpate::client {
namespace {

using Stage = CalibrationStage;
using Trouble = CalibrationTrouble;

constexpr double kLongestLoss = 1;      // s
constexpr double kForceFilter = 0.3;    // s, while the weight is awaited
constexpr double kLeastFraction = 0.5;  // of m g, as assumed: a weight hangs there
constexpr double kLetDown = 2;          // s
constexpr double kToSpare = 1.25;       // of what is plausible, for what is measured

/// s, until a stage is given up.
double patience_in(Stage stage) {
  if (stage == Stage::kHome) return 120;
  return stage == Stage::kLetDown ? kLetDown : 60;
}

}  // namespace

Calibration::Calibration(const Settings& settings)
    : settings_(settings), limiter_(settings.limits), holder_(settings.limits.max_force) {}

void Calibration::enter(Stage stage) noexcept {
  stage_ = stage;
  in_stage_ = 0;
  if (stage == Stage::kWeighGrip) grip_ = {};
  if (stage == Stage::kWeighBoth) both_ = {};
}

void Calibration::end(Trouble trouble) noexcept {
  trouble_ = trouble;
  const bool at_once = stage_ == Stage::kHome || trouble == Trouble::kLost || trouble == Trouble::kOscillates;
  enter(at_once ? Stage::kEnd : Stage::kLetDown);
}

Vec3 Calibration::tick(const DeviceReading& reading) noexcept {
  const double elapsed = last_ ? std::max(to_seconds(reading.t - *last_), 0.0) : 0;
  const double dt = std::min(elapsed, kLongestTick);
  last_ = reading.t;
  in_stage_ += elapsed;
  newton_ = 0;
  give_up_in_time();
  if (!reading.valid || !reading.p_D.allFinite()) return lose(elapsed);
  if (stage_ == Stage::kEnd) return limiter_.drop();
  if (!holds_) find(reading.p_D);
  const double fade = stage_ == Stage::kLetDown ? std::max(1 - in_stage_ / kLetDown, 0.0) : 1;
  const Vec3 push_D = limiter_.clamp(holder_.push(reading.p_D, goal(), dt), dt);
  const Vec3 f_D = limiter_.push(fade * push_D + holder_.damping(), dt);
  newton_ = f_D.norm();
  if (limiter_.fault() != Fault::kNone) {
    end(Trouble::kOscillates);
  } else {
    step(reading.p_D, f_D, dt);
  }
  return f_D;
}

/// There is no position. A moment without one is got over.
Vec3 Calibration::lose(double elapsed) noexcept {
  holds_ = false;
  lost_ += elapsed;
  if (stage_ == Stage::kLetDown) enter(Stage::kEnd);
  if (stage_ != Stage::kHome && stage_ != Stage::kEnd && lost_ > kLongestLoss) end(Trouble::kLost);
  return limiter_.drop();
}

/// There is a position, of a grip that has had no force. What was weighed to the end stays.
void Calibration::find(const Vec3& p_D) noexcept {
  holds_ = true;
  lost_ = 0;
  holder_.begin(p_D);
  force_ = grip_.force();
  enter(stage_ < Stage::kHang ? Stage::kCentre : Stage::kHang);
}

/// Takes a tick in which the grip was held with `f_D`.
void Calibration::step(const Vec3& p_D, const Vec3& f_D, double dt) noexcept {
  if (stage_ == Stage::kHang) force_ += dt / (dt + kForceFilter) * (f_D - force_);
  if (stage_ != Stage::kLetDown && holder_.saturated())
    return end(stage_ < Stage::kHang ? Trouble::kNotMoved : Trouble::kTooHeavy);
  switch (stage_) {
    case Stage::kCentre:
      if (holder_.at_rest()) enter(Stage::kWeighGrip);
      return;
    case Stage::kWeighGrip:
      grip_.add(p_D, f_D, dt);
      if (!grip_.done()) return;
      force_ = grip_.force();
      return enter(Stage::kHang);
    case Stage::kHang:
      if (weight_is_there() && holder_.at_rest()) enter(Stage::kWeighBoth);
      return;
    case Stage::kWeighBoth:
      both_.add(p_D, f_D, dt);
      if (!both_.done()) return;
      force_ = both_.force();
      if (!weight_is_there()) return enter(Stage::kHang);
      return end(is_plausible() ? Trouble::kNone : Trouble::kImplausible);
    default:
      return;
  }
}

void Calibration::give_up_in_time() noexcept {
  if (stage_ == Stage::kEnd || in_stage_ < patience_in(stage_)) return;
  switch (stage_) {
    case Stage::kHome:
      return end(Trouble::kNotHomed);
    case Stage::kCentre:
      return end(Trouble::kNotMoved);
    case Stage::kHang:
      return end(Trouble::kNoWeight);
    case Stage::kLetDown:
      return enter(Stage::kEnd);
    default:
      return end(progress().held ? Trouble::kHeld : Trouble::kUnsteady);
  }
}

Vec3 Calibration::goal() const noexcept {
  Vec3 goal = settings_.centre_D;
  if (stage_ == Stage::kWeighGrip) goal[1] += grip_.offset();
  if (stage_ == Stage::kWeighBoth) goal[1] += both_.offset();
  return goal;
}

bool Calibration::weight_is_there() const noexcept {
  return difference().norm() > kLeastFraction * settings_.mass * kGravity;
}

CalibrationProgress Calibration::progress() const noexcept {
  const bool held =
      (stage_ == Stage::kWeighGrip && grip_.held()) || (stage_ == Stage::kWeighBoth && both_.held());
  return {stage_, held, newton_, std::max(patience_in(stage_) - in_stage_, 0.0)};
}

double Calibration::torque_constant() const noexcept {
  return settings_.assumed * difference().norm() / (settings_.mass * kGravity);
}

bool Calibration::is_plausible() const noexcept {
  return torque_constant() * kToSpare >= kLowestTorqueConstant &&
         torque_constant() <= kToSpare * kHighestTorqueConstant;
}

double Calibration::uncertainty() const noexcept {
  return std::hypot(grip_.spread(), both_.spread()) / difference().norm();
}

double Calibration::tilt() const noexcept {
  return std::acos(std::clamp(difference()[1] / difference().norm(), -1.0, 1.0));
}

double Calibration::largest_mass() const noexcept {
  constexpr double kSpare = 0.9;  // for the swing, and for what is not known
  const double spare = kSpare * settings_.limits.max_force - grip_.force()[1];
  return std::max(spare, 0.0) * settings_.assumed / kHighestTorqueConstant / kGravity;
}

}  // namespace palpate::client
