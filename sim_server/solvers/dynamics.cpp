#include "sim_server/solvers/dynamics.h"

#include <cmath>
#include <fmt/core.h>
#include <utility>

#include "common/error.h"
#include "sim_server/elasticity/inversion.h"
#include "sim_server/mesh/bounding_box.h"

namespace palpate::sim {
namespace {

// Fractions of the size of the body. A force that moves a node by less than the first counts as none, so that
// a body at rest is at rest; a factor of a configuration farther off than the second is stale; and nodes are
// moved by the third to find how forces change.
constexpr double kNegligibleDisplacement = 1e-9, kRemote = 1e-4, kOffset = 1e-7;
// Relative residuals. Where the last trial step of a step leaves more than the first, velocities mean
// nothing, and the step ends at rest: each step from there lowers the energy, however far Newton's method is
// from balance. Where no more than the second is left, and loads change by no more, the linearisation is
// accepted without a line search.
constexpr double kAdrift = 0.1, kNoSearch = 0.1;

/// True if one factor serves for ever: of a linear law, unless the body is cut.
bool one_factor_serves(const Solid& solid, const DynamicsSettings& settings) {
  return solid.material().law == ElasticLaw::kLinear && !settings.cut;
}

bool factors_in_background(const Solid& solid, const DynamicsSettings& settings) {
  return settings.solver == DynamicsSettings::Solver::kQuasiNewton && !one_factor_serves(solid, settings);
}

}  // namespace

Dynamics::Dynamics(const Solid& solid, std::vector<HeldAxes> held, const DynamicsSettings& settings,
                   const std::string& where)
    : solid_(&solid),
      linear_(one_factor_serves(solid, settings)),
      motion_(solid, std::move(held), settings),
      size_(diagonal_of(solid.rest())),
      factor_(solid, motion_, settings,
              {.background = factors_in_background(solid, settings),
               .negligible_distance = kNegligibleDisplacement * size_,
               .remote_distance = kRemote * size_},
              where) {
  motion_.set_negligible_force(kNegligibleDisplacement * size_ * factor_.matrix().mean_diagonal());
}

void Dynamics::set_state(std::vector<Vec3> x, std::span<const Vec3> v) {
  motion_.restart(std::move(x), v);
}

void Dynamics::start_step(double h) {
  trial_residual_ = 0;
  unsearched_.resize(0);
  iterated_ = false;
  at_predictor_ = true;
  motion_.start_step(h);
  factor_.start_step(motion_, damped_, relative_residual_);
}

void Dynamics::remove(std::span<const int> tetrahedra, std::span<const NodeMass> masses) {
  factor_.remove(tetrahedra);
  continue_with(masses);
}

void Dynamics::part(std::span<const Split> splits, std::span<const NodeMass> masses) {
  factor_.part(splits);
  continue_with(masses);
}

/// Continues between two steps with a body that has been cut.
void Dynamics::continue_with(std::span<const NodeMass> masses) {
  for (const auto& [node, mass] : masses) mass > 0 ? motion_.set_mass(node, mass) : motion_.stop(node);
  motion_.forget_forces();
}

Residual Dynamics::evaluate(std::span<const Vec3> external) {
  Residual residual = motion_.residual(external);
  relative_residual_ = residual.relative;
  return residual;
}

/// Moves by `d` (m) from the trial point without a line search.
void Dynamics::move_without_search(const Eigen::VectorXd& d) {
  unsearched_from_.assign(motion_.position().begin(), motion_.position().end());
  unsearched_ = d;
  motion_.move_by(d);
}

/// The residual where the last move led. One that was accepted without a line search, and led to where it
/// would not have been, is searched along instead.
Residual Dynamics::evaluate_move(std::span<const Vec3> external) {
  Residual residual = evaluate(external);
  const Eigen::VectorXd d = std::exchange(unsearched_, {});
  if (is_linear() || d.size() == 0 || residual.relative <= kNoSearch) return residual;
  motion_.move_to(unsearched_from_);
  search_along(d, motion_.residual(external), external);
  return evaluate(external);
}

double Dynamics::iterate(std::span<const Vec3> external, double tolerance) {
  iterated_ = false;  // where this throws
  const double balance = newton_iteration(external, tolerance);
  iterated_ = true;
  return balance;
}

double Dynamics::newton_iteration(std::span<const Vec3> external, double tolerance) {
  const double previous = relative_residual_;
  if (at_predictor_) limit_predictor(external);
  const bool factored = factor_.match_step_length(motion_);
  using Direction = std::optional<Eigen::VectorXd>;
  const NewtonIteration iteration =
      iterate_newton({.residual = [&] { return evaluate_move(external); },
                      .direction =
                          [&](const Residual& residual) {
                            const bool goes_on = factor_.prepare(motion_, residual, previous, factored);
                            return goes_on ? Direction(search_direction(residual, external)) : Direction();
                          },
                      .accept = [&](const Eigen::VectorXd& d,
                                    const Residual& residual) { return accept(d, residual, external); }},
                     tolerance);
  using End = NewtonIteration::End;
  if (iteration.end == End::kNotFinite) return_();
  const bool is_rounding = iteration.end == End::kNoDirection || iteration.end == End::kNotFinite;
  return is_rounding ? 0 : iteration.relative;
}

/// Moves along a search direction: searched, where the body is damped or far from balance.
bool Dynamics::accept(const Eigen::VectorXd& d, const Residual& residual, std::span<const Vec3> external) {
  if (damped_ || residual.relative > kNoSearch) {
    search_along(d, residual, external);
  } else {
    move_without_search(d);
    trial_residual_ = residual.relative;
  }
  return true;
}

/// A trial point beyond all numbers.
void Dynamics::return_() {
  motion_.move_to(motion_.time().position());
  relative_residual_ = trial_residual_ = 1;
}

int Dynamics::solve(std::span<const Vec3> external, int max_iterations, double tolerance) {
  int iterations = 0;
  while (iterations < max_iterations && iterate(external, tolerance) > tolerance) ++iterations;
  return iterations;
}

/// Returns the Newton direction, or, where A could not be factored, a little of the residual.
Eigen::VectorXd Dynamics::search_direction(const Residual& residual, std::span<const Vec3> external) {
  if (factor_.learns())
    factor_.add_point(motion_.unknowns(), -residual.force + motion_.by_unknowns(external));
  Eigen::VectorXd d = factor_.uses_conjugate_gradients() ? inexact_direction(residual, external)
                                                         : factor_.direction(residual.force);
  if (!d.allFinite()) d = residual.force / factor_.matrix().largest_diagonal();
  return d;
}

Eigen::VectorXd Dynamics::inexact_direction(const Residual& residual, std::span<const Vec3> external) {
  const std::vector<Vec3> start(motion_.position().begin(), motion_.position().end());
  const auto times = [&](const Eigen::VectorXd& v) {
    return jacobian_times(v, residual.force, kOffset * size_, [&](double s) {
      motion_.move_to(start, s * v);
      return motion_.residual(external);
    });
  };
  const auto precondition = [&](const Eigen::VectorXd& v) { return factor_.direction(v); };
  Eigen::VectorXd d = conjugate_gradients(residual.force, times, precondition);
  motion_.move_to(start);
  return d;
}

/// Moves by `d` (m) from the trial point with this residual, as far as the line search lets it.
void Dynamics::search_along(const Eigen::VectorXd& d, const Residual& residual,
                            std::span<const Vec3> external) {
  if (is_linear()) return motion_.move_by(d);
  const std::vector<Vec3> start(motion_.position().begin(), motion_.position().end());
  const TrialStep trial = line_search(d, residual.force, [&](double s) {
    motion_.move_to(start, s * d);
    return motion_.residual(external);
  });
  trial_residual_ = trial.relative;
  if (trial.length == 0) motion_.move_to(start);
}

/// Since a step that ended far from balance, and until the body rests: the predictor only as far as forces
/// would not turn the body back before it ends.
void Dynamics::limit_predictor(std::span<const Vec3> external) {
  at_predictor_ = false;
  if (is_linear() || !damped_) return;
  const Eigen::VectorXd d = motion_.move_to_start();
  search_along(d, motion_.residual(external), external);
}

void Dynamics::apply_increment(const Eigen::VectorXd& d, std::span<const Vec3> external) {
  if (!d.allFinite()) return;
  unsearched_.resize(0);
  if (is_linear()) return motion_.move_by(d);
  double squared = 0;
  for (std::size_t i = 0; i < motion_.last_external().size(); ++i)
    squared += (external[i] - motion_.last_external()[i]).squaredNorm();
  if (!damped_ && relative_residual_ <= kNoSearch &&
      std::sqrt(squared) <= kNoSearch * motion_.last_force_scale())
    return motion_.move_by(d);
  search_along(d, motion_.residual(external), external);
}

/// A step that an exception ended stands at its predictor, where no force has been at work.
void Dynamics::finish_step() {
  const bool adrift = !iterated_ || trial_residual_ > kAdrift;
  damped_ = adrift || (damped_ && relative_residual_ > kAtRest);
  motion_.end_step(adrift);
}

bool Dynamics::inside_out() const {
  return may_stay_inverted(solid_->material()) && any_inverted(*solid_, motion_.position());
}

std::size_t Dynamics::bytes() const {
  return motion_.bytes() + factor_.bytes();
}

}  // namespace palpate::sim
