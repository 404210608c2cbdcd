#include "haptic_client/calibration/grip_holder.h"

namespace palpate::client {
namespace {

constexpr double kSpring = 400, kIntegral = 400, kDamper = 12;  // N/m, N/(m s), N s/m
constexpr double kSpeed = 0.02, kLeash = 0.005;                 // m/s, m: of the reference
constexpr double kVelocityFilter = 0.008;                       // s
constexpr double kRest = 0.001;                                 // m

Vec3 within(const Vec3& v, double most) {
  const double size = v.norm();
  return size <= most ? v : Vec3(most / size * v);
}

}  // namespace

void GripHolder::begin(const Vec3& p_D) noexcept {
  reference_ = p_D_ = p_D;
  integral_.setZero();
  v_D_.setZero();
  rest_ = saturated_ = 0;
}

Vec3 GripHolder::push(const Vec3& p_D, const Vec3& goal_D, double dt) noexcept {
  if (dt > 0) v_D_ += dt / (dt + kVelocityFilter) * ((p_D - p_D_) / dt - v_D_);
  p_D_ = p_D;
  reference_ += within(goal_D - reference_, kSpeed * dt);
  reference_ = p_D + within(reference_ - p_D, kLeash);
  const Vec3 ahead = reference_ - p_D;
  integral_ += dt * kIntegral * ahead;
  const Vec3 wish = kSpring * ahead + integral_, push = within(wish, max_force_);
  integral_ += push - wish;  // it does not grow beyond what is let through
  saturated_ = push == wish ? 0 : saturated_ + dt;
  watch(p_D, goal_D, dt);
  return push;
}

Vec3 GripHolder::damping() const noexcept {
  return -kDamper * v_D_;
}

void GripHolder::watch(const Vec3& p_D, const Vec3& goal_D, double dt) noexcept {
  const bool rests = (goal_D - p_D).norm() < kRest;
  rest_ = rests ? rest_ + dt : 0;
}

}  // namespace palpate::client
