#include "common/contact/closed_contacts.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace palpate {
namespace {

constexpr int kMostIterations = 200;

}  // namespace

ClosedContacts::ClosedContacts(int max_unknowns, int max_contacts, int max_entries, int max_blocks)
    : pressed_(max_unknowns, max_contacts),
      factor_(max_contacts, max_contacts),
      held_(max_contacts),
      steps_(max_unknowns, 5) {
  entries_.reserve(static_cast<std::size_t>(max_entries));
  ends_.reserve(static_cast<std::size_t>(max_contacts));
  blocks_.reserve(static_cast<std::size_t>(max_blocks));
}

void ClosedContacts::start(const BoundedMatrix& compliance, double give, WorkBudget& work) noexcept {
  compliance_ = &compliance;
  give_ = give;
  work_ = &work;
  blocks_.clear();
  open_all();
}

void ClosedContacts::add_curvature(int row, int column, const Mat3& block) noexcept {
  blocks_.push_back({row, column, block});
}

void ClosedContacts::open_all() noexcept {
  entries_.clear();
  ends_.clear();
}

void ClosedContacts::close(std::span<const GapChange> row) noexcept {
  entries_.insert(entries_.end(), row.begin(), row.end());
  ends_.push_back(entries_.size());
}

std::span<const ClosedContacts::GapChange> ClosedContacts::row(Eigen::Index contact) const noexcept {
  const auto k = static_cast<std::size_t>(contact);
  const std::size_t first = k == 0 ? 0 : ends_[k - 1];
  return std::span(entries_).subspan(first, ends_[k] - first);
}

double ClosedContacts::along(std::span<const GapChange> row,
                             const Eigen::Ref<const Eigen::VectorXd>& v) noexcept {
  double change = 0;
  for (const GapChange& entry : row)
    change += entry.by[0] * v[entry.at] + (entry.by[1] * v[entry.at + 1] + entry.by[2] * v[entry.at + 2]);
  return change;
}

bool ClosedContacts::factor() noexcept {
  const auto n = static_cast<Eigen::Index>(ends_.size()), size = compliance_->rows();
  const auto contacts = static_cast<double>(n), unknowns = static_cast<double>(size);
  if (!work_->spend(contacts * (12 * unknowns + 6 * contacts + contacts * contacts / 6))) return false;
  pressed_.shape(size, n);
  factor_.shape(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    auto column = pressed_.col(k);
    column.setZero();
    for (const GapChange& entry : row(k))
      column += compliance_->middleCols<3>(entry.at).lazyProduct(entry.by);
    for (Eigen::Index i = k; i < n; ++i) factor_(i, k) = along(row(i), column);
    factor_(k, k) += give_;
  }
  Eigen::Ref<Eigen::MatrixXd> in_place(factor_);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
}

namespace {

/// Solves with a Cholesky factor L, in place of its right side.
void solve_by(const BoundedMatrix& factor, Eigen::Ref<Eigen::VectorXd> x) noexcept {
  factor.triangularView<Eigen::Lower>().solveInPlace(x);
  factor.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
}

}  // namespace

void ClosedContacts::find_forces(Eigen::Ref<Eigen::VectorXd> gaps,
                                 const Eigen::Ref<const Eigen::VectorXd>& loads) noexcept {
  gaps = -gaps;
  gaps.noalias() -= pressed_.transpose() * loads;
  solve_by(factor_, gaps);
}

void ClosedContacts::press(const Eigen::Ref<const Eigen::VectorXd>& forces,
                           Eigen::Ref<Eigen::VectorXd> moved) const noexcept {
  moved.noalias() = pressed_ * forces;
}

void ClosedContacts::curve(const Eigen::Ref<const Eigen::VectorXd>& v,
                           Eigen::Ref<Eigen::VectorXd> loads) const noexcept {
  loads.setZero();
  for (const Block& block : blocks_)
    loads.segment<3>(block.row) += block.value.lazyProduct(v.segment<3>(block.column));
}

/// P of loads.
void ClosedContacts::hold(const Eigen::Ref<const Eigen::VectorXd>& loads,
                          Eigen::Ref<Eigen::VectorXd> moved) noexcept {
  auto forces = held_.head(static_cast<Eigen::Index>(ends_.size()));
  forces.setZero();
  find_forces(forces, loads);
  moved.noalias() = *compliance_ * loads;
  moved.noalias() += pressed_ * forces;
}

bool ClosedContacts::bend(Eigen::Ref<Eigen::VectorXd> v, double tolerance) noexcept {
  const Eigen::Index size = v.size();
  auto residual = steps_.col(0).head(size), moved = steps_.col(1).head(size), way = steps_.col(2).head(size),
       loads = steps_.col(3).head(size), uphill = steps_.col(4).head(size);
  const auto unknowns = static_cast<double>(size), contacts = static_cast<double>(ends_.size());
  const double work = unknowns * (unknowns + 2 * contacts + 8) + contacts * contacts +
                      9 * static_cast<double>(blocks_.size());
  curve(v, residual);
  hold(residual, moved);
  way = moved;
  loads = residual;
  double energy = residual.dot(moved);
  const double enough = tolerance * tolerance * energy;
  for (int i = 0; i < kMostIterations; ++i) {
    if (energy <= enough) return true;
    if (!work_->spend(work)) return false;
    curve(way, uphill);
    uphill = loads - uphill;
    const double rise = way.dot(uphill);
    if (!(rise > 0)) return false;
    const double step = energy / rise;
    v += step * way;
    residual -= step * uphill;
    hold(residual, moved);
    const double before = energy;
    energy = residual.dot(moved);
    way = moved + energy / before * way;
    loads = residual + energy / before * loads;
  }
  return false;
}

}  // namespace palpate
