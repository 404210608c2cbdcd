#include "haptic_client/device/falcon_kinematics.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

#include "common/units.h"
#include "haptic_client/device/falcon_packets.h"

namespace palpate::client::falcon {
namespace {

constexpr std::array kAzimuth{105 * kDegree, -15 * kDegree, -135 * kDegree};  // of the three legs
// Quadrature of 320 lines; ratio of the capstan drive.
constexpr double kCountsPerTurn = 4 * 320, kCapstan = 110 / 14.25;
constexpr double kAngleAtZero = 35 * kDegree;  // of a leg where its encoder counts 0
// Lengths of the legs, m, under Stamper's names.
constexpr double a = 0.060, b = 0.1025, c = 0.01443, d = 0.01125, e = 0.01125, f = -0.025, r = 0.0400,
                 s = -0.02309;
constexpr double kAgree = 1e-12;     // rad
constexpr double kStretched = 1e-6;  // sine of the angle between thigh and shin

/// One leg with the grip somewhere: Stamper's three angles.
struct Leg {
  double t1, t2, t3;
};

/// The grip in the frame of a leg.
Vec3 in_leg_frame(const Vec3& p, double phi) {
  return {p[0] * std::cos(phi) + p[1] * std::sin(phi) - r, -p[0] * std::sin(phi) + p[1] * std::cos(phi) - s,
          p[2]};
}

std::optional<Leg> solve(const Vec3& p, double phi) {
  const Vec3 q = in_leg_frame(p, phi);
  const double cos3 = (q[1] + f) / b;
  if (!(std::abs(cos3) < 1)) return {};
  const double t3 = std::acos(cos3), length = d + e + b * std::sin(t3), u = q[0] + c, w = q[2];
  // u = a cos t1 + length cos t2, w = a sin t1 + length sin t2; with t = tan(t1 / 2) a quadratic.
  const double plus = (u + a) * (u + a) + w * w - length * length;
  const double minus = (u - a) * (u - a) + w * w - length * length;
  const double root = 4 * a * a * w * w - plus * minus;
  if (!(root >= 0)) return {};
  // The root with the minus sign, in the form that does not cancel.
  const double t1 = 2 * std::atan2(minus, 2 * a * w + std::sqrt(root));
  return Leg{t1, std::atan2(w - a * std::sin(t1), u - a * std::cos(t1)), t3};
}

}  // namespace

double angle_of(int counts) noexcept {
  return kAngleAtZero + counts * 2 * std::numbers::pi / (kCountsPerTurn * kCapstan);
}

std::optional<Vec3> leg_angles(const Vec3& p_D) noexcept {
  Vec3 angles;
  for (int i = 0; i < 3; ++i) {
    const auto leg = solve(p_D, kAzimuth[static_cast<std::size_t>(i)]);
    if (!leg) return {};
    angles[i] = leg->t1;
  }
  return angles;
}

std::optional<Mat3> jacobian(const Vec3& p_D) noexcept {
  Mat3 j;
  for (int i = 0; i < 3; ++i) {
    const double phi = kAzimuth[static_cast<std::size_t>(i)];
    const auto leg = solve(p_D, phi);
    if (!leg) return {};
    const double sin3 = std::sin(leg->t3), cos3 = std::cos(leg->t3),
                 bent = sin3 * std::sin(leg->t2 - leg->t1);
    if (!(std::abs(bent) > kStretched)) return {};
    const double along = std::cos(leg->t2) * sin3;
    j(i, 0) = (std::cos(phi) * along - std::sin(phi) * cos3) / (a * bent);
    j(i, 1) = (std::sin(phi) * along + std::cos(phi) * cos3) / (a * bent);
    j(i, 2) = std::sin(leg->t2) * sin3 / (a * bent);
  }
  return j;
}

std::optional<Vec3> grip_position(const Vec3& angles, const Vec3& guess) noexcept {
  // From random places to random places of the workspace it took up to 45 and 21.
  constexpr int kMostSteps = 50, kMostHalvings = 30;
  Vec3 p = guess;
  auto current = leg_angles(p);
  for (int step = 0; step < kMostSteps && current; ++step) {
    const Vec3 missing = angles - *current;
    if (missing.cwiseAbs().maxCoeff() <= kAgree) return p;
    const auto j = jacobian(p);
    if (!j) return {};
    Vec3 change = j->inverse() * missing;
    if (!change.allFinite()) return {};
    const auto nearer = [&] {
      const auto there = leg_angles(p + change);
      return there && (angles - *there).norm() < missing.norm();
    };
    for (int half = 0; half < kMostHalvings && !nearer(); ++half) change *= 0.5;
    p += change;
    current = leg_angles(p);
  }
  return {};
}

Vec3 motor_commands(const Vec3& f_D, const Vec3& p_D, double dac_per_newton_metre) noexcept {
  const auto j = jacobian(p_D);
  if (!j) return Vec3::Zero();
  const Vec3 dac = -dac_per_newton_metre * (j->inverse().transpose() * f_D);
  const double most = dac.cwiseAbs().maxCoeff();
  if (!std::isfinite(most)) return Vec3::Zero();
  return most <= kFalconMaxTorque ? dac : Vec3(dac * (kFalconMaxTorque / most));
}

}  // namespace palpate::client::falcon
