#include "haptic_client/calibration/swing.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
namespace {

constexpr double kAmplitude = 0.004, kLeastTravel = 0.002;  // m
constexpr double kSpringOfHand = 60;                        // N/m

}  // namespace

double Swing::offset(double t) noexcept {
  const double turn = t / kPeriod + 0.25, phase = turn - std::floor(turn);  // 0 and 1: lowest; 0.5: highest
  return kAmplitude * (1 - 4 * std::abs(phase - 0.5));
}

void Swing::add(const Vec3& p_D, const Vec3& f_D, double dt) noexcept {
  time_ += dt;
  force_ += dt * f_D;
  y_ += dt * p_D[1];
  yy_ += dt * p_D[1] * p_D[1];
  fy_ += dt * f_D[1] * p_D[1];
  lowest_ = std::min(lowest_, p_D[1]);
  highest_ = std::max(highest_, p_D[1]);
}

bool Swing::held() const noexcept {
  const double square = yy_ - y_ * y_ / time_, product = fy_ - force_[1] * y_ / time_;
  return highest_ - lowest_ < kLeastTravel || product > kSpringOfHand * square;
}

}  // namespace palpate::client
