#pragma once
#include <optional>

#include "sim_server/solvers/equations_of_motion.h"
#include "sim_server/solvers/factor_policy.h"
#include "sim_server/solvers/quasi_newton.h"

namespace palpate::sim {

/// The matrix A of Newton's method in a step and the Cholesky factor that finds its search directions, made
/// on demand or in the background (`FactorPolicy` decides when), and corrected by what the last iterations
/// showed
/// (`QuasiNewton`). It alone knows whether the factor is fresh, stale, outdated or of the background. A value
/// (`wait`). `motion`, in every function, is of the body of the constructor, at the trial point.
class NewtonFactor {
 public:
  struct Settings {
    bool background = false;         ///< factors come from the background, none is made on demand
    double negligible_distance = 0;  ///< m: a force that moves a node by less counts as none
    double remote_distance = 0;      ///< m: a factor of a configuration at least so far away is stale
  };
  /// Factors A at rest. Throws `Error`, beginning with `where`, when the held nodes do not hold the body. The
  /// body, and the unknowns of `motion`, must outlive this.
  NewtonFactor(const Solid& solid, const EquationsOfMotion& motion, const DynamicsSettings& dynamics,
               const Settings& settings, const std::string& where);

  /// Waits for background work, so that this can be copied.
  void wait() const {
    if (background_) background_->wait();
  }
  /// Starts a step: takes the factor of the background where one is due, or where the step before was not
  /// balanced, and has it begin the next. `damped`: a step before ended far from balance;
  /// `relative_residual`: of the last iteration of the step before.
  void start_step(EquationsOfMotion& motion, bool damped, double relative_residual);
  /// Factors A at the trial point if the step has another length than the one that A is of. Returns whether
  /// it did.
  bool match_step_length(EquationsOfMotion& motion);
  /// Prepares the search direction of an iteration that finds `residual`, where the iteration before found
  /// the relative residual `previous`. Returns false if what remains of the residual is rounding.
  bool prepare(EquationsOfMotion& motion, const Residual& residual, double previous, bool just_factored);
  /// The loads change before the next iteration: its residual says nothing of the factor.
  void loads_changed() { policy_.loads_changed(); }
  /// True if search directions are corrected by what `add_point` shows.
  bool learns() const { return background_.has_value(); }
  /// Notes that the body resists with the forces `f` (N) at `x` (m), both by unknowns.
  void add_point(const Eigen::VectorXd& x, const Eigen::VectorXd& f) { quasi_newton_.add_point(x, f); }
  /// Returns the increment (m, by unknowns) that is expected to balance `residual` (N).
  Eigen::VectorXd direction(const Eigen::VectorXd& residual) const {
    return quasi_newton_.direction(matrix_, residual);
  }
  /// True if search directions are found by conjugate gradients that `direction` preconditions.
  bool uses_conjugate_gradients() const { return policy_.uses_conjugate_gradients(); }

  /// Factors A at the trial point if the factor is of a remote one and none comes from the background.
  void refactor_if_moved(EquationsOfMotion& motion);

  /// Between two steps: these tetrahedra have been removed from the body.
  void remove(std::span<const int> tetrahedra);
  /// Between two steps, before `part`: these tetrahedra will have other shapes or corners. O(tetrahedra).
  void note_shapes(EquationsOfMotion& motion, std::span<const int> tetrahedra);
  /// Between two steps: these nodes became two. The factor is bordered until the next one.
  void part(std::span<const Split> splits);

  const NewtonMatrix& matrix() const { return matrix_; }
  /// Returns how often the factor has changed: results of its `solve` hold while this number does.
  int count() const { return count_; }
  /// Requests the columns of A^-1 from these unknowns on, with the factor begun next in the background.
  void request_columns(std::vector<int> first) { requested_columns_ = std::move(first); }
  /// Returns the columns that came with the factor in use; none where it is not of the background.
  const Columns& background_columns() const;
  std::size_t bytes() const;

 private:
  void factor(EquationsOfMotion& motion);
  void count_new();
  void exchange(EquationsOfMotion& motion);
  void note_cut();

  const Solid* solid_;
  NewtonMatrix matrix_;
  Settings settings_;
  FactorPolicy policy_;
  std::optional<BackgroundMatrix> background_;
  QuasiNewton quasi_newton_;
  bool from_background_ = false;  // the factor in use
  bool cut_since_factored_ = false;
  int count_ = 0;
  std::vector<Vec3> factored_at_;  // m, where A was factored last on demand
  std::vector<int> requested_columns_;
};

}  // namespace palpate::sim
