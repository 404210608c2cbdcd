#include "sim_server/solvers/newton_matrix.h"

#include <algorithm>
#include <utility>

#include "common/parallel.h"
#include "common/realtime.h"

namespace palpate::sim {
namespace {

constexpr double kFlies = 1;  // 1/s: the step of the matrix that shows whether a body that flies is sound

StiffnessMatrix at_rest(const Solid& solid, const FreeDofs& dofs, bool flies) {
  StiffnessMatrix matrix = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), matrix);
  if (flies) matrix.add_to_diagonal(solid.masses(), kFlies * kFlies);
  matrix.close_empty(matrix.lower().diagonal().mean());
  return matrix;
}

/// What the factor answers is corrected by later iterations, but of the linear law, which makes none unless
/// the body may be cut.
SparseCholesky::Precision precision_for(const Material& material, bool cut) {
  using Precision = SparseCholesky::Precision;
  return material.law == ElasticLaw::kLinear && !cut ? Precision::kDouble : Precision::kSingle;
}

}  // namespace

NewtonMatrix::NewtonMatrix(const Solid& solid, const FreeDofs& dofs, const DynamicsSettings& settings,
                           const std::string& where)
    : dofs_(&dofs),
      alpha_(settings.rayleigh_mass),
      beta_(settings.rayleigh_stiffness),
      matrix_(at_rest(solid, dofs, settings.flies)),
      mean_diagonal_(matrix_.lower().diagonal().mean()),
      factor_(matrix_.lower(), where, precision_for(solid.material(), settings.cut)) {}

int NewtonMatrix::build(const Solid& solid, std::span<const Vec3> x, std::span<const double> masses,
                        const Viscosity& viscosity, double c, Solid::Scratch& scratch) {
  c_ = 0;  // until all of this is done
  turns_.clear();
  if (parted_) matrix_ = solid.stiffness_matrix(*dofs_);
  if (solid.material().law != ElasticLaw::kLinear) {
    built_turned_.resize(x.size());
    solid.node_rotations(x, built_turned_);
  }
  matrix_.set_zero();
  solid.add_stiffness(x, matrix_, viscosity, scratch);
  matrix_.lower() *= 1 + beta_ * c;
  matrix_.add_to_diagonal(masses, c * c + alpha_ * c);
  matrix_.close_empty(mean_diagonal_);
  if (parted_) factor_.take_pattern(matrix_.lower());
  parted_ = false;
  bool definite = factor_.refactor(matrix_.lower());
  int factors = 1;
  // A quarter of what was enough last time, then ever more (Waechter and Biegler 2006, algorithm IC).
  double added = 0;
  const double first = std::clamp(more_inertia_ / 4, c * c, 1e5 * c * c);
  for (double more = first; !definite && more < 1e6 * c * c; more *= 4) {
    matrix_.add_to_diagonal(masses, more - added);
    added = more_inertia_ = more;
    ++factors;
    definite = factor_.refactor(matrix_.lower());
  }
  c_ = c;
  return factors;
}

void NewtonMatrix::turn_to(const Solid& solid, std::span<const Vec3> x) {
  if (solid.material().law == ElasticLaw::kLinear) return;
  turns_.resize(x.size());
  solid.node_rotations(x, turns_);
  for (std::size_t i = 0; i < built_turned_.size(); ++i) turns_[i] *= built_turned_[i].transpose();
}

Eigen::VectorXd NewtonMatrix::turned(const Eigen::VectorXd& v, bool back) const {
  Eigen::VectorXd out = v;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const int first = dofs_->first[i];
    if (first < 0 || dofs_->held[i] != 0) continue;  // what is held along an axis stays there
    const Vec3 at = v.segment<3>(first);
    out.segment<3>(first) = back ? Vec3(turns_[i].transpose() * at) : Vec3(turns_[i] * at);
  }
  return out;
}

Eigen::VectorXd NewtonMatrix::turned_solve(const Eigen::VectorXd& b) const {
  if (turns_.empty()) return solve(b).col(0);
  return turned(solve(turned(b, true)).col(0), false);
}

void NewtonMatrix::check_precision() {
  factor_.check_precision(matrix_.lower());
}

Eigen::MatrixXd NewtonMatrix::columns(std::span<const int> first, double enough) const {
  const auto count = static_cast<Eigen::Index>(first.size());
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(matrix_.lower().rows(), 3 * count);
  for (Eigen::Index k = 0; k < count; ++k) unit.block<3, 3>(first[k], 3 * k).setIdentity();
  Eigen::MatrixXd found = solve(unit);
  if (count == 0 || factor_.precision() == SparseCholesky::Precision::kDouble) return found;
  const Eigen::MatrixXd sample = unit.leftCols<3>() - matrix_.times(found.leftCols<3>());
  if (!(sample.norm() <= enough)) found += solve(unit - matrix_.times(found));
  return found;
}

BackgroundMatrix::BackgroundMatrix(const Solid& solid, const FreeDofs& dofs, const DynamicsSettings& settings,
                                   const std::string& where)
    : solid_(solid),
      own_(settings.cut ? std::make_optional(solid) : std::nullopt),
      scratch_(solid),
      matrix_(solid, dofs, settings, where),
      tolerance_(settings.tolerance),
      bytes_(scratch_.bytes() + matrix_.bytes() + (own_ ? own_->bytes() : 0)) {}

void BackgroundMatrix::begin(std::span<const Vec3> x, std::span<const double> masses,
                             const Viscosity& viscosity, double c, std::vector<int> first) {
  x_.assign(x.begin(), x.end());
  masses_.assign(masses.begin(), masses.end());
  if (std::exchange(outdated_, false)) {
    own_ = solid_;
    matrix_.parted();
    removed_.clear();
  }
  for (const int t : removed_) own_->remove(static_cast<std::size_t>(t));
  removed_.clear();
  of_use_ = true;
  memory_.assign(viscosity.memory.begin(), viscosity.memory.end());
  made_.first = std::move(first);
  work_ = std::async(std::launch::async, [this, scale = viscosity.scale, c] {
    make_background("palpate-factor");
    in_one_thread([&] {
      matrix_.build(body(), x_, masses_, {scale, memory_}, c, scratch_);
      made_.values = matrix_.columns(made_.first, tolerance_);
    });
  });
}

bool BackgroundMatrix::exchange(NewtonMatrix& matrix) {
  work_.get();
  if (!of_use_) return false;
  std::swap(matrix_, matrix);
  std::swap(made_, given_);
  return true;
}

}  // namespace palpate::sim
