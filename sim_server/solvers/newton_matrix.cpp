#include "sim_server/solvers/newton_matrix.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/parallel.h"
#include "common/realtime.h"
#include "sim_server/solvers/dense_modes.h"
#include "sim_server/sparse/blas.h"

namespace palpate::sim {
namespace {

constexpr double kFlies = 1;  // 1/s: the step of the matrix that shows whether a body that flies is sound
// Least shift of an indefinite stiffness of a body in equilibrium, as a share of its mean diagonal entry: the
// bending of slender bodies is that much softer, and a larger shift would hide how it goes on.
constexpr double kLeastShift = 1e-12;
constexpr double kLeastOfBorder = 0.1;  // eigenvalue, of its mean diagonal, where it was not definite

StiffnessMatrix at_rest(const Solid& solid, const FreeDofs& dofs, bool flies) {
  StiffnessMatrix matrix = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), matrix);
  if (flies) matrix.add_to_diagonal(solid.masses(), kFlies * kFlies);
  matrix.close_empty(matrix.lower().diagonal().mean());
  return matrix;
}

double mean_of(std::span<const double> values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

/// Returns single precision where later iterations correct what the factor answers: not of the linear law,
/// which makes none unless the body may be cut.
SparseCholesky::Precision precision_for(const Material& material, bool cut) {
  using Precision = SparseCholesky::Precision;
  return material.law == ElasticLaw::kLinear && !cut ? Precision::kDouble : Precision::kSingle;
}

/// Replaces the lower triangle of a symmetric matrix by its Cholesky factor, of LAPACK (Eigen's takes seconds
/// to compile). Returns true if the matrix is positive definite.
bool factor_in_place(Eigen::MatrixXd& a) {
  const int n = static_cast<int>(a.rows()), lead = std::max(n, 1);
  int info = 0;
  Blas<double>::potrf("L", &n, a.data(), &lead, &info);
  return info == 0;
}

/// b <- A^-1 b, by the Cholesky factor of A in the lower triangle of `factor`.
void solve_in_place(const Eigen::MatrixXd& factor, Eigen::MatrixXd& b) {
  const int n = static_cast<int>(factor.rows()), lead = std::max(n, 1), columns = static_cast<int>(b.cols());
  int info = 0;
  Blas<double>::potrs("L", &n, &columns, factor.data(), &lead, b.data(), &lead, &info);
}

}  // namespace

NewtonMatrix::NewtonMatrix(const Solid& solid, const FreeDofs& dofs, const DynamicsSettings& settings,
                           const std::string& where, std::optional<SparseCholesky::Precision> precision)
    : dofs_(&dofs),
      alpha_(settings.rayleigh_mass),
      beta_(settings.rayleigh_stiffness),
      matrix_(at_rest(solid, dofs, settings.flies)),
      mean_diagonal_(matrix_.lower().diagonal().mean()),
      factor_(matrix_.lower(), where, precision.value_or(precision_for(solid.material(), settings.cut))) {}

void NewtonMatrix::build(const Solid& solid, std::span<const Vec3> x, std::span<const double> masses,
                         const Viscosity& viscosity, double c, Solid::Scratch& scratch) {
  c_ = 0;  // until all of this is done
  turns_.clear();
  const bool separated = !copies_.empty();
  if (separated) matrix_ = solid.stiffness_matrix(*dofs_);
  built_turned_.clear();
  if (solid.turns()) {
    built_turned_.resize(x.size());
    solid.node_rotations(x, built_turned_);
  }
  matrix_.set_zero();
  solid.add_stiffness(x, matrix_, viscosity, scratch);
  matrix_.lower() *= 1 + beta_ * c;
  inertia_ = c * c + alpha_ * c;
  matrix_.add_to_diagonal(masses, inertia_);
  matrix_.close_empty(mean_diagonal_);
  if (separated) factor_.take_pattern(matrix_.lower());
  copies_.clear();
  shapes_.clear();
  border_is_made_ = true;
  border_misfits_ = false;
  bool definite = factor_.refactor(matrix_.lower());
  shifted_ = !definite;
  // A quarter of what was enough last time, then ever more (Waechter and Biegler 2006, algorithm IC).
  double added = 0;
  const double most = c > 0 ? 1e6 * c * c : mean_diagonal_ / mean_of(masses);
  const double least = c > 0 ? c * c : kLeastShift * most;
  const double first = std::clamp(more_inertia_ / 4, least, most / 10);
  for (double more = first; !definite && more < most; more *= 4) {
    matrix_.add_to_diagonal(masses, more - added);
    inertia_ += more - added;
    added = more_inertia_ = more;
    definite = factor_.refactor(matrix_.lower());
  }
  definite_ = definite;
  c_ = c;
}

Mat3 NewtonMatrix::to_rest(int i, int j, const Mat3& block) const {
  if (turns_.empty() && built_turned_.empty()) return block;
  const auto turned = [this](int node) -> Mat3 {
    const auto n = static_cast<std::size_t>(node);
    return (turns_.empty() ? Mat3(Mat3::Identity()) : turns_[n]) *
           (built_turned_.empty() ? Mat3(Mat3::Identity()) : built_turned_[n]);
  };
  return turned(i).transpose() * block * turned(j);
}

void NewtonMatrix::part(std::span<const Split> splits) {
  for (const auto& [node, copy] : splits) {
    const auto before = std::ranges::find(copies_, node, &Copy::copy);
    copies_.push_back({before != copies_.end() ? before->node : node, copy});
    if (!built_turned_.empty())
      built_turned_[static_cast<std::size_t>(copy)] = built_turned_[static_cast<std::size_t>(node)];
  }
  if (splits.empty()) return;
  const auto size = static_cast<Eigen::Index>(3 * copies_.size());
  border_ = response_ = Eigen::MatrixXd::Zero(matrix_.lower().rows(), size);
  schur_ = std::sqrt(mean_diagonal_) * Eigen::MatrixXd::Identity(size, size);
  border_is_made_ = false;
}

int NewtonMatrix::make_border(const Solid& solid, std::span<const double> masses) {
  if (std::exchange(border_is_made_, true)) return 0;
  const int count = static_cast<int>(copies_.size());
  corner_ = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  std::vector<int> copy_of(masses.size(), -1);
  for (int k = 0; k < count; ++k) copy_of[static_cast<std::size_t>(copies_[k].copy)] = k;
  for (const auto& [tetrahedron, blocks] : shapes_) {
    const std::span<const int> nodes = solid.element(static_cast<std::size_t>(tetrahedron));
    const Mat3* block = blocks.data();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j, ++block) {
        add_to_border(copy_of, nodes[i], nodes[j], (1 + beta_ * c_) * *block);
        if (i != j) add_to_border(copy_of, nodes[j], nodes[i], (1 + beta_ * c_) * block->transpose());
      }
    }
  }
  for (const auto& [node, copy] : copies_)
    add_to_border(copy_of, copy, copy, inertia_ * masses[static_cast<std::size_t>(copy)] * Mat3::Identity());
  use_border();
  return count;
}

/// The force on node i goes by `block` (N/m) with node j.
void NewtonMatrix::add_to_border(std::span<const int> copy_of, int i, int j, const Mat3& block) {
  const int by = copy_of[static_cast<std::size_t>(j)], on = copy_of[static_cast<std::size_t>(i)];
  if (by < 0) return;
  Mat3 there = block;
  if (!built_turned_.empty())
    there = built_turned_[static_cast<std::size_t>(i)] * block *
            built_turned_[static_cast<std::size_t>(j)].transpose();
  if (on >= 0) corner_.block<3, 3>(3 * on, 3 * by) += there;
  const int node = on >= 0 ? copies_[static_cast<std::size_t>(on)].node : i, first = first_of(node);
  const HeldAxes held = dofs_->held[static_cast<std::size_t>(node)];
  for (int axis = 0; first >= 0 && axis < 3; ++axis) {
    if ((held >> axis & 1) == 0) border_.block<1, 3>(first + axis, 3 * by) += there.row(axis);
  }
}

/// Uses the border of a factor. Where that is of a body of another shape, the Schur complement need not be
/// definite: it is made so.
void NewtonMatrix::use_border() {
  response_ = factor_.solve(border_);
  response_ += factor_.solve(border_ - matrix_.times(response_));
  Eigen::MatrixXd schur = corner_ - border_.transpose() * response_;
  schur = 0.5 * (schur + schur.transpose()).eval();
  schur_ = schur;
  border_misfits_ = !factor_in_place(schur_);
  if (!border_misfits_) return;
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(schur.rows(), schur.cols());
  const double least = kLeastOfBorder * std::max(corner_.diagonal().mean(), mean_diagonal_);
  schur_ = least * unit;
  if (const auto modes = dense_modes(schur, unit))
    schur_ = modes->shapes * modes->values.cwiseMax(least).asDiagonal() * modes->shapes.transpose();
  factor_in_place(schur_);
}

Eigen::MatrixXd NewtonMatrix::solve(const Eigen::MatrixXd& b) const {
  if (copies_.empty()) return factor_.solve(b);
  Eigen::MatrixXd loads = b, separate(border_.cols(), b.cols());
  for (std::size_t k = 0; k < copies_.size(); ++k) {
    const int node = first_of(copies_[k].node), copy = first_of(copies_[k].copy);
    separate.middleRows<3>(static_cast<Eigen::Index>(3 * k)) = loads.middleRows<3>(copy);
    loads.middleRows<3>(node) += loads.middleRows<3>(copy);
    loads.middleRows<3>(copy).setZero();
  }
  Eigen::MatrixXd x = factor_.solve(loads);
  separate -= border_.transpose() * x;
  solve_in_place(schur_, separate);
  x -= response_ * separate;
  for (std::size_t k = 0; k < copies_.size(); ++k) {
    x.middleRows<3>(first_of(copies_[k].copy)) =
        x.middleRows<3>(first_of(copies_[k].node)) + separate.middleRows<3>(static_cast<Eigen::Index>(3 * k));
  }
  return x;
}

void NewtonMatrix::turn_to(const Solid& solid, std::span<const Vec3> x) {
  if (!solid.turns()) return;
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
  if (!definite_) return unit / mean_diagonal_;  // each by itself, as there is no factor
  Eigen::MatrixXd found = solve(unit);
  if (count == 0 || !copies_.empty() || factor_.precision() == SparseCholesky::Precision::kDouble)
    return found;
  const Eigen::MatrixXd sample = unit.leftCols<3>() - matrix_.times(found.leftCols<3>());
  if (!(sample.norm() <= enough)) found += solve(unit - matrix_.times(found));
  return found;
}

BackgroundMatrix::Work::Work(const Solid& body, const FreeDofs& dofs, const DynamicsSettings& settings,
                             const std::string& where)
    : solid(&body),
      own(settings.cut ? std::make_optional(body) : std::nullopt),
      scratch(body),
      matrix(body, dofs, settings, where) {}

BackgroundMatrix::BackgroundMatrix(const Solid& solid, const FreeDofs& dofs, const DynamicsSettings& settings,
                                   const std::string& where)
    : tolerance_(settings.tolerance),
      work_(std::make_shared<Work>(solid, dofs, settings, where)),
      bytes_(work_->scratch.bytes() + work_->matrix.bytes() + (work_->own ? work_->own->bytes() : 0)) {}

/// Returns the work to be changed: a copy of its own where another value shares it.
BackgroundMatrix::Work& BackgroundMatrix::own_work() {
  if (work_.use_count() > 1) work_ = std::make_shared<Work>(*work_);
  return *work_;
}

void BackgroundMatrix::part(std::span<const Split> splits) {
  outdated_ = true;
  if (!begun()) return own_work().matrix.part(splits);
  splits_.insert(splits_.end(), splits.begin(), splits.end());
}

void BackgroundMatrix::begin(std::span<const Vec3> x, std::span<const double> masses,
                             const Viscosity& viscosity, double c, std::vector<int> first) {
  Work& work = own_work();
  work.x.assign(x.begin(), x.end());
  work.masses.assign(masses.begin(), masses.end());
  if (std::exchange(outdated_, false)) {
    work.own = *work.solid;
    removed_.clear();
  }
  for (const int t : removed_) work.own->remove(static_cast<std::size_t>(t));
  removed_.clear();
  work.memory.assign(viscosity.memory.begin(), viscosity.memory.end());
  work.made.first = std::move(first);
  job_.start("palpate-factor", [&work, scale = viscosity.scale, c, tolerance = tolerance_] {
    const Solid& body = work.own ? *work.own : *work.solid;
    work.matrix.build(body, work.x, work.masses, {scale, work.memory}, c, work.scratch);
    work.made.values = work.matrix.columns(work.made.first, tolerance);
    return work.matrix.is_definite();
  });
}

bool BackgroundMatrix::exchange(NewtonMatrix& matrix) {
  bool definite = false;
  try {
    definite = *job_.take();
  } catch (...) {
    catch_up();
    throw;
  }
  if (!splits_.empty()) own_work().made = {};  // columns as if none had become two
  catch_up();
  if (!definite) return false;
  Work& work = own_work();
  std::swap(work.matrix, matrix);
  std::swap(work.made, given_);
  return true;
}

/// Applies what happened to the body since the work began.
void BackgroundMatrix::catch_up() {
  if (!shapes_.empty() || !splits_.empty()) {
    for (const auto& [tetrahedron, blocks] : shapes_) own_work().matrix.note_shape(tetrahedron, blocks);
    own_work().matrix.part(splits_);
  }
  shapes_.clear();
  splits_.clear();
}

}  // namespace palpate::sim
