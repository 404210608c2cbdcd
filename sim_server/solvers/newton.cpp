#include "sim_server/solvers/newton.h"

#include <cmath>

namespace palpate::sim {

NewtonIteration iterate_newton(const NewtonProblem& problem, double tolerance) {
  using End = NewtonIteration::End;
  const Residual residual = problem.residual();
  if (!std::isfinite(residual.relative)) return {End::kNotFinite, residual.relative};
  if (residual.relative <= tolerance) return {End::kBalanced, residual.relative};
  const std::optional<Eigen::VectorXd> d = problem.direction(residual);
  if (!d) return {End::kNoDirection, residual.relative};
  return {problem.accept(*d, residual) ? End::kMoved : End::kNotAccepted, residual.relative};
}

TrialStep line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& force,
                      const ResidualAlong& residual_along) {
  const double push = std::abs(force.dot(d));
  for (double s = 1; s > kShortestTrialStep; s /= 2) {
    const Residual trial = residual_along(s);
    if (trial.force.dot(d) >= -push && trial.relative != 1) return {s, trial.relative};
  }
  return {};
}

Eigen::VectorXd conjugate_gradients(const Eigen::VectorXd& b, const LinearMap& times,
                                    const LinearMap& precondition,
                                    const ConjugateGradientSettings& settings) {
  const double enough = settings.tolerance * b.norm();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), residual = b, direction = x;
  double before = 1;
  for (int i = 0; i < settings.max_iterations && residual.norm() > enough; ++i) {
    const Eigen::VectorXd preconditioned = precondition(residual);
    const double now = residual.dot(preconditioned);
    direction = preconditioned + now / before * direction;
    before = now;
    const Eigen::VectorXd product = times(direction);
    const double curvature = direction.dot(product);
    if (!(curvature > 0)) return i == 0 ? direction : x;
    x += now / curvature * direction;
    residual -= now / curvature * product;
  }
  return x;
}

Eigen::VectorXd jacobian_times(const Eigen::VectorXd& d, const Eigen::VectorXd& force, double offset,
                               const ResidualAlong& residual_along) {
  const double s = offset / d.cwiseAbs().maxCoeff();
  return (force - residual_along(s).force) / s;
}

}  // namespace palpate::sim
