#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>

namespace palpate::sim {

/// Residual r(x) of the forces that should balance, by unknowns.
struct Residual {
  Eigen::VectorXd force;   ///< N
  double force_scale = 1;  ///< norm of all forces that act, N, > 0
  double relative = 0;     ///< norm of `force`, as a share of `force_scale`
};

/// Equations r(x) = 0 at a trial point x that moves, as Newton's method sees them.
struct NewtonProblem {
  /// Evaluates r at the trial point.
  std::function<Residual()> residual;
  /// Finds the search direction (m, by unknowns) for the residual of the trial point; nothing where that is
  /// rounding, or no direction is to be found.
  std::function<std::optional<Eigen::VectorXd>(const Residual& residual)> direction;
  /// Moves the trial point along `d` as far as is acceptable. False if no step was: it stays.
  std::function<bool(const Eigen::VectorXd& d, const Residual& residual)> accept;
};

/// Outcome of an iteration of Newton's method.
struct NewtonIteration {
  enum class End {
    kMoved,        ///< the trial point has moved
    kBalanced,     ///< the residual is within the tolerance
    kNoDirection,  ///< `NewtonProblem::direction` found none
    kNotAccepted,  ///< `NewtonProblem::accept` accepted no step
    kNotFinite,    ///< the trial point lies beyond all numbers
  };
  End end = End::kMoved;
  double relative = 0;  ///< relative residual that the iteration found at the trial point
};

/// Runs one iteration of Newton's method: evaluates the residual and, unless its relative norm is at most
/// `tolerance`, moves the trial point along the search direction (Nocedal and Wright 2006, algorithm 11.4).
NewtonIteration iterate_newton(const NewtonProblem& problem, double tolerance);

/// r(x + s d) for step lengths s along a direction d that is understood; x is where the solver stands.
using ResidualAlong = std::function<Residual(double s)>;
/// A v for the vectors v (by unknowns) of a solver.
using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd& v)>;

/// Line searches try no shorter step, of the search direction.
constexpr double kShortestTrialStep = 1e-4;

/// Outcome of a line search.
struct TrialStep {
  double length = 0;    ///< s, (0, 1]; 0: no trial step was accepted
  double relative = 1;  ///< relative residual there; 1: no trial step was accepted
};

/// Backtracking line search along the search direction `d` (m, by unknowns) from where the residual is
/// `force` (N): the first s of 1, 1/2, 1/4 ... above `kShortestTrialStep` at which
///   d . r(x + s d) >= -|d . r(x)|,
/// so that the forces there do not pull back harder than those here push on. Forces that grow faster than
/// their linearisation would otherwise throw a body farther each time. Matthies and Strang (1979, Int. J.
/// Numer. Meth. Engng 14:1613) ask the same projection to fall to one half; that costs more evaluations, and
/// far from balance keeps nothing from being thrown. A trial step whose relative residual is exactly 1 is
/// refused: nothing there answers the load. `residual_along` is last called at the step accepted.
TrialStep line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& force,
                      const ResidualAlong& residual_along);

/// When conjugate gradients end.
struct ConjugateGradientSettings {
  double tolerance = 0.1;  ///< share of the norm of b that may be left, > 0
  int max_iterations = 20;
};

/// The search direction of an inexact Newton method: x with A x = b to within a share of b, by conjugate
/// gradients with preconditioner P ~ A^-1, from x = 0 (Nocedal and Wright 2006, algorithms 5.3 and 7.1).
/// `times` is v -> A v and `precondition` is v -> P v. Where A turns out not to be positive definite along a
/// direction, as of a body about to buckle: what was found before, or P b where that is nothing. One
/// product and one preconditioning for each iteration.
Eigen::VectorXd conjugate_gradients(const Eigen::VectorXd& b, const LinearMap& times,
                                    const LinearMap& precondition,
                                    const ConjugateGradientSettings& settings = {});

/// A d for the Jacobian A = -dr/dx at x, from a difference of residuals (Knoll and Keyes 2004, J. Comput.
/// Phys. 193:357), so that no matrix is assembled: (r(x) - r(x + s d)) / s with an s by which no unknown
/// moves more than `offset` (m, > 0). `force` is r(x), N. One call of `residual_along`.
Eigen::VectorXd jacobian_times(const Eigen::VectorXd& d, const Eigen::VectorXd& force, double offset,
                               const ResidualAlong& residual_along);

}  // namespace palpate::sim
