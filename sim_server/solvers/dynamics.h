#pragma once
#include "sim_server/solvers/newton_factor.h"

namespace palpate::sim {

/// Implicit dynamics of a body: at the end of each step of length h
///   M a + alpha M v + beta df/dt + f(x) = f_ext   (`EquationsOfMotion`; backward Euler or BDF2),
/// by Newton's method on A = (1 + beta c) K + (c^2 + alpha c) M (`NewtonMatrix`), with the factor of A that
/// `NewtonFactor` provides. Its search directions come in one of two ways:
/// - from the sparse Cholesky factor of A, where a stale one serves as long as iterations with it are not
///   slow; where three new ones in a step have not been enough, by conjugate gradients that the last of them
///   preconditions;
/// - from a factor that is made in the background, of where the body was `refresh_steps` to twice as many
///   steps before (Courtecuisse et al. 2010, Prog. Biophys. Mol. Biol. 103:159), by a quasi-Newton method
///   (`QuasiNewton`), and by conjugate gradients that the factor preconditions only in a step in which that
///   is slow (`conjugate_gradients`, `jacobian_times`), so that no matrix is assembled in a step.
/// Both balance the same forces. A value (`wait`). Steps allocate; one thread, which uses all cores for the
/// elements.
class Dynamics {
 public:
  static constexpr double kAtRest = 1e-6;  ///< relative residual of the predictor of a body that rests

  /// Starts at rest. Throws `Error`, beginning with `where`, when the held nodes do not hold the body. The
  /// body must outlive this.
  Dynamics(const Solid& solid, std::vector<HeldAxes> held, const DynamicsSettings& settings,
           const std::string& where);

  /// Waits for background work, so that this can be copied. A copy is the state of the motion as a value, of
  /// the same body; assigning it back continues from there, byte for byte.
  void wait() const { factor_.wait(); }
  /// Sets the positions `x` (nodes, m) before the first step, at rest, or at these velocities (nodes, m/s).
  void set_state(std::vector<Vec3> x, std::span<const Vec3> v = {});
  /// Begins a step of `h` (s > 0); the trial point is where the velocity leads.
  void start_step(double h);
  /// Iterates Newton's method once under these external forces (nodes, N): evaluates the residual at the
  /// trial point and, unless its relative norm is at most `tolerance`, moves the trial point. Returns the
  /// relative residual that it found; 0 where that is rounding, and where the trial point lies beyond all
  /// numbers, which puts it back to the start of the step (`relative_residual` is 1 then).
  double iterate(std::span<const Vec3> external, double tolerance = 0);
  /// Iterates at most `max_iterations` times, until the relative residual is at most `tolerance`. Returns how
  /// many times.
  int solve(std::span<const Vec3> external, int max_iterations, double tolerance);
  /// Norm of the residual that the last `iterate` found, as a share of the forces that act.
  double relative_residual() const { return relative_residual_; }
  /// True if an element that is no sliver is inverted, under a law that can have a second equilibrium there:
  /// St. Venant and Kirchhoff's, and the corotational one where nu is near one half. O(elements), a fraction
  /// of an evaluation.
  bool inside_out() const;
  /// Factors A at the trial point, where the factor is of a place elsewhere and none comes from the
  /// background.
  void refactor_if_moved() { factor_.refactor_if_moved(motion_); }
  /// The trial point is the end of the step.
  void finish_step();

  /// A node and its mass (kg) from now on.
  struct NodeMass {
    int node;
    double mass;
  };
  /// Between two steps: these tetrahedra have been removed from the body (`Solid::remove`), and with them
  /// these nodes' masses have changed; 0: nothing is left there, and the node stops where it is, with the
  /// mass that it had. The factor is stale from now on. Of a body with `DynamicsSettings::cut`. An
  /// evaluation.
  void remove(std::span<const int> tetrahedra, std::span<const NodeMass> masses);
  /// Between two steps, before `slide`, `copy` and `part`: these will have other shapes, or other corners.
  /// O(tetrahedra).
  void note_shapes(std::span<const int> tetrahedra) { factor_.note_shapes(motion_, tetrahedra); }
  /// Between two steps: a node goes towards another by this share of the way, as fast as what is there.
  void slide(int node, int towards, double fraction) { motion_.slide(node, towards, fraction); }
  /// Between two steps: a node goes on from where another is, as fast.
  void copy(int node, int copy) { motion_.slide(copy, node, 1); }
  /// Between two steps, after these: tetrahedra have other corners, or corners elsewhere (`Solid::reshape`),
  /// these nodes became two, and with them these nodes' masses have changed. The factor is stale from now on,
  /// but where the border that it gets does not fit: then the next step factors anew.
  /// Of a body with `DynamicsSettings::cut`. An evaluation.
  void part(std::span<const Split> splits, std::span<const NodeMass> masses);

  /// Between two steps: some of the body floats from now on (`Solid::release`). An evaluation.
  void release() { part({}, {}); }

  /// The trial point (nodes, m).
  std::span<const Vec3> position() const { return motion_.position(); }
  /// Returns the trial point, to prescribe nodes of it.
  std::span<Vec3> mutable_position() { return motion_.mutable_position(); }
  /// Returns the velocities at the end of the last step (nodes, m/s).
  std::span<const Vec3> velocity() const { return motion_.time().velocity(); }
  /// Returns the velocity (m/s) of a node that ends the step in hand at `x` (m).
  Vec3 velocity_at(std::size_t node, const Vec3& x) const { return motion_.time().velocity_at(node, x); }
  const FreeDofs& dofs() const { return motion_.dofs(); }
  /// The external forces change before the next `iterate`: that its residual is no smaller is not the fault
  /// of a stale factor.
  void loads_changed() {
    factor_.loads_changed();
    unsearched_.resize(0);
  }
  /// Moves the trial point by the increment `d` (m, by unknowns) that a linearisation predicts of these
  /// external forces (nodes, N); by less where the forces there would throw the body back.
  void apply_increment(const Eigen::VectorXd& d, std::span<const Vec3> external);

  /// Returns the matrix A and its factor.
  const NewtonFactor& factor() const { return factor_; }
  /// Requests the columns of A^-1 from these unknowns on, with the factor begun next in the background.
  void request_columns(std::vector<int> first) { factor_.request_columns(std::move(first)); }

  /// Returns the kinetic energy at the end of the last step, J.
  double kinetic_energy() const { return motion_.kinetic_energy(); }
  /// Writes the resistance of each node (nodes, N) at the end of the last step: elastic and viscous forces,
  /// damping and inertia. Nodes that are held bear the rest of what acts on them.
  void resistance(std::span<Vec3> f) const { motion_.resistance(f); }
  /// Writes the elastic and viscous forces alone (nodes, N).
  void internal_forces(std::span<Vec3> f) const { motion_.internal_forces(f); }
  /// Returns the viscosity of the last step, valid until the next one starts.
  Viscosity viscosity() const { return motion_.viscosity(); }
  std::size_t bytes() const;
  /// Returns the scratch memory of the elements, bytes.
  std::size_t scratch_bytes() const { return motion_.scratch_bytes(); }

 private:
  /// True if one iteration with one factor solves each step.
  bool is_linear() const { return linear_; }
  Residual evaluate(std::span<const Vec3> external);
  Residual evaluate_move(std::span<const Vec3> external);
  void move_without_search(const Eigen::VectorXd& d);
  void return_();
  void continue_with(std::span<const NodeMass> masses);
  double newton_iteration(std::span<const Vec3> external, double tolerance);
  bool accept(const Eigen::VectorXd& d, const Residual& residual, std::span<const Vec3> external);
  Eigen::VectorXd search_direction(const Residual& residual, std::span<const Vec3> external);
  Eigen::VectorXd inexact_direction(const Residual& residual, std::span<const Vec3> external);
  void search_along(const Eigen::VectorXd& d, const Residual& residual, std::span<const Vec3> external);
  void limit_predictor(std::span<const Vec3> external);

  const Solid* solid_;
  bool linear_;
  EquationsOfMotion motion_;
  double size_;  // of the body, m
  NewtonFactor factor_;
  double relative_residual_ = 0;  // that the last iteration found
  Eigen::VectorXd unsearched_;    // m, the last move, if it was without a line search; else empty
  std::vector<Vec3> unsearched_from_;
  bool iterated_ = false;      // in this step, to an end
  double trial_residual_ = 0;  // relative, at the last trial step of this step; 1: none was accepted
  bool at_predictor_ = false;  // no iteration of this step has been
  bool damped_ = false;        // a step ended far from balance, and the body has not come to rest since
};

}  // namespace palpate::sim
