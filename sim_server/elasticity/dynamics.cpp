#include "sim_server/elasticity/dynamics.h"

#include <Eigen/LU>
#include <cmath>

namespace palpate::sim {
namespace {

// Of what is unbalanced: a step with an old factor that leaves more is a reason to factor anew.
constexpr double kWorthwhile = 0.3;
// Likewise: so little may be rounding, where a fresh factor makes it no less.
constexpr double kRounding = 1e-6;
// Of the size of the body: what moves a node by less is no force at work, so that a body at rest is at rest.
constexpr double kStill = 1e-9;

}  // namespace

Dynamics::Dynamics(const Solid& solid, std::vector<HeldAxes> held, const DynamicsSettings& settings,
                   const std::string& where)
    : solid_(solid),
      settings_(settings),
      dofs_(std::move(held)),
      mass_(solid.masses()),
      matrix_(solid.stiffness_matrix(dofs_)),
      x_(solid.rest()),
      x_before_(x_),
      v_before_(x_.size(), Vec3::Zero()),
      x_then_(x_),
      v_then_(v_before_),
      from_(x_),
      from_v_(v_before_),
      internal_(x_.size()) {
  solid.add_stiffness(x_, matrix_);
  usual_ = matrix_.lower().diagonal().mean();
  matrix_.close_held(usual_);
  factor_.emplace(matrix_.lower(), where);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : x_) box.extend(x);
  still_ = kStill * box.diagonal().norm() * usual_;
  const std::size_t terms = solid.material().relaxations.size();
  if (terms == 0) return;
  stress_.assign(solid.points(), Mat3::Zero());
  memory_ = stress_;
  terms_.assign(terms * solid.points(), Mat3::Zero());
}

void Dynamics::stand_at(std::vector<Vec3> x) {
  x_ = x_before_ = x_then_ = std::move(x);
}

void Dynamics::start_step(double h) {
  h_ = h;
  improved_ = false;
  const bool second = settings_.second_order && steps_ > 0;
  c_ = (second ? 1.5 : 1) / h;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    from_[i] = second ? Vec3((4 * x_before_[i] - x_then_[i]) / 3) : x_before_[i];
    from_v_[i] = second ? Vec3((4 * v_before_[i] - v_then_[i]) / 3) : v_before_[i];
    if (dofs_.first[i] >= 0) x_[i] = x_before_[i] + h * v_before_[i];
  }
  scale_ = 1;
  if (terms_.empty()) return;
  std::fill(memory_.begin(), memory_.end(), Mat3::Zero());
  const auto& relaxations = solid_.material().relaxations;
  for (std::size_t k = 0; k < relaxations.size(); ++k) {
    const auto& [share, time] = relaxations[k];
    const double fade = std::exp(-h / time), gamma = -std::expm1(-h / time) * time / h;
    scale_ += share * (gamma - 1);
    for (std::size_t p = 0; p < memory_.size(); ++p)
      memory_[p] += fade * terms_[k * memory_.size() + p] - share * gamma * stress_[p];
  }
}

Viscosity Dynamics::viscosity() const {
  return {scale_, memory_};
}

void Dynamics::factor() {
  matrix_.set_zero();
  solid_.add_stiffness(x_, matrix_, viscosity());
  matrix_.lower() *= 1 + settings_.rayleigh_stiffness * c_;
  matrix_.add_to_diagonal(mass_, c_ * c_ + settings_.rayleigh_mass * c_);
  matrix_.close_held(usual_);
  bool definite = factor_->refactor(matrix_.lower());
  // A body squeezed hard may buckle, where A is not positive definite: more inertia keeps it on its way.
  for (double more = 1; !definite && more < 1e6; more *= 4) {
    matrix_.add_to_diagonal(mass_, more * c_ * c_);
    definite = factor_->refactor(matrix_.lower());
  }
  factored_c_ = c_;
  ++factors_;
}

/// f_ext - f_int - M a - C v over the unknowns, N.
Eigen::VectorXd Dynamics::unbalanced(std::span<const Vec3> external) {
  solid_.forces(x_, internal_, viscosity());
  const double alpha = settings_.rayleigh_mass, beta = settings_.rayleigh_stiffness;
  Eigen::VectorXd left(dofs_.count), speed(dofs_.count);
  double at_work = still_ * still_;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 v = c_ * (x_[i] - from_[i]), inertia = mass_[i] * (c_ * (v - from_v_[i]) + alpha * v);
    at_work += internal_[i].squaredNorm() + external[i].squaredNorm() + inertia.squaredNorm();
    if (dofs_.first[i] < 0) continue;
    left.segment<3>(dofs_.first[i]) = external[i] - internal_[i] - inertia;
    speed.segment<3>(dofs_.first[i]) = v;
  }
  if (beta > 0) {  // K v, from A
    dofs_.hold(speed);
    Eigen::VectorXd damping = matrix_.lower().selfadjointView<Eigen::Lower>() * speed;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (dofs_.first[i] >= 0)
        damping.segment<3>(dofs_.first[i]) -=
            (c_ * c_ + alpha * c_) * mass_[i] * speed.segment<3>(dofs_.first[i]);
    }
    left -= beta / (1 + beta * c_) * damping;
  }
  dofs_.hold(left);
  left_ = left.norm() / std::sqrt(at_work);
  return left;
}

void Dynamics::move(const Eigen::VectorXd& by) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] >= 0) x_[i] += by.segment<3>(dofs_.first[i]);
  }
}

double Dynamics::improve(std::span<const Vec3> external, double tolerance) {
  bool fresh = factored_c_ != c_;
  if (fresh) factor();
  const double before = left_;
  Eigen::VectorXd left = unbalanced(external);
  if (!std::isfinite(left_)) {  // flung about beyond all measure: it stays where it was
    x_ = x_before_;
    return left_ = 0;
  }
  if (left_ <= tolerance) return left_;
  if (improved_ && left_ > kWorthwhile * before) {
    if (fresh_ && left_ <= kRounding) return 0;
    if (fresh_ && left_ > before) {  // too far: half of the way back
      way_ *= -0.5;
      move(way_);
      way_ *= -1;
      left_ = before;
      return 1;
    }
    factor();
    fresh = true;
    left = unbalanced(external);
  }
  improved_ = true;
  fresh_ = fresh;
  way_ = factor_->solve(left).col(0);
  move(way_);
  return left_;
}

int Dynamics::settle(std::span<const Vec3> external, int most, double tolerance) {
  int steps = 0;
  while (steps < most && improve(external, tolerance) > tolerance) ++steps;
  return steps;
}

void Dynamics::finish_step() {
  if (!terms_.empty()) relax_stress(h_);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 v = c_ * (x_[i] - from_[i]);
    x_then_[i] = x_before_[i];
    v_then_[i] = v_before_[i];
    x_before_[i] = x_[i];
    v_before_[i] = v;
  }
  ++steps_;
}

void Dynamics::relax_stress(double h) {
  std::vector<Solid::State> states(solid_.points());
  solid_.evaluate(x_, states);
  const bool linear = solid_.material().law == ElasticLaw::kLinear;
  const auto& relaxations = solid_.material().relaxations;
  for (std::size_t p = 0; p < states.size(); ++p) {
    const Mat3 now = linear ? states[p].stress : Mat3(states[p].F.inverse() * states[p].stress);
    if (!now.allFinite()) continue;  // turned flat: it remembers what was
    for (std::size_t k = 0; k < relaxations.size(); ++k) {
      const auto& [share, time] = relaxations[k];
      const double gamma = -std::expm1(-h / time) * time / h;
      Mat3& term = terms_[k * states.size() + p];
      term = std::exp(-h / time) * term + share * gamma * (now - stress_[p]);
    }
    stress_[p] = now;
  }
}

void Dynamics::forces(std::span<Vec3> f) const {
  solid_.forces(x_, f, viscosity());
}

double Dynamics::kinetic_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < mass_.size(); ++i) sum += 0.5 * mass_[i] * v_before_[i].squaredNorm();
  return sum;
}

std::size_t Dynamics::bytes() const {
  return (x_.size() * 8) * sizeof(Vec3) + matrix_.bytes() + factor_->bytes() +
         (stress_.size() + memory_.size() + terms_.size()) * sizeof(Mat3) + mass_.size() * sizeof(double);
}

}  // namespace palpate::sim
