#include "common/contact/complementarity.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace palpate {
namespace {
constexpr int kPatience = 10;  // block exchanges allowed without progress
// Of the largest gap: rounding of an exchange, ten thousand times the unit roundoff.
constexpr double kNoise = 1e-12;
}  // namespace

ComplementaritySolver::ComplementaritySolver(int capacity)
    : factor_(capacity, capacity),
      slack_(capacity),
      feasible_(capacity),
      active_(static_cast<std::size_t>(capacity)) {
  basis_.reserve(static_cast<std::size_t>(capacity));
}

bool ComplementaritySolver::solve_on_basis(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                                           const Eigen::Ref<const Eigen::VectorXd>& gap,
                                           Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  basis_.clear();
  for (int i = 0; i < gap.size(); ++i) {
    if (active_[static_cast<std::size_t>(i)]) basis_.push_back(i);
  }
  const auto n = static_cast<Eigen::Index>(basis_.size());
  const auto size = static_cast<double>(n), all = static_cast<double>(gap.size());
  if (work_ != nullptr && !work_->spend(size * size * size / 6 + all * all)) {
    lambda.setZero();
    return false;
  }
  factor_.shape(n, n);
  auto rhs = slack_.head(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const int column = basis_[static_cast<std::size_t>(c)];
    for (Eigen::Index r = c; r < n; ++r)
      factor_(r, c) = g_matrix(basis_[static_cast<std::size_t>(r)], column);
    rhs[c] = -gap[column];
  }
  lambda.setZero();
  Eigen::Ref<Eigen::MatrixXd> in_place(factor_);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(in_place);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(rhs);
  if (!rhs.allFinite()) return false;
  for (Eigen::Index c = 0; c < n; ++c) lambda[basis_[static_cast<std::size_t>(c)]] = rhs[c];
  return true;
}

bool ComplementaritySolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                                  const Eigen::Ref<const Eigen::VectorXd>& gap,
                                  Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  if (gap.size() == 0) return true;
  const bool solved = pivot_blocks(g_matrix, gap, lambda) || add_one_by_one(g_matrix, gap, lambda);
  lambda = lambda.cwiseMax(0);
  return solved;
}

bool ComplementaritySolver::pivot_blocks(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                                         const Eigen::Ref<const Eigen::VectorXd>& gap,
                                         Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  const int n = static_cast<int>(gap.size());
  const bool guessed = lambda.maxCoeff() > 0;
  for (int i = 0; i < n; ++i) active_[static_cast<std::size_t>(i)] = guessed ? lambda[i] > 0 : gap[i] < 0;
  // What rounding alone can make of a zero; without it two coinciding contacts could trade places for ever.
  const double slack_noise = kNoise * gap.cwiseAbs().maxCoeff();
  const double force_noise = slack_noise / g_matrix.diagonal().maxCoeff();
  for (int fewest = n + 1, patience = kPatience; patience > 0; --patience) {
    if (!solve_on_basis(g_matrix, gap, lambda)) return false;
    compute_slack(g_matrix, gap, lambda);
    int infeasible = 0;
    for (int i = 0; i < n; ++i) {
      char& active = active_[static_cast<std::size_t>(i)];
      if (active ? lambda[i] >= -force_noise : slack_[i] >= -slack_noise) continue;
      ++infeasible;
      active ^= 1;
    }
    if (infeasible == 0) return true;
    if (infeasible < fewest) {
      fewest = infeasible;
      patience = kPatience;
    }
  }
  return false;
}

bool ComplementaritySolver::add_one_by_one(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                                           const Eigen::Ref<const Eigen::VectorXd>& gap,
                                           Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  const int n = static_cast<int>(gap.size());
  const double slack_noise = kNoise * gap.cwiseAbs().maxCoeff();
  std::ranges::fill(active_, 0);
  auto feasible = feasible_.head(n);
  feasible.setZero();
  for (int round = 0; round < 3 * n; ++round) {
    compute_slack(g_matrix, gap, feasible);
    int deepest = -1;
    for (int i = 0; i < n; ++i) {
      if (!active_[static_cast<std::size_t>(i)] && slack_[i] < (deepest < 0 ? -slack_noise : slack_[deepest]))
        deepest = i;
    }
    lambda = feasible;
    if (deepest < 0) return true;
    active_[static_cast<std::size_t>(deepest)] = 1;
    // Walk towards the solution on this set; whatever would turn negative on the way leaves the set.
    while (true) {
      if (!solve_on_basis(g_matrix, gap, lambda)) return false;
      double fraction = 1;
      for (const int i : basis_) {
        if (lambda[i] <= 0) fraction = std::min(fraction, feasible[i] / (feasible[i] - lambda[i]));
      }
      if (!(fraction >= 0)) fraction = 0;  // 0 / 0: the newcomer itself would turn negative
      feasible += fraction * (lambda - feasible);
      bool residual_ = false;
      for (const int i : basis_) {
        if (lambda[i] > 0 || feasible[i] > kNoise * feasible.maxCoeff()) continue;
        feasible[i] = 0;
        active_[static_cast<std::size_t>(i)] = 0;
        residual_ = true;
      }
      if (!residual_) break;
    }
  }
  return false;
}

/// slack_ = G lambda + gap.
void ComplementaritySolver::compute_slack(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                                          const Eigen::Ref<const Eigen::VectorXd>& gap,
                                          const Eigen::Ref<const Eigen::VectorXd>& lambda) noexcept {
  auto slack = slack_.head(gap.size());
  slack = gap;
  for (Eigen::Index i = 0; i < gap.size(); ++i) {
    if (lambda[i] != 0) slack += lambda[i] * g_matrix.col(i);
  }
}

}  // namespace palpate
