#pragma once
#include <optional>

#include "sim_server/elasticity/quasi_newton.h"

namespace palpate::sim {

/// Implicit dynamics of a body: at the end of each step of length h
///   M a + alpha M v + beta df_int/dt + f_int(x) = f_ext,
/// which is Rayleigh's damping with K of here and now, with v = c (x - x~), a = c (v - v~): backward Euler (c
/// = 1 / h, x~, v~ those before) or BDF2 (c = 3 / 2h, x~ = (4 x_n - x_(n-1)) / 3, likewise v~; its first step
/// is an Euler step). Newton's method on A = (1 + beta c) K + (c^2 + alpha c) M (`NewtonMatrix`), in one of
/// three ways:
/// - by the sparse Cholesky factor of A, where one of earlier serves as long as each step with it leaves no
///   more than 30 % of what was unbalanced;
/// - with a factor that is made in the background, of where the body was `refresh_steps` to twice as many
///   steps before (Courtecuisse et al. 2010), as it is, and where that leaves more, by conjugate gradients
///   that it preconditions. A v is had from a difference of forces (Knoll and Keyes 2004, J. Comput. Phys.
///   193:357), so that no matrix is assembled in a step;
/// - with the same factor by a quasi-Newton method (`QuasiNewton`), which takes fewer forces and solves,
///   and by conjugate gradients only in a step in which that leaves more.
/// All balance the same forces. Viscosity by Prony series
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

  /// At `x` (nodes, m) before the first step; at rest, or at these velocities (nodes, m/s).
  void stand_at(std::vector<Vec3> x, std::vector<Vec3> v = {});
  /// Begins a step of `h` (s > 0): looks for its end first where the velocity leads.
  void start_step(double h);
  /// One step of Newton's method under these forces (nodes, N), unless no more than `tolerance` is unbalanced
  /// before it; returns that, as a share of the forces at work; 0 where it is rounding; 1 where the
  /// step before was too long, and half of it is taken back.
  double improve(std::span<const Vec3> external, double tolerance = 0);
  /// At most `most` of them, until no more than `tolerance` is unbalanced. Returns how many.
  int settle(std::span<const Vec3> external, int most, double tolerance);
  /// What the last `improve` found unbalanced before it, as a share of the forces at work.
  double unbalanced() const { return left_; }
  /// Whether an element that is no sliver is inverted, of a law that can have a second rest there: St. Venant
  /// and Kirchhoff's, and the corotational one where nu is near one half. O(elements), a fraction of a look.
  bool inside_out() const;
  /// Factors anew, where the factor is of a place elsewhere and none comes from the background.
  void refresh();
  /// What is found now is the end of the step.
  void finish_step();

  /// Where it is looked for now: (nodes) m.
  std::span<const Vec3> position() const { return x_; }
  /// To put nodes elsewhere.
  std::span<Vec3> put() {
    told_ = told_before_ = false;
    return x_;
  }
  /// (nodes) m/s, at the end of the last step.
  std::span<const Vec3> velocity() const { return v_before_; }
  const FreeDofs& dofs() const { return dofs_; }
  /// What is unbalanced from here on is of other forces, not of an old factor.
  void push_anew() { improved_ = false; }
  /// How often A has been factored: what `solve` gave stands while this does.
  int factors() const { return factors_; }
  /// The matrix of now and its factor; inexact where it was made in the background.
  const NewtonMatrix& matrix() const { return matrix_; }
  /// The factor begun next in the background comes with its columns from these unknowns on.
  void foresee(std::vector<int> first) { foreseen_ = std::move(first); }
  /// Those that the factor of now came with; none where it is not of the background.
  const Columns& foreseen() const;
  /// Moves the unknowns by what a linearisation foretells of these forces (nodes, N), m; less far where their
  /// resistance would throw the body back.
  void follow(const Eigen::VectorXd& way, std::span<const Vec3> external);
  double kinetic_energy() const;
  /// What each node does against being where it is (nodes, N): elastic forces, viscosity, damping and
  /// inertia, at the end of the last step. Those that are held bear the rest of what acts on them.
  void resistance(std::span<Vec3> f) const;
  /// Of the last step. Stands until the next.
  Viscosity viscosity() const;
  /// With which the body resists (nodes, N), viscosity counted, at the end of the last step.
  void forces(std::span<Vec3> f) const;
  std::size_t bytes() const;
  std::size_t scratch_bytes() const { return scratch_.bytes(); }

 private:
  void factor();
  bool learns() const { return background_ && settings_.solver == DynamicsSettings::Solver::kQuasiNewton; }
  void learn(const Eigen::VectorXd& left, std::span<const Vec3> external);
  void go(const Eigen::VectorXd& way, const Eigen::VectorXd& left, std::span<const Vec3> external);
  bool never_changes() const { return solid_.material().law == ElasticLaw::kLinear; }
  void move(const Eigen::VectorXd& by);
  void shorten_prediction(std::span<const Vec3> external);
  void exchange_factors();
  void renewed();
  Eigen::VectorXd conjugate_gradients(const Eigen::VectorXd& left, std::span<const Vec3> external);
  Eigen::VectorXd stiffness_times(const Eigen::VectorXd& way, const Eigen::VectorXd& left,
                                  std::span<const Vec3> external);
  Eigen::VectorXd imbalance(std::span<const Vec3> external);
  void remember(double h);
  void resist();
  void relax_stress(double h);

  const Solid& solid_;
  Solid::Scratch scratch_;
  DynamicsSettings settings_;
  FreeDofs dofs_;
  NewtonMatrix matrix_;
  std::optional<BackgroundMatrix> background_;
  QuasiNewton quasi_newton_;
  bool from_background_ = false, too_old_ = false;  // to serve alone
  std::vector<int> foreseen_;
  std::vector<Vec3> factored_at_;  // m
  int factors_ = 0;
  bool improved_ = false, fresh_ = false;  // in this step; by a factor of the very place
  bool wary_ = false;                      // since a step that ended far from balance
  bool predicted_ = false;                 // the step has begun where its velocity led
  std::vector<Vec3> x_, x_before_, v_before_, x_then_, v_then_;  // now; last step's end; the one before
  std::vector<Vec3> from_, from_v_;                              // x~, v~
  std::vector<Vec3> internal_, internal_before_, internal_then_, from_internal_;  // f_int, likewise, N
  bool told_ = false, told_before_ = false;  // `internal_` is of here, `internal_before_` of there
  double c_ = 0, h_ = 0;
  int steps_ = 0, exchanged_ = -1;
  std::vector<Vec3> seen_;  // external forces of the last look, N
  double at_work_ = 0;      // then, N
  double left_ = 0;         // unbalanced, of the forces at work
  double remains_ = 0;      // likewise, where the last way led
  double reach_ = 0;        // size of the body, m
  double still_ = 0;        // a force that is none, N
  double rounding_ = 0;     // what is unbalanced by it, N; 0: not known
  // Viscosity: by quadrature point; terms one after the other.
  double scale_ = 1;
  std::vector<Mat3> stress_, memory_, terms_;
};

}  // namespace palpate::sim
