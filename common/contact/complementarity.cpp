#include "common/contact/complementarity.h"

#include "common/contact/dense_solve.h"

namespace palpate {
namespace {
constexpr int kPatience = 10;  // block exchanges allowed without progress before going one index at a time
constexpr double kNoise = 1e-13;
}  // namespace

ComplementaritySolver::ComplementaritySolver(int capacity)
    : factor_(capacity, capacity), slack_(capacity), active_(static_cast<std::size_t>(capacity)) {
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
  auto matrix = factor_.topLeftCorner(n, n);
  auto rhs = slack_.head(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const int column = basis_[static_cast<std::size_t>(c)];
    for (Eigen::Index r = c; r < n; ++r) matrix(r, c) = g_matrix(basis_[static_cast<std::size_t>(r)], column);
    rhs[c] = -gap[column];
  }
  lambda.setZero();
  if (!cholesky_solve(matrix, rhs)) return false;
  for (Eigen::Index c = 0; c < n; ++c) lambda[basis_[static_cast<std::size_t>(c)]] = rhs[c];
  return true;
}

bool ComplementaritySolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                                  const Eigen::Ref<const Eigen::VectorXd>& gap,
                                  Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  const int n = static_cast<int>(gap.size());
  lambda.setZero();
  for (int i = 0; i < n; ++i) active_[static_cast<std::size_t>(i)] = gap[i] < 0;
  // What rounding alone can make of a zero; without it two coinciding contacts could trade places for ever.
  const double slack_noise = n == 0 ? 0 : kNoise * gap.cwiseAbs().maxCoeff();
  const double force_noise = n == 0 ? 0 : slack_noise / g_matrix.diagonal().maxCoeff();
  int fewest = n + 1, patience = kPatience;
  for (int exchange = 0; exchange < 50 + 10 * n; ++exchange) {
    if (!solve_on_basis(g_matrix, gap, lambda)) break;
    auto slack = slack_.head(n);
    slack = gap;
    for (int i : basis_) slack += lambda[i] * g_matrix.col(i);
    const auto infeasible = [&](int i) {
      return active_[static_cast<std::size_t>(i)] ? lambda[i] < -force_noise : slack[i] < -slack_noise;
    };
    int count = 0, last = -1;
    for (int i = 0; i < n; ++i) {
      if (infeasible(i)) ++count, last = i;
    }
    if (count == 0) {
      lambda = lambda.cwiseMax(0);
      return true;
    }
    if (count < fewest) {
      fewest = count;
      patience = kPatience;
    } else {
      --patience;
    }
    for (int i = patience > 0 ? 0 : last; i <= last; ++i) {
      if (infeasible(i)) active_[static_cast<std::size_t>(i)] ^= 1;
    }
  }
  lambda = lambda.cwiseMax(0);
  return false;
}

}  // namespace palpate
