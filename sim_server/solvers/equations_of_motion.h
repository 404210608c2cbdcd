#pragma once
#include <Eigen/Core>

#include "sim_server/solvers/dynamics_settings.h"
#include "sim_server/solvers/newton.h"
#include "sim_server/solvers/prony_series.h"
#include "sim_server/solvers/time_stepping.h"

namespace palpate::sim {

/// Balance of forces at the end of each step of a body in motion,
///   r(x) = f_ext - M (a + alpha v) - beta df/dt - f(x) = 0,
/// and the trial point x (nodes, m) at which a solver evaluates it: f are the internal forces of the body
/// with its viscosity (`PronySeries`), M is its lumped mass, v, a and df/dt follow from x by `TimeStepping`,
/// and alpha and beta are Rayleigh's, with the stiffness of here and now. Evaluating allocates; one thread,
/// which uses all cores for the elements.
class EquationsOfMotion {
 public:
  /// Starts at rest. The body must outlive this.
  EquationsOfMotion(const Solid& solid, std::vector<HeldAxes> held, const DynamicsSettings& settings);

  /// A force so small (N, > 0) that it counts as none beside the forces that act. Set before the first
  /// residual.
  void set_negligible_force(double force) { negligible_force_ = force; }
  /// Restarts at `x` (nodes, m), as if it had always been there, at the velocities `v` (nodes, m/s), or the
  /// present ones.
  void restart(std::vector<Vec3> x, std::span<const Vec3> v);
  /// Begins a step of `h` (s > 0), with free nodes at the predictor x_n + h v_n.
  void start_step(double h);
  /// Ends it at the trial point; `stop`: at rest there.
  void end_step(bool stop);

  /// r(x) at the trial point under these external forces (nodes, N).
  Residual residual(std::span<const Vec3> external);
  /// Returns the external forces (nodes, N) and the scale (N) of the last residual.
  std::span<const Vec3> last_external() const { return external_; }
  double last_force_scale() const { return force_scale_; }

  std::span<const Vec3> position() const { return x_; }
  /// Returns the trial point, to prescribe it or nodes of it.
  std::span<Vec3> mutable_position();
  /// Moves to `x` (nodes, m).
  void move_to(std::span<const Vec3> x);
  /// Moves to `x` (nodes, m) plus the increment `d` (m, by unknowns).
  void move_to(std::span<const Vec3> x, const Eigen::VectorXd& d);
  /// Moves by the increment `d` (m, by unknowns).
  void move_by(const Eigen::VectorXd& d);
  /// Free nodes back to where the step begins. Returns the predictor's increment h v_n (m, by unknowns).
  Eigen::VectorXd move_to_start();
  /// Free nodes at the trial point, by unknowns, m; 0 elsewhere.
  Eigen::VectorXd unknowns() const;
  /// A force on each node (nodes, N), by unknowns; 0 where an axis is held.
  Eigen::VectorXd by_unknowns(std::span<const Vec3> forces) const;

  /// Elastic and viscous forces at the trial point (nodes, N).
  void internal_forces(std::span<Vec3> f) const;
  /// Writes these forces with damping and inertia: the resistance of each node (nodes, N).
  void resistance(std::span<Vec3> f) const;
  /// Returns the kinetic energy at the end of the last step, J.
  double kinetic_energy() const;

  /// Lumped, kg.
  std::span<const double> masses() const { return mass_; }
  /// Between two steps of a body that has lost elements: a node's mass, kg; a node at which nothing is left
  /// stops where it is; and the forces before are those of what is left, so that what went is no change of
  /// force, which damping would answer.
  void set_mass(int node, double mass) { mass_[static_cast<std::size_t>(node)] = mass; }
  void stop(int node) { time_.stop(static_cast<std::size_t>(node)); }
  /// Between two steps: a node goes towards another by this share of the way, as fast as what is there.
  void slide(int node, int towards, double fraction) {
    const auto i = static_cast<std::size_t>(node), j = static_cast<std::size_t>(towards);
    time_.slide(i, j, fraction);
    x_[i] = (1 - fraction) * x_[i] + fraction * x_[j];
    internal_is_current_ = start_is_current_ = false;
  }
  void forget_forces() {
    internal_is_current_ = start_is_current_ = false;
    update_internal();
    time_.forget_forces(internal_);
  }

  const TimeStepping& time() const { return time_; }
  Viscosity viscosity() const { return prony_.viscosity(); }
  const FreeDofs& dofs() const { return dofs_; }
  Solid::Scratch& scratch() { return scratch_; }
  /// Without the scratch.
  std::size_t bytes() const;
  std::size_t scratch_bytes() const { return scratch_.bytes(); }

 private:
  void update_internal();
  std::vector<Mat3> elastic_stress();
  /// M (a + alpha v) of node i at the trial point, N.
  Vec3 inertia(std::size_t i) const;

  const Solid* solid_;
  Solid::Scratch scratch_;
  double alpha_, beta_;  // 1/s, s
  FreeDofs dofs_;
  std::vector<double> mass_;  // (nodes) kg
  TimeStepping time_;
  PronySeries prony_;
  double negligible_force_ = 0, force_scale_ = 0;  // N
  std::vector<Vec3> x_, internal_, external_;      // trial point; f there; of the last residual
  bool internal_is_current_ = false;               // `internal_` is of the trial point
  bool start_is_current_ = false;                  // the internal forces of `time_` are of where it was
};

}  // namespace palpate::sim
