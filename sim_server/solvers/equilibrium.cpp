#include "sim_server/solvers/equilibrium.h"

#include <cmath>
#include <limits>

#include "common/error.h"
#include "sim_server/mesh/bounding_box.h"
#include "sim_server/solvers/newton.h"

namespace palpate::sim {
namespace {

constexpr double kArmijo = 1e-4;  // sufficient decrease in a line search
// Share of what the supports move by which they are nudged, to find how the residual changes.
constexpr double kSupportOffset = 1e-7;
// Share of the size of the body: a force that moves a node by less counts as none.
constexpr double kRestsWithin = 1e-7;
constexpr double kFirstShift = 0.05, kLastShift = 1e3;  // of the stiffness at rest

class Newton {
 public:
  Newton(const Solid& solid, const StaticLoad& load, const std::string& where,
         const EquilibriumSettings& settings)
      : solid_(solid),
        scratch_(solid),
        load_(load),
        settings_(settings),
        dofs_(load.held),
        stiffness_(solid.stiffness_matrix(dofs_)),
        internal_(static_cast<std::size_t>(solid.nodes())),
        external_(internal_.size()) {
    solid.add_stiffness(solid.rest(), stiffness_, {}, scratch_);
    mean_diagonal_ = stiffness_.lower().diagonal().mean();
    stiffness_.close_empty(mean_diagonal_);
    factor_.emplace(stiffness_.lower(), where, SparseCholesky::Precision::kSingle);
    negligible_force_ = kRestsWithin * diagonal_of(solid.rest()) * mean_diagonal_;
  }

  /// Advances from `x`, where a fraction `from` of everything acts, to a fraction `to`. False where that
  /// fails.
  bool advance(std::vector<Vec3>& x, double from, double to) {
    fraction_ = to;
    if (load_.start.empty() && !move_supports(x, to - from)) return false;
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= settings_.max_newton; ++i) {
      const Eigen::VectorXd residual = residual_at(x);
      if (!std::isfinite(relative_residual_)) return false;
      const bool stuck = relative_residual_ >= before && relative_residual_ <= settings_.rounding;
      if (relative_residual_ <= settings_.tolerance || stuck) return true;
      before = relative_residual_;
      ++iterations_;
      if (!step(x, residual)) return relative_residual_ <= settings_.rounding;
    }
    return false;
  }

  int iterations() const { return iterations_; }
  double residual() const { return relative_residual_; }

 private:
  bool is_linear() const { return solid_.material().law == ElasticLaw::kLinear; }

  /// f_ext - f_int over the free displacements, N.
  Eigen::VectorXd residual_at(const std::vector<Vec3>& x) {
    solid_.forces(x, internal_, {}, scratch_);
    std::ranges::fill(external_, Vec3::Zero());
    if (load_.forces) load_.forces(x, external_);
    Eigen::VectorXd residual(dofs_.count);
    double squares = negligible_force_ * negligible_force_;
    for (std::size_t i = 0; i < internal_.size(); ++i) {
      squares += internal_[i].squaredNorm() + fraction_ * fraction_ * external_[i].squaredNorm();
      if (dofs_.first[i] >= 0) residual.segment<3>(dofs_.first[i]) = fraction_ * external_[i] - internal_[i];
    }
    dofs_.hold(residual);
    relative_residual_ = residual.norm() / std::sqrt(squares);
    return residual;
  }

  bool factor_at(const std::vector<Vec3>& x) {
    if (is_linear()) return true;  // as at rest, everywhere
    stiffness_.set_zero();
    solid_.add_stiffness(x, stiffness_, {}, scratch_);
    stiffness_.close_empty(mean_diagonal_);
    if (factor_->refactor(stiffness_.lower())) return true;
    StiffnessMatrix at_rest = solid_.stiffness_matrix(dofs_);
    solid_.add_stiffness(solid_.rest(), at_rest, {}, scratch_);
    at_rest.close_empty(mean_diagonal_);
    double added = 0;
    for (double shift = kFirstShift; shift < kLastShift; shift *= 4) {
      stiffness_.lower() += (shift - added) * at_rest.lower();
      added = shift;
      if (factor_->refactor(stiffness_.lower())) return true;
    }
    return false;
  }

  double potential(const std::vector<Vec3>& x) {
    double work = 0;
    for (std::size_t i = 0; i < x.size(); ++i) work += fraction_ * external_[i].dot(x[i] - solid_.rest()[i]);
    return solid_.energy(x, scratch_) - work;
  }

  bool step(std::vector<Vec3>& x, const Eigen::VectorXd& residual) {
    if (!factor_at(x)) return false;
    const Eigen::VectorXd d = factor_->solve(residual).col(0);
    const std::vector<Vec3> from = x;
    if (is_linear()) {
      move_along(from, 1, d, x);
      return true;
    }
    const double before = potential(x), slope = residual.dot(d), norm = residual.norm();
    const std::vector<Vec3> external =
        external_;  // a pressure changes as the body does: the energy is that of this one
    for (double length = 1; length > kShortestTrialStep; length /= 2) {
      move_along(from, length, d, x);
      external_ = external;
      if (potential(x) <= before - kArmijo * length * slope || residual_at(x).norm() < norm) return true;
    }
    x = from;
    return false;
  }

  void move_along(const std::vector<Vec3>& from, double length, const Eigen::VectorXd& d,
                  std::vector<Vec3>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (dofs_.first[i] >= 0) x[i] = from[i] + length * d.segment<3>(dofs_.first[i]);
    }
  }

  /// The supports move on by a share of all that they do, and the body with them as its tangent stiffness
  /// says; false: it says nothing, and nothing has moved.
  bool move_supports(std::vector<Vec3>& x, double fraction) {
    if (load_.moved.empty()) return true;
    const auto moved_by = [&](double part) {
      std::vector<Vec3> moved = x;
      for (std::size_t i = 0; i < x.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis)
          moved[i][axis] += (load_.held[i] >> axis & 1) != 0 ? part * load_.moved[i][axis] : 0.0;
      }
      return moved;
    };
    const std::vector<Vec3> ahead = moved_by(kSupportOffset * fraction);
    const Eigen::VectorXd before = residual_at(x);
    const Eigen::VectorXd pull = (residual_at(ahead) - before) / kSupportOffset;
    if (!factor_at(x)) return false;
    const Eigen::VectorXd d = factor_->solve(pull).col(0);
    x = moved_by(fraction);
    move_along(x, 1, d, x);
    return true;
  }

  const Solid& solid_;
  Solid::Scratch scratch_;
  const StaticLoad& load_;
  const EquilibriumSettings& settings_;
  FreeDofs dofs_;
  StiffnessMatrix stiffness_;
  std::optional<SparseCholesky> factor_;
  std::vector<Vec3> internal_, external_;
  double mean_diagonal_ = 0;     // of the stiffness at rest, N/m
  double negligible_force_ = 0;  // N
  double fraction_ = 0, relative_residual_ = 0;
  int iterations_ = 0;
};

}  // namespace

Equilibrium find_equilibrium(const Solid& solid, const StaticLoad& load, const std::string& where,
                             const std::function<void(double)>& progress,
                             const EquilibriumSettings& settings) {
  Newton newton(solid, load, where, settings);
  Equilibrium found{.x = load.start.empty() ? solid.rest() : load.start};
  const double smallest = std::pow(0.5, settings.max_halvings);
  double done = 0, step = 1;
  while (done < 1) {
    std::vector<Vec3> x = found.x;
    if (newton.advance(x, done, std::min(1.0, done + step))) {
      done = std::min(1.0, done + step);
      found.x = std::move(x);
      ++found.increments;
      step *= 2;
      if (progress) progress(done);
    } else if ((step /= 2) < smallest) {
      fail(
          "{}: no equilibrium found beyond {:.3g} % of the load: a smaller load, a stiffer material, finer "
          "tetrahedra or law neo_hookean would help",
          where, 100 * done);
    }
  }
  found.iterations = newton.iterations();
  found.residual = newton.residual();
  return found;
}

}  // namespace palpate::sim
