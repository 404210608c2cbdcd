#include "sim_server/solvers/equilibrium.h"

#include <cmath>
#include <limits>
#include <optional>

#include "common/error.h"
#include "sim_server/mesh/bounding_box.h"
#include "sim_server/solvers/newton.h"
#include "sim_server/solvers/newton_matrix.h"

namespace palpate::sim {
namespace {

// Share of what the supports move by which they are nudged, to find how the residual changes.
constexpr double kSupportOffset = 1e-7;
// Share of the size of the body: a force that moves a node by less counts as none.
constexpr double kRestsWithin = 1e-7;

/// A body under a fraction of its static load, at a trial point: what Newton's method solves.
class LoadedBody {
 public:
  LoadedBody(const Solid& solid, const StaticLoad& load, const std::string& where)
      : solid_(solid),
        scratch_(solid),
        load_(load),
        dofs_(load.held),
        masses_(solid.masses()),
        matrix_(solid, dofs_, {}, where, SparseCholesky::Precision::kDouble),
        internal_(static_cast<std::size_t>(solid.nodes())),
        external_(internal_.size()),
        negligible_force_(kRestsWithin * diagonal_of(solid.rest()) * matrix_.mean_diagonal()) {}

  /// Advances from `x`, where a fraction `from` of everything acts, to a fraction `to`. False where that
  /// fails.
  bool advance(std::vector<Vec3>& x, double from, double to, const EquilibriumSettings& settings) {
    x_ = &x;
    fraction_ = to;
    if (load_.start.empty() && !move_supports(to - from)) return false;
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= settings.max_newton; ++i) {
      using End = NewtonIteration::End;
      const NewtonIteration iteration = iterate_newton(problem(), settings.tolerance);
      relative_residual_ = iteration.relative;
      const bool is_rounding = iteration.relative <= settings.rounding;
      if (iteration.end == End::kBalanced) return is_stable();
      if (iteration.end != End::kMoved || (is_rounding && iteration.relative >= before))
        return is_rounding && is_stable();
      before = iteration.relative;
      ++iterations_;
    }
    return false;
  }

  int iterations() const { return iterations_; }
  double residual() const { return relative_residual_; }

 private:
  bool is_linear() const { return solid_.material().law == ElasticLaw::kLinear; }

  /// Returns true if the stiffness at the trial point is positive definite: a body leaves any other
  /// equilibrium as it is touched. Factors it.
  bool is_stable() {
    if (is_linear()) return true;
    matrix_.build(solid_, *x_, masses_, {}, 0, scratch_);
    return !matrix_.is_shifted();
  }

  NewtonProblem problem() {
    return {.residual = [this] { return residual_here(); },
            .direction = [this](const Residual& residual) { return direction(residual.force); },
            .accept = [this](const Eigen::VectorXd& d,
                             const Residual& residual) { return search_along(d, residual); }};
  }

  /// f_ext - f_int over the free displacements, N.
  Residual residual_here() {
    solid_.forces(*x_, internal_, {}, scratch_);
    std::ranges::fill(external_, Vec3::Zero());
    if (load_.forces) load_.forces(*x_, external_);
    Residual residual{.force = Eigen::VectorXd(dofs_.count)};
    double squares = negligible_force_ * negligible_force_;
    for (std::size_t i = 0; i < internal_.size(); ++i) {
      squares += internal_[i].squaredNorm() + fraction_ * fraction_ * external_[i].squaredNorm();
      if (dofs_.first[i] < 0) continue;
      residual.force.segment<3>(dofs_.first[i]) = fraction_ * external_[i] - internal_[i];
    }
    dofs_.hold(residual.force);
    residual.force_scale = std::sqrt(squares);
    residual.relative = residual.force.norm() / residual.force_scale;
    return residual;
  }

  std::optional<Eigen::VectorXd> direction(const Eigen::VectorXd& force) {
    if (!is_linear()) matrix_.build(solid_, *x_, masses_, {}, 0, scratch_);
    if (!matrix_.is_definite()) return {};
    return matrix_.solve(force).col(0);
  }

  bool search_along(const Eigen::VectorXd& d, const Residual& residual) {
    const std::vector<Vec3> from = *x_;
    move_along(from, d);
    if (is_linear()) return true;
    const TrialStep trial = line_search(d, residual.force, [&](double s) {
      move_along(from, s * d);
      return residual_here();
    });
    if (trial.length == 0) *x_ = from;
    return trial.length > 0;
  }

  void move_along(const std::vector<Vec3>& from, const Eigen::VectorXd& d) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (dofs_.first[i] >= 0) (*x_)[i] = from[i] + d.segment<3>(dofs_.first[i]);
    }
  }

  /// The supports move on by a share of all that they do, and the body with them as its tangent stiffness
  /// says; false: it says nothing, and nothing has moved.
  bool move_supports(double fraction) {
    if (load_.moved.empty()) return true;
    const std::vector<Vec3> from = *x_;
    const auto moved_by = [&](double part) {
      std::vector<Vec3> moved = from;
      for (std::size_t i = 0; i < moved.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis)
          moved[i][axis] += (load_.held[i] >> axis & 1) != 0 ? part * load_.moved[i][axis] : 0.0;
      }
      return moved;
    };
    const Eigen::VectorXd before = residual_here().force;
    *x_ = moved_by(kSupportOffset * fraction);
    const Eigen::VectorXd pull = (residual_here().force - before) / kSupportOffset;
    *x_ = from;
    const std::optional<Eigen::VectorXd> d = direction(pull);
    if (!d) return false;
    *x_ = moved_by(fraction);
    move_along(std::vector<Vec3>(*x_), *d);
    return true;
  }

  const Solid& solid_;
  Solid::Scratch scratch_;
  const StaticLoad& load_;
  FreeDofs dofs_;
  std::vector<double> masses_;
  NewtonMatrix matrix_;
  std::vector<Vec3> internal_, external_;
  double negligible_force_;         // N
  std::vector<Vec3>* x_ = nullptr;  // the trial point
  double fraction_ = 0, relative_residual_ = 0;
  int iterations_ = 0;
};

}  // namespace

Equilibrium find_equilibrium(const Solid& solid, const StaticLoad& load, const std::string& where,
                             const std::function<void(double)>& progress,
                             const EquilibriumSettings& settings) {
  LoadedBody body(solid, load, where);
  Equilibrium found{.x = load.start.empty() ? solid.rest() : load.start};
  const double smallest = std::pow(0.5, settings.max_halvings);
  double done = 0, step = 1;
  while (done < 1) {
    std::vector<Vec3> x = found.x;
    if (body.advance(x, done, std::min(1.0, done + step), settings)) {
      done = std::min(1.0, done + step);
      found.x = std::move(x);
      ++found.increments;
      step *= 2;
      if (progress) progress(done);
    } else if ((step /= 2) < smallest) {
      fail(
          "{}: no stable equilibrium found beyond {:.3g} % of the load: a smaller load, a stiffer material, "
          "finer tetrahedra or law neo_hookean would help",
          where, 100 * done);
    }
  }
  found.iterations = body.iterations();
  found.residual = body.residual();
  return found;
}

}  // namespace palpate::sim
