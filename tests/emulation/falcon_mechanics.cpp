#include "tests/emulation/falcon_mechanics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::emulation {
namespace {

constexpr double kStep = 1e-4;  // s
constexpr double kDegreesPerCount = 0.0364347, kDegreesAtZero = 35;
constexpr int kPulledOut = 600;                                 // counts: z of about 160 mm
constexpr std::array<int, 3> kReference{-600, -650, -700};      // counts: z of about 105 to 101 mm
constexpr double kInner = 0.072, kOuter = 0.177, kRim = 0.065;  // m: hard stops in z, and around the axis
constexpr double kStopStiffness = 2e4, kStopDamping = 50;       // N/m, N s/m
constexpr double kGravity = 9.80665;                            // m/s2, along -y
constexpr double kSlip = 0.05;                                  // rad/s: Coulomb friction is full from here

/// One-sided spring and damper of a stop that is `depth` (m) deep and pushes along `out`.
Vec stop(double depth, const Vec& out, const Vec& velocity) {
  if (depth <= 0) return {};
  return std::max(0.0, kStopStiffness * depth - kStopDamping * dot(velocity, out)) * out;
}

Vec stop_force(const Vec& p, const Vec& v) {
  Vec sum = stop(kInner - p.z, {0, 0, 1}, v) + stop(p.z - kOuter, {0, 0, -1}, v);
  const double radius = std::hypot(p.x, p.y);
  if (radius > kRim) sum += stop(radius - kRim, {-p.x / radius, -p.y / radius, 0}, v);
  return sum;
}

}  // namespace

double counts_of(double thigh) {
  return (thigh * 180 / std::numbers::pi - kDegreesAtZero) / kDegreesPerCount;
}

FalconMechanics::FalconMechanics(const Settings& settings) : settings_(settings), random_(settings.seed) {
  hand.move(mechanism_.position(), 0);
  jacobian_ = mechanism_.jacobian();
  power_up();
}

std::uint64_t FalconMechanics::draw() {  // splitmix64
  std::uint64_t z = random_ += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

void FalconMechanics::power_up() {
  for (Encoder& encoder : encoders_) encoder = {static_cast<int>(draw() % 4001) - 2000, false, false};
  dac_ = {};
  homing_ = false;
}

void FalconMechanics::set_dac(const std::array<int, 3>& dac) {
  for (std::size_t i = 0; i < 3; ++i) dac_[i] = std::clamp(dac[i], -kLargestDac, kLargestDac);
}

void FalconMechanics::set_homing(bool on) {
  homing_ = on;
  if (on) return;
  for (Encoder& encoder : encoders_) encoder.pulled = encoder.found = false;
}

void FalconMechanics::home_now() {
  homing_ = true;
  for (Encoder& encoder : encoders_) encoder = {0, true, true};
}

bool FalconMechanics::place(const Vec& position) {
  if (!mechanism_.move_to(position)) return false;
  velocity_ = {};
  jacobian_ = mechanism_.jacobian();
  hand.move(position, 0);
  return true;
}

void FalconMechanics::advance(double seconds) {
  rest_ += seconds;
  const int steps = static_cast<int>(rest_ / kStep + 1e-6);
  rest_ -= steps * kStep;
  for (int i = 0; i < steps; ++i) {
    if (i % 10 == 0) jacobian_ = mechanism_.jacobian();
    step(kStep);
  }
}

Vec FalconMechanics::motor_force() const {
  if (!mains_) return {};
  std::array<double, 3> torque{};
  for (std::size_t i = 0; i < 3; ++i) torque[i] = -dac_[i] / settings_.torque_constant;
  return DeltaMechanism::force(jacobian_, torque);
}

Vec FalconMechanics::friction_force() const {
  std::array<double, 3> torque{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double rate = dot(jacobian_[i], velocity_);
    torque[i] = -settings_.coulomb * std::tanh(rate / kSlip) - settings_.viscous * rate;
  }
  return DeltaMechanism::force(jacobian_, torque);
}

void FalconMechanics::step(double dt) {
  hand.advance(dt);
  const Vec by_hand = hand.force(position(), velocity_), by_motors = motor_force(),
            by_friction = friction_force(), by_stops = stop_force(position(), velocity_),
            by_weight = {0, -weight * kGravity, 0};
  const Vec before = velocity_;
  velocity_ += dt / (mass + weight) * (by_hand + by_motors + by_friction + by_stops + by_weight);
  const Vec mean = 0.5 * (before + velocity_);  // with it the work is the change of kinetic energy, exactly
  work_.hand += dt * dot(by_hand, mean);
  work_.motors += dt * dot(by_motors, mean);
  work_.friction += dt * dot(by_friction, mean);
  work_.stops += dt * dot(by_stops, mean);
  work_.weight += dt * dot(by_weight, mean);
  if (!mechanism_.move_to(position() + dt * velocity_)) {
    work_.stops -= kinetic_energy();  // the links are stretched: the hardest stop of all
    velocity_ = {};
  }
  time_ += dt;
  look_for_references();
}

void FalconMechanics::look_for_references() {
  if (!homing_ || !mains_) return;
  for (std::size_t i = 0; i < 3; ++i) {
    const double counts = counts_of(mechanism_.thigh(static_cast<int>(i)));
    Encoder& encoder = encoders_[i];
    if (counts > kPulledOut) encoder.pulled = true;
    if (encoder.found || !encoder.pulled || counts > kReference[i]) continue;
    encoder.found = true;
    encoder.offset = 0;
  }
}

std::array<int, 3> FalconMechanics::encoders() const {
  std::array<int, 3> counts{};
  for (std::size_t i = 0; i < 3; ++i)
    counts[i] =
        static_cast<int>(std::lround(counts_of(mechanism_.thigh(static_cast<int>(i))))) + encoders_[i].offset;
  return counts;
}

unsigned FalconMechanics::homed() const {
  unsigned bits = 0;
  for (std::size_t i = 0; i < 3; ++i) bits |= encoders_[i].found ? 1u << i : 0u;
  return bits;
}

}  // namespace palpate::emulation
