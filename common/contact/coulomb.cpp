#include "common/contact/coulomb.h"

#include <algorithm>
#include <cmath>

#include "common/contact/dense_solve.h"

namespace palpate {
namespace {

constexpr int kMaxNewton = 30;  // steps
// Complete steps, wherever they lead; and how often a later one is halved until it gains.
constexpr int kFreely = 8, kHalvings = 6;
constexpr double kGain = 0.95;            // of the residual before: a halved step must leave less
constexpr int kRounds = 6, kSweeps = 20;  // rounds of sweeps, each twice as many as before
constexpr double kTolerance = 1e-12;      // of the residual, by contact

/// Into the disc of radius r.
Eigen::Vector2d project(const Eigen::Vector2d& v, double r) {
  const double size = v.norm();
  return size <= r ? v : Eigen::Vector2d(r / size * v);
}

void put_into_cones(const Eigen::Ref<const Eigen::VectorXd>& mu, Eigen::Ref<Eigen::VectorXd> z) {
  for (Eigen::Index k = 0; k < z.size(); k += 3) {
    z[k] = std::max(0.0, z[k]);
    z.segment<2>(k + 1) = project(z.segment<2>(k + 1), mu[k / 3] * z[k]);
  }
}

}  // namespace

CoulombSolver::CoulombSolver(int capacity)
    : system_(3 * capacity, 3 * capacity),
      rhs_(3 * capacity, 3),
      slack_(3 * capacity),
      trial_(3 * capacity),
      direction_(3 * capacity),
      from_(3 * capacity),
      rho_(2 * capacity),
      status_(static_cast<std::size_t>(capacity)) {
  closed_.reserve(static_cast<std::size_t>(capacity));
}

bool CoulombSolver::solve(const Matrix& g_matrix, const Vector& g, const Vector& mu,
                          Eigen::Ref<Eigen::VectorXd> z) noexcept {
  if (g.size() == 0) return true;
  scale(g_matrix);
  if (z.isZero(0)) relax(g_matrix, g, mu, kSweeps, z);
  for (int round = 0, sweeps = kSweeps; round < kRounds; ++round, sweeps *= 2) {
    if (newton(g_matrix, g, mu, z)) return true;
    if (!spend(static_cast<double>(sweeps) * static_cast<double>(z.size() * z.size()))) break;
    relax(g_matrix, g, mu, sweeps, z);
  }
  const bool spent = work_ != nullptr && work_->is_spent();
  if (!spent && newton(g_matrix, g, mu, z)) return true;
  put_into_cones(mu, z);
  return false;
}

/// Force per slack, from the diagonal of G.
void CoulombSolver::scale(const Matrix& g_matrix) noexcept {
  for (Eigen::Index k = 0; k < g_matrix.rows() / 3; ++k) {
    const auto diagonal = g_matrix.diagonal().segment<3>(3 * k);
    rho_[2 * k] = 1 / diagonal[0];
    rho_[2 * k + 1] = 1 / std::max(diagonal[1], diagonal[2]);
  }
}

void CoulombSolver::compute_slack(const Matrix& g_matrix, const Vector& g, const Vector& z) noexcept {
  auto slack = slack_.head(g.size());
  slack = g;
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    if (z[i] != 0) slack += z[i] * g_matrix.col(i);
  }
}

/// What is left of the conditions: of z - Pi(z - rho w), with Pi the projection on the friction cone (the
/// radius of its cut taken from lambda as it is), in shares of what rounding makes of them; solved below 1.
double CoulombSolver::residual(const Vector& g, const Vector& mu, const Vector& z) const noexcept {
  const double largest_force = z.cwiseAbs().maxCoeff(), largest_gap = g.cwiseAbs().maxCoeff();
  double sum = 0;
  for (Eigen::Index k = 0; k < g.size() / 3; ++k) {
    const double rho_n = rho_[2 * k], rho_t = rho_[2 * k + 1], lambda = z[3 * k];
    const double along = lambda - std::max(0.0, lambda - rho_n * slack_[3 * k]);
    const Eigen::Vector2d beta = z.segment<2>(3 * k + 1);
    const Eigen::Vector2d across =
        beta - project(beta - rho_t * slack_.segment<2>(3 * k + 1), mu[k] * std::max(0.0, lambda));
    sum += std::pow(along / (largest_force + rho_n * largest_gap), 2) +
           across.squaredNorm() / std::pow(largest_force + rho_t * largest_gap, 2);
  }
  return std::sqrt(sum) / kTolerance;
}

void CoulombSolver::classify(const Vector& z, const Vector& w, const Vector& mu) noexcept {
  closed_.clear();
  for (int k = 0; k < static_cast<int>(z.size() / 3); ++k) {
    const double along = z[3 * k] - rho_[2 * k] * w[3 * k];
    Status& status = status_[static_cast<std::size_t>(k)];
    status = {};
    if (along <= 0) continue;
    closed_.push_back(k);
    const Eigen::Vector2d across = z.segment<2>(3 * k + 1) - rho_[2 * k + 1] * w.segment<2>(3 * k + 1);
    const double size = across.norm();
    status.is = size <= mu[k] * along ? Status::kSticks : Status::kSlips;
    if (status.is == Status::kSticks) continue;
    status.direction = across / size;
    status.fraction = mu[k] * std::clamp(z[3 * k], 0.0, along) / size;
  }
}

/// The rows of a Newton step over the closed contacts: gap and stick say G z = -g; what slips says
///   (I - kappa P) beta - mu lambda d + kappa rho P G_t z = -kappa rho P g_t,   P = I - d d^T.
void CoulombSolver::assemble(const Matrix& g_matrix, const Vector& mu) noexcept {
  const auto n = static_cast<Eigen::Index>(closed_.size());
  system_.shape(3 * n, 3 * n);
  for (Eigen::Index c = 0; c < n; ++c) {
    for (Eigen::Index r = 0; r < n; ++r) {
      system_.block<3, 3>(3 * r, 3 * c) = g_matrix.block<3, 3>(3 * closed_[r], 3 * closed_[c]);
    }
  }
  for (Eigen::Index r = 0; r < n; ++r) {
    const Status& status = status_[static_cast<std::size_t>(closed_[r])];
    if (status.is != Status::kSlips) continue;
    const double rho = rho_[2 * closed_[r] + 1];
    const Eigen::Vector2d normal(-status.direction[1], status.direction[0]);  // P = normal normal^T
    for (Eigen::Index c = 0; c < 3 * n; ++c) {
      auto rows = system_.block<2, 1>(3 * r + 1, c);
      rows = (status.fraction * rho * normal.dot(rows)) * normal;
    }
    // Per length of slip, like the rows of G: the system keeps one scale.
    auto own = system_.block<2, 3>(3 * r + 1, 3 * r);
    own.col(0) -= mu[closed_[r]] * status.direction;
    own.rightCols<2>() += Eigen::Matrix2d::Identity() - status.fraction * normal * normal.transpose();
    system_.middleRows<2>(3 * r + 1) /= rho;
  }
}

/// Solves the assembled system for the slack `constant` at z = 0, column by column.
template <class Source, class Target>
bool CoulombSolver::solve_closed(const Source& constant, Target&& z) noexcept {
  const auto n = static_cast<Eigen::Index>(closed_.size());
  auto rhs = rhs_.topLeftCorner(3 * n, constant.cols());
  for (Eigen::Index r = 0; r < n; ++r) {
    auto rows = rhs.middleRows(3 * r, 3);
    rows = -constant.middleRows(3 * closed_[r], 3);
    const Status& status = status_[static_cast<std::size_t>(closed_[r])];
    if (status.is != Status::kSlips) continue;
    const Eigen::Vector2d normal(-status.direction[1], status.direction[0]);
    for (Eigen::Index c = 0; c < rhs.cols(); ++c) {
      auto across = rhs.template block<2, 1>(3 * r + 1, c);
      across = (status.fraction * normal.dot(across)) * normal;
    }
  }
  z.setZero();
  if (!gauss_solve(system_, rhs)) return false;
  for (Eigen::Index r = 0; r < n; ++r) z.middleRows(3 * closed_[r], 3) = rhs.middleRows(3 * r, 3);
  return true;
}

bool CoulombSolver::newton(const Matrix& g_matrix, const Vector& g, const Vector& mu,
                           Eigen::Ref<Eigen::VectorXd> z) noexcept {
  const auto n = z.size();
  auto trial = trial_.head(n), direction = direction_.head(n), from = from_.head(n), slack = slack_.head(n);
  trial = z;
  for (int i = 0; i < kMaxNewton; ++i) {
    compute_slack(g_matrix, g, trial);
    const double residual_ = residual(g, mu, trial);
    if (residual_ <= 1) {
      z = trial;
      return true;
    }
    classify(trial, slack, mu);
    const double rows = 3.0 * static_cast<double>(closed_.size());
    if (!spend(rows * rows * rows / 3 + static_cast<double>(n * n))) return false;
    assemble(g_matrix, mu);
    if (!solve_closed(g, direction)) return false;
    from = trial;
    trial = direction;
    if (i < kFreely) continue;
    // It goes in circles, from stick to slip and back perhaps: shorter steps, if they gain.
    direction -= from;
    int halvings = 0;
    for (; halvings < kHalvings; ++halvings) {
      compute_slack(g_matrix, g, trial);
      if (residual(g, mu, trial) < kGain * residual_) break;
      direction *= 0.5;
      trial = from + direction;
    }
    if (halvings == kHalvings) trial = from + (1 << kHalvings) * direction;
  }
  return false;
}

void CoulombSolver::relax(const Matrix& g_matrix, const Vector& g, const Vector& mu, int sweeps,
                          Eigen::Ref<Eigen::VectorXd> z) noexcept {
  if (!z.allFinite()) z.setZero();
  compute_slack(g_matrix, g, z);
  auto slack = slack_.head(g.size());
  for (; sweeps > 0; --sweeps) {
    for (Eigen::Index k = 0; k < g.size() / 3; ++k) {
      const double lambda = std::max(0.0, z[3 * k] - rho_[2 * k] * slack[3 * k]);
      if (lambda != z[3 * k]) slack += (lambda - z[3 * k]) * g_matrix.col(3 * k);
      z[3 * k] = lambda;
      const Eigen::Vector2d before = z.segment<2>(3 * k + 1);
      const Eigen::Vector2d beta =
          project(before - rho_[2 * k + 1] * slack.segment<2>(3 * k + 1), mu[k] * lambda);
      for (int axis = 0; axis < 2; ++axis) {
        if (beta[axis] != before[axis]) slack += (beta[axis] - before[axis]) * g_matrix.col(3 * k + 1 + axis);
      }
      z.segment<2>(3 * k + 1) = beta;
    }
  }
}

bool CoulombSolver::differentiate(const Matrix& g_matrix, const Vector& z, const Vector& w, const Vector& mu,
                                  Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept {
  scale(g_matrix);
  classify(z, w, mu);
  assemble(g_matrix, mu);
  return solve_closed(change, change);
}

}  // namespace palpate
