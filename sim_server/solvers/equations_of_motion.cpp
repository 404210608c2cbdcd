#include "sim_server/solvers/equations_of_motion.h"

#include <Eigen/LU>
#include <cmath>

namespace palpate::sim {

EquationsOfMotion::EquationsOfMotion(const Solid& solid, std::vector<HeldAxes> held,
                                     const DynamicsSettings& settings)
    : solid_(&solid),
      scratch_(solid),
      alpha_(settings.rayleigh_mass),
      beta_(settings.rayleigh_stiffness),
      dofs_(std::move(held)),
      mass_(solid.masses()),
      time_(solid.rest(), settings.second_order),
      prony_(solid.material().relaxations, solid.points()),
      x_(solid.rest()),
      internal_(x_.size(), Vec3::Zero()) {}

void EquationsOfMotion::restart(std::vector<Vec3> x, std::span<const Vec3> v) {
  x_ = std::move(x);
  internal_is_current_ = start_is_current_ = false;
  update_internal();
  time_.restart(x_, v, internal_);
}

void EquationsOfMotion::start_step(double h) {
  internal_is_current_ = false;
  time_.begin(h);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] >= 0) x_[i] = time_.position()[i] + h * time_.velocity()[i];
  }
  prony_.begin(h);
}

void EquationsOfMotion::end_step(bool stop) {
  if (beta_ > 0) update_internal();
  start_is_current_ = internal_is_current_;
  internal_is_current_ = false;
  if (!prony_.empty()) prony_.end(elastic_stress());
  time_.end(x_, internal_, stop);
}

/// Second Piola-Kirchhoff stress of what is elastic, at each point; Cauchy stress of the linear law, Pa.
std::vector<Mat3> EquationsOfMotion::elastic_stress() {
  std::vector<Solid::State> states(solid_->points());
  solid_->evaluate(x_, states, {}, scratch_);
  const bool linear = solid_->material().law == ElasticLaw::kLinear;
  std::vector<Mat3> stress;
  stress.reserve(states.size());
  for (const Solid::State& state : states)
    stress.push_back(linear ? state.stress : Mat3(state.F.inverse() * state.stress));
  return stress;
}

void EquationsOfMotion::update_internal() {
  if (internal_is_current_) return;
  solid_->forces(x_, internal_, viscosity(), scratch_);
  internal_is_current_ = true;
}

Vec3 EquationsOfMotion::inertia(std::size_t i) const {
  const Vec3 v = time_.velocity_at(i, x_[i]);
  return mass_[i] * (time_.acceleration_at(i, v) + alpha_ * v);
}

Residual EquationsOfMotion::residual(std::span<const Vec3> external) {
  update_internal();
  const double damping = beta_ * time_.c();
  Residual residual{.force = Eigen::VectorXd(dofs_.count)};
  double squares = negligible_force_ * negligible_force_;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 inertia = this->inertia(i);
    squares += internal_[i].squaredNorm() + external[i].squaredNorm() + inertia.squaredNorm();
    if (dofs_.first[i] < 0) continue;
    residual.force.segment<3>(dofs_.first[i]) =
        external[i] - internal_[i] - damping * time_.change_of_force(i, internal_[i]) - inertia;
  }
  dofs_.hold(residual.force);
  residual.force_scale = force_scale_ = std::sqrt(squares);
  residual.relative = residual.force.norm() / force_scale_;
  external_.assign(external.begin(), external.end());
  return residual;
}

std::span<Vec3> EquationsOfMotion::mutable_position() {
  internal_is_current_ = start_is_current_ = false;
  return x_;
}

void EquationsOfMotion::move_to(std::span<const Vec3> x) {
  internal_is_current_ = false;
  x_.assign(x.begin(), x.end());
}

void EquationsOfMotion::move_to(std::span<const Vec3> x, const Eigen::VectorXd& d) {
  move_to(x);
  move_by(d);
}

void EquationsOfMotion::move_by(const Eigen::VectorXd& d) {
  internal_is_current_ = false;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] >= 0) x_[i] += d.segment<3>(dofs_.first[i]);
  }
}

Eigen::VectorXd EquationsOfMotion::move_to_start() {
  Eigen::VectorXd increment(dofs_.count);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] < 0) continue;
    increment.segment<3>(dofs_.first[i]) = time_.step_length() * time_.velocity()[i];
    x_[i] = time_.position()[i];
  }
  dofs_.hold(increment);
  internal_is_current_ = start_is_current_ && prony_.empty();
  if (internal_is_current_) internal_.assign(time_.internal_force().begin(), time_.internal_force().end());
  return increment;
}

Eigen::VectorXd EquationsOfMotion::unknowns() const {
  Eigen::VectorXd u(dofs_.count);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] >= 0) u.segment<3>(dofs_.first[i]) = x_[i];
  }
  return u;
}

Eigen::VectorXd EquationsOfMotion::by_unknowns(std::span<const Vec3> forces) const {
  Eigen::VectorXd by(dofs_.count);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (dofs_.first[i] >= 0) by.segment<3>(dofs_.first[i]) = forces[i];
  }
  dofs_.hold(by);
  return by;
}

void EquationsOfMotion::internal_forces(std::span<Vec3> f) const {
  solid_->forces(x_, f, viscosity());
}

void EquationsOfMotion::resistance(std::span<Vec3> f) const {
  internal_forces(f);
  const double damping = beta_ * time_.c();
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (damping > 0) f[i] += damping * time_.change_of_force(i, f[i]);
    f[i] += inertia(i);
  }
}

double EquationsOfMotion::kinetic_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < mass_.size(); ++i) sum += 0.5 * mass_[i] * time_.velocity()[i].squaredNorm();
  return sum;
}

std::size_t EquationsOfMotion::bytes() const {
  return (x_.size() + internal_.size() + external_.size()) * sizeof(Vec3) + mass_.size() * sizeof(double) +
         time_.bytes() + prony_.bytes();
}

}  // namespace palpate::sim
