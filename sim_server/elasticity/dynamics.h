#pragma once
#include <optional>

#include "sim_server/elasticity/solid.h"
#include "sim_server/elasticity/sparse_cholesky.h"

namespace palpate::sim {

/// How a body moves in time.
struct DynamicsSettings {
  double rayleigh_mass = 0;       ///< alpha, 1/s, [0, 1e4]
  double rayleigh_stiffness = 0;  ///< beta, s, [0, 10]
  bool second_order = false;      ///< BDF2 instead of backward Euler
};

/// Implicit dynamics of a body: at the end of each step of length h
///   M a + (alpha M + beta K) v + f_int(x) = f_ext,
/// K the stiffness there, with v = c (x - x~), a = c (v - v~): backward Euler (c = 1 / h, x~, v~ those
/// before) or BDF2 (c = 3 / 2h, x~ = (4 x_n - x_(n-1)) / 3, likewise v~; its first step is an Euler step).
/// Newton's method on A = (1 + beta c) K + (c^2 + alpha c) M, by sparse Cholesky; a factor of earlier serves
/// as long as each step with it leaves no more than 30 % of what was unbalanced. Viscosity by Prony series
/// with the recursion of Simo (1987, Comput. Meth. Appl. Mech. Engng 60:153): with S0 the elastic second
/// Piola-Kirchhoff stress, g_i and tau_i share and time of each term,
///   h_i' = exp(-h / tau_i) h_i + g_i gamma_i (S0' - S0),   gamma_i = (1 - exp(-h / tau_i)) tau_i / h,
///   S' = (1 - sum g_i) S0' + sum h_i'.
/// Steps allocate; one thread, which uses all cores for the elements.
class Dynamics {
 public:
  /// At rest. Throws `Error`, beginning with `where`, when the held nodes do not hold the body.
  Dynamics(const Solid& solid, std::vector<HeldAxes> held, const DynamicsSettings& settings,
           const std::string& where);

  /// At rest at `x` (nodes, m), before the first step.
  void stand_at(std::vector<Vec3> x);
  /// Begins a step of `h` (s > 0): looks for its end first where the velocity leads.
  void start_step(double h);
  /// One step of Newton's method under these forces (nodes, N), unless no more than `tolerance` is unbalanced
  /// before it; returns that, as a share of the forces at work; 0 where it is rounding; 1 where the
  /// step before was too long, and half of it is taken back.
  double improve(std::span<const Vec3> external, double tolerance = 0);
  /// At most `most` of them, until no more than `tolerance` is unbalanced. Returns how many.
  int settle(std::span<const Vec3> external, int most, double tolerance);
  /// What is found now is the end of the step.
  void finish_step();

  /// Where it is looked for now: (nodes) m.
  std::span<const Vec3> position() const { return x_; }
  std::span<Vec3> position() { return x_; }
  /// (nodes) m/s, at the end of the last step.
  std::span<const Vec3> velocity() const { return v_before_; }
  const FreeDofs& dofs() const { return dofs_; }
  /// What is unbalanced from here on is of other forces, not of an old factor.
  void push_anew() { improved_ = false; }
  /// How often A has been factored: what `solve` gave stands while this does.
  int factors() const { return factors_; }
  /// A^-1 b of the newest factor, for columns b over the unknowns.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const { return factor_->solve(b); }
  /// What the stiffest node gives way by, m/N, or a little less.
  double least_compliance() const { return 1 / matrix_.lower().diagonal().maxCoeff(); }
  /// Moves the unknowns, m.
  void move(const Eigen::VectorXd& by);
  double kinetic_energy() const;
  /// With which the body resists (nodes, N), viscosity counted, at the end of the last step.
  void forces(std::span<Vec3> f) const;
  std::size_t bytes() const;

 private:
  void factor();
  Eigen::VectorXd unbalanced(std::span<const Vec3> external);
  void relax_stress(double h);
  Viscosity viscosity() const;

  const Solid& solid_;
  DynamicsSettings settings_;
  FreeDofs dofs_;
  std::vector<double> mass_;
  StiffnessMatrix matrix_;
  std::optional<SparseCholesky> factor_;
  double factored_c_ = 0;  // of the factor; 0: none of A yet
  int factors_ = 0;
  bool improved_ = false, fresh_ = false;  // in this step; by a factor of the very place
  Eigen::VectorXd way_;                    // of the last improvement, m
  std::vector<Vec3> x_, x_before_, v_before_, x_then_, v_then_;  // now; last step's end; the one before
  std::vector<Vec3> from_, from_v_;                              // x~, v~
  std::vector<Vec3> internal_;
  double c_ = 0, h_ = 0;
  int steps_ = 0;
  double left_ = 0;               // unbalanced, of the forces at work
  double usual_ = 1, still_ = 0;  // of the diagonal of K at rest, N/m; a force that is none, N
  // Viscosity: by quadrature point; terms one after the other.
  double scale_ = 1;
  std::vector<Mat3> stress_, memory_, terms_;
};

}  // namespace palpate::sim
