#include "tests/emulation/delta_mechanism.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::emulation {
namespace {

constexpr double kThigh = 0.060, kShin = 0.1025, kElbow = 0.01125, kWrist = 0.01125;
constexpr double kGripRadius = 0.01443, kSideOffset = -0.025;   // where the shin meets the grip
constexpr double kBaseRadius = 0.0400, kBaseOffset = -0.02309;  // where the thigh meets the base
constexpr double kRadians = std::numbers::pi / 180;
constexpr std::array<double, 3> kAzimuth{105 * kRadians, -15 * kRadians,
                                         -135 * kRadians};  // top, right, left

/// The grip as a leg sees it: u outwards, v to the side, w along z.
Vec in_leg(const Vec& p, std::size_t leg) {
  const double c = std::cos(kAzimuth[leg]), s = std::sin(kAzimuth[leg]);
  return {p.x * c + p.y * s - kBaseRadius, -p.x * s + p.y * c - kBaseOffset, p.z};
}

/// How far the chain of links ends from the grip, in u, v and w (m).
Vec gap(const DeltaMechanism::Leg& leg, const Vec& grip) {
  const double reach = kElbow + kWrist + kShin * std::sin(leg.side);
  return {kThigh * std::cos(leg.thigh) + reach * std::cos(leg.shin) - kGripRadius - grip.x,
          kShin * std::cos(leg.side) - kSideOffset - grip.y,
          kThigh * std::sin(leg.thigh) + reach * std::sin(leg.shin) - grip.z};
}

/// One Newton step; false where the equations are singular (a leg stretched or folded).
bool newton_step(DeltaMechanism::Leg& leg, const Vec& g) {
  const double sin_side = std::sin(leg.side);
  const double reach = kElbow + kWrist + kShin * sin_side, fold = std::sin(leg.shin - leg.thigh);
  if (std::abs(sin_side) < 1e-3 || std::abs(fold) < 1e-3) return false;
  // The sideways equation holds only `side`; what it takes moves the reach, and the other two follow.
  const double d_side = g.y / (kShin * sin_side), d_reach = kShin * std::cos(leg.side) * d_side;
  const double right_u = -g.x - d_reach * std::cos(leg.shin);
  const double right_w = -g.z - d_reach * std::sin(leg.shin);
  const double determinant = kThigh * reach * fold;
  const double d_thigh = (right_u * std::cos(leg.shin) + right_w * std::sin(leg.shin)) * reach / determinant;
  const double d_shin =
      -(right_u * std::cos(leg.thigh) + right_w * std::sin(leg.thigh)) * kThigh / determinant;
  constexpr double kLargest = 0.3;  // rad: far starts go there in small steps
  const double scale = kLargest / std::max({kLargest, std::abs(d_side), std::abs(d_thigh), std::abs(d_shin)});
  leg.side += scale * d_side;
  leg.thigh += scale * d_thigh;
  leg.shin += scale * d_shin;
  return true;
}

/// Closes the links on `grip`, from where `leg` stands. False if they do not reach.
bool close_links(DeltaMechanism::Leg& leg, const Vec& grip) {
  for (int step = 0; step < 40; ++step) {
    const Vec g = gap(leg, grip);
    if (norm(g) < 1e-14) return true;
    if (!newton_step(leg, g)) return false;
  }
  return norm(gap(leg, grip)) < 1e-12;
}

}  // namespace

DeltaMechanism::DeltaMechanism() {
  move_to({0, 0, 0.11});
}

bool DeltaMechanism::move_to(const Vec& position) {
  std::array<Leg, 3> legs = legs_;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!close_links(legs[i], in_leg(position, i))) return false;
  }
  legs_ = legs;
  position_ = position;
  return true;
}

std::array<Vec, 3> DeltaMechanism::jacobian() const {
  constexpr double kStep = 1e-6;  // m
  const std::array<Vec, 3> axes{Vec{kStep, 0, 0}, Vec{0, kStep, 0}, Vec{0, 0, kStep}};
  std::array<Vec, 3> rows{};
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<double, 3> row{};
    for (std::size_t k = 0; k < 3; ++k) {
      Leg ahead = legs_[i], behind = legs_[i];
      if (!close_links(ahead, in_leg(position_ + axes[k], i))) continue;
      if (!close_links(behind, in_leg(position_ - axes[k], i))) continue;
      row[k] = (ahead.thigh - behind.thigh) / (2 * kStep);
    }
    rows[i] = {row[0], row[1], row[2]};
  }
  return rows;
}

Vec DeltaMechanism::force(const std::array<Vec, 3>& jacobian, const std::array<double, 3>& torque) {
  Vec sum;
  for (std::size_t i = 0; i < 3; ++i) sum += torque[i] * jacobian[i];
  return sum;
}

double DeltaMechanism::residual() const {
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) worst = std::max(worst, norm(gap(legs_[i], in_leg(position_, i))));
  return worst;
}

}  // namespace palpate::emulation
