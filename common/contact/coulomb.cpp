#include "common/contact/coulomb.h"

#include <algorithm>
#include <cmath>

#include "common/contact/dense_solve.h"

namespace palpate {
namespace {

constexpr int kMaxNewton = 16, kNear = 8;  // steps, from anywhere and from near a solution
constexpr int kHalvings = 6;               // of a step that does not gain so much
constexpr double kGain = 0.95;             // of the residual before: a shorter step must leave less
constexpr int kRounds = 2, kSweeps = 20;   // rounds of sweeps, each twice as many as before
constexpr double kTolerance = 1e-12;       // of the residual, by contact and place
// Exchanges in blocks without progress; in all: what does not end within 12 did not within 40 (64 contacts).
constexpr int kFruitless = 4, kExchanges = 12;
// Of the bound of friction: so little slip is what a solve leaves of none, and sticks.
constexpr double kTie = 1e-5;
constexpr double kPivotNoise = 1e-12;  // of the largest gap: rounding of an exchange

/// Into the disc of radius r.
Eigen::Vector2d project(const Eigen::Vector2d& v, double r) {
  const double size = v.norm();
  return size <= r ? v : Eigen::Vector2d(r / size * v);
}

}  // namespace

CoulombSolver::CoulombSolver(int contacts, int places)
    : system_(contacts + 2 * places, contacts + 2 * places),
      rhs_(contacts + 2 * places, 3),
      slack_(contacts + 3 * places),
      trial_(contacts + 2 * places),
      direction_(contacts + 2 * places),
      from_(contacts + 2 * places),
      pressure_(places),
      rho_(contacts + 2 * places),
      closed_(static_cast<std::size_t>(contacts)),
      status_(static_cast<std::size_t>(places)),
      column_(static_cast<std::size_t>(contacts + 2 * places)) {
  kept_.reserve(column_.size());
}

bool CoulombSolver::solve(const Matrix& g_matrix, const Vector& g, const FrictionPlaces& friction,
                          Eigen::Ref<Eigen::VectorXd> z, double share) noexcept {
  if (g.size() == 0) return true;
  start(g_matrix, friction);
  if (z.isZero(0)) relax(g_matrix, g, kSweeps, z);
  for (int round = 0, sweeps = kSweeps; round < kRounds; ++round, sweeps *= 2) {
    if (newton(g_matrix, g, kMaxNewton, share, z)) return true;
    if (!spend(static_cast<double>(sweeps) * static_cast<double>(z.size() * z.size()))) break;
    relax(g_matrix, g, sweeps, z);
  }
  const bool spent = work_ != nullptr && work_->is_spent();
  if (!spent && newton(g_matrix, g, kMaxNewton, share, z)) return true;
  put_into_cones(z);
  return false;
}

bool CoulombSolver::solve_near(const Matrix& g_matrix, const Vector& g, const FrictionPlaces& friction,
                               Eigen::Ref<Eigen::VectorXd> z, double share) noexcept {
  start(g_matrix, friction);
  return newton(g_matrix, g, kNear, share, z);
}

/// Takes over the problem, and force per slack, from the diagonal of G.
void CoulombSolver::start(const Matrix& g_matrix, const FrictionPlaces& friction) noexcept {
  friction_ = friction;
  const auto places = static_cast<Eigen::Index>(friction.mu.size());
  contacts_ = g_matrix.cols() - 2 * places;
  moves_ = g_matrix.rows() > g_matrix.cols();
  const auto diagonal = g_matrix.diagonal();
  for (Eigen::Index k = 0; k < contacts_; ++k) rho_[k] = 1 / diagonal[k];
  for (Eigen::Index row = contacts_; row < g_matrix.cols(); row += 2)
    rho_[row] = rho_[row + 1] = 1 / std::max(diagonal[row], diagonal[row + 1]);
}

void CoulombSolver::compute_slack(const Matrix& g_matrix, const Vector& g, const Vector& z) noexcept {
  auto slack = slack_.head(g.size());
  slack = g;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (z[i] != 0) slack += z[i] * g_matrix.col(i);
  }
}

/// Sums what presses on each place, where `force` of a contact is its normal force.
template <class Force>
void CoulombSolver::press(const Force& force) noexcept {
  pressure_.head(static_cast<Eigen::Index>(friction_.mu.size())).setZero();
  for (const FrictionPlaces::Share& s : friction_.shares)
    pressure_[s.place] += s.share * std::max(0.0, force(s.contact));
  for (int i = 0; moves_ && i < static_cast<int>(friction_.mu.size()); ++i) {
    if (pressure_[i] > 0) pressure_[i] = std::max(0.0, pressure_[i] + more_pressure(i));
  }
}

void CoulombSolver::put_into_cones(Eigen::Ref<Eigen::VectorXd> z) noexcept {
  z.head(contacts_) = z.head(contacts_).cwiseMax(0);
  press([&](int k) { return z[k]; });
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i)
    z.segment<2>(row_of(i)) = project(z.segment<2>(row_of(i)), friction_.mu[i] * pressure_[i]);
}

/// Returns what is left of the conditions: of z - Pi(z - rho w), with Pi the projection on the friction cone
/// (the radius of its cut taken from lambda as it is), in shares of what rounding makes of them; solved
/// below 1.
double CoulombSolver::residual(const Vector& g, const Vector& z) noexcept {
  const double largest_force = z.cwiseAbs().maxCoeff(), largest_gap = g.head(z.size()).cwiseAbs().maxCoeff();
  double sum = 0;
  for (Eigen::Index k = 0; k < contacts_; ++k) {
    const double along = z[k] - std::max(0.0, z[k] - rho_[k] * slack_[k]);
    sum += std::pow(along / (largest_force + rho_[k] * largest_gap), 2);
  }
  press([&](int k) { return z[k]; });
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
    const Eigen::Index row = row_of(i);
    const Eigen::Vector2d beta = z.segment<2>(row);
    const Eigen::Vector2d across =
        beta - project(beta - rho_[row] * slack_.segment<2>(row), friction_.mu[i] * pressure_[i]);
    sum += across.squaredNorm() / std::pow(largest_force + rho_[row] * largest_gap, 2);
  }
  return std::sqrt(sum) / kTolerance;
}

/// Decides which contacts are closed, and which places stick, by the augmented forces.
void CoulombSolver::classify(const Vector& z, const Vector& w) noexcept {
  for (int k = 0; k < contacts_; ++k) closed_[static_cast<std::size_t>(k)] = z[k] - rho_[k] * w[k] > 0;
  classify_places(z, w);
}

/// Decides which places stick, and which slip where to, under what the closed contacts press on them.
void CoulombSolver::classify_places(const Vector& z, const Vector& w) noexcept {
  press([&](int k) { return closed_[static_cast<std::size_t>(k)] ? 1.0 : 0.0; });
  auto pressed = from_.head(static_cast<Eigen::Index>(friction_.mu.size()));
  pressed = pressure_.head(pressed.size());
  press([&](int k) { return closed_[static_cast<std::size_t>(k)] ? z[k] : 0.0; });
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
    Status& status = status_[static_cast<std::size_t>(i)];
    status = {};
    if (!(pressed[i] > 0)) continue;
    const Eigen::Index row = row_of(i);
    const Eigen::Vector2d across = z.segment<2>(row) - rho_[row] * w.segment<2>(row);
    const double size = across.norm(), bound = friction_.mu[i] * pressure_[i];
    status.is = size <= bound ? Status::kSticks : Status::kSlips;
    if (status.is == Status::kSticks) continue;
    status.direction = across / size;
    status.fraction = bound / size;
  }
}

/// The rows of the system: of closed contacts, and of the places that they press on.
void CoulombSolver::keep_rows() noexcept {
  kept_.clear();
  std::ranges::fill(column_, -1);
  const auto keep = [this](Eigen::Index row) {
    column_[static_cast<std::size_t>(row)] = static_cast<int>(kept_.size());
    kept_.push_back(static_cast<int>(row));
  };
  for (int k = 0; k < contacts_; ++k) {
    if (closed_[static_cast<std::size_t>(k)]) keep(k);
  }
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
    if (status_[static_cast<std::size_t>(i)].is == Status::kOpen) continue;
    keep(row_of(i));
    keep(row_of(i) + 1);
  }
}

/// The rows of a Newton step over what is closed: gap and stick say G z = -g; what slips says
///   (I - kappa P) beta - mu p d + kappa rho P G_t z = -kappa rho P g_t,   P = I - d d^T,
/// where p = shares . lambda + G_p z + g_p.
void CoulombSolver::assemble(const Matrix& g_matrix) noexcept {
  keep_rows();
  const auto size = static_cast<Eigen::Index>(kept_.size());
  system_.shape(size, size);
  for (Eigen::Index c = 0; c < size; ++c) {
    for (Eigen::Index r = 0; r < size; ++r) system_(r, c) = g_matrix(kept_[r], kept_[c]);
  }
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
    const Status& status = status_[static_cast<std::size_t>(i)];
    if (status.is != Status::kSlips) continue;
    const Eigen::Index at = column_[static_cast<std::size_t>(row_of(i))];
    const double rho = rho_[row_of(i)];
    const Eigen::Vector2d normal(-status.direction[1], status.direction[0]);  // P = normal normal^T
    for (Eigen::Index c = 0; c < size; ++c) {
      auto rows = system_.block<2, 1>(at, c);
      rows = (status.fraction * normal.dot(rows)) * normal;
    }
    // Per length of slip, like the rows of G: the system keeps one scale.
    system_.block<2, 2>(at, at) +=
        (Eigen::Matrix2d::Identity() - status.fraction * normal * normal.transpose()) / rho;
    if (!moves_) continue;
    const Eigen::Index pressure = row_of(static_cast<int>(friction_.mu.size())) + i;
    for (Eigen::Index c = 0; c < size; ++c)
      system_.block<2, 1>(at, c) -= friction_.mu[i] / rho * g_matrix(pressure, kept_[c]) * status.direction;
  }
  for (const FrictionPlaces::Share& s : friction_.shares) {
    const Status& status = status_[static_cast<std::size_t>(s.place)];
    const int column = column_[static_cast<std::size_t>(s.contact)];
    if (status.is != Status::kSlips || column < 0) continue;
    system_.block<2, 1>(column_[static_cast<std::size_t>(row_of(s.place))], column) -=
        friction_.mu[s.place] * s.share / rho_[row_of(s.place)] * status.direction;
  }
}

/// Solves the assembled system for the slack `constant` at z = 0, column by column.
template <class Source, class Target>
bool CoulombSolver::solve_closed(const Source& constant, Target&& z) noexcept {
  const auto size = static_cast<Eigen::Index>(kept_.size());
  auto rhs = rhs_.topLeftCorner(size, constant.cols());
  for (Eigen::Index r = 0; r < size; ++r) rhs.row(r) = -constant.row(kept_[r]);
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
    const Status& status = status_[static_cast<std::size_t>(i)];
    if (status.is != Status::kSlips) continue;
    const Eigen::Vector2d normal(-status.direction[1], status.direction[0]);
    for (Eigen::Index c = 0; c < rhs.cols(); ++c) {
      auto across = rhs.template block<2, 1>(column_[static_cast<std::size_t>(row_of(i))], c);
      across = (status.fraction * normal.dot(across)) * normal;
      if (moves_)
        across += friction_.mu[i] / rho_[row_of(i)] *
                  constant(row_of(static_cast<int>(friction_.mu.size())) + i, c) * status.direction;
    }
  }
  z.setZero();
  if (gauss_solve(system_, rhs) == 0) return false;
  for (Eigen::Index r = 0; r < size; ++r) z.row(kept_[r]) = rhs.row(r);
  return true;
}

/// Newton steps until no more than `share` of what the conditions lacked at first remains, and what rounding
/// leaves at least.
bool CoulombSolver::newton(const Matrix& g_matrix, const Vector& g, int steps, double share,
                           Eigen::Ref<Eigen::VectorXd> z) noexcept {
  const auto n = z.size();
  auto trial = trial_.head(n), direction = direction_.head(n), from = from_.head(n),
       slack = slack_.head(g.size());
  trial = z;
  compute_slack(g_matrix, g, trial);
  double remaining = residual(g, trial);
  const double goal = std::max(1.0, share * remaining);
  for (int i = 0; i < steps && !(remaining <= 1) && !(i > 0 && remaining <= goal); ++i) {
    if (i == 0 && z.head(contacts_).maxCoeff() > 0) {
      classify_by_force(trial, slack);
    } else {
      classify(trial, slack);
    }
    if (!solve_unilateral(g_matrix, g, direction)) return false;
    from = trial;
    trial = direction;
    // Shorter steps where they go in circles, from stick to slip and back perhaps, if that gains.
    direction -= from;
    double left = 0;
    int halvings = 0;
    for (; halvings < kHalvings; ++halvings) {
      compute_slack(g_matrix, g, trial);
      left = residual(g, trial);
      if (left < kGain * remaining) break;
      direction *= 0.5;
      trial = from + direction;
    }
    if (halvings == kHalvings) {
      trial = from + (1 << kHalvings) * direction;
      compute_slack(g_matrix, g, trial);
      left = residual(g, trial);
    }
    remaining = left;
  }
  if (!(remaining <= goal)) return false;
  z = trial;
  return true;
}

void CoulombSolver::relax(const Matrix& g_matrix, const Vector& g, int sweeps,
                          Eigen::Ref<Eigen::VectorXd> z) noexcept {
  if (!z.allFinite()) z.setZero();
  compute_slack(g_matrix, g, z);
  auto slack = slack_.head(g.size());
  const auto set = [&](Eigen::Index row, double force) {
    if (force != z[row]) slack += (force - z[row]) * g_matrix.col(row);
    z[row] = force;
  };
  for (; sweeps > 0; --sweeps) {
    for (Eigen::Index k = 0; k < contacts_; ++k) set(k, std::max(0.0, z[k] - rho_[k] * slack[k]));
    press([&](int k) { return z[k]; });
    for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
      const Eigen::Index row = row_of(i);
      const Eigen::Vector2d beta =
          project(z.segment<2>(row) - rho_[row] * slack.segment<2>(row), friction_.mu[i] * pressure_[i]);
      set(row, beta[0]);
      set(row + 1, beta[1]);
    }
  }
}

/// Decides both by the forces, whatever gaps they leave: those are of another place.
void CoulombSolver::classify_by_force(const Vector& z, const Vector& w) noexcept {
  for (int k = 0; k < contacts_; ++k) closed_[static_cast<std::size_t>(k)] = z[k] > 0;
  classify_places(z, w);
}

/// Opens what pulls, closes what is passed, or only the last of these; returns how many there were.
int CoulombSolver::pivot(const Vector& z, double force_noise, double gap_noise, bool one) noexcept {
  int infeasible = 0;
  for (int k = static_cast<int>(contacts_) - 1; k >= 0; --k) {
    char& closed = closed_[static_cast<std::size_t>(k)];
    if (closed ? z[k] >= -force_noise : slack_[k] >= -gap_noise) continue;
    if (!one || infeasible == 0) closed ^= 1;
    ++infeasible;
  }
  if (infeasible == 0) return 0;
  press([&](int k) { return closed_[static_cast<std::size_t>(k)] ? 1.0 : 0.0; });
  for (int i = 0; i < static_cast<int>(friction_.mu.size()); ++i) {
    Status& status = status_[static_cast<std::size_t>(i)];
    if (!(pressure_[i] > 0)) {
      status = {};
    } else if (status.is == Status::kOpen) {
      const Eigen::Vector2d slip = slack_.segment<2>(row_of(i));
      const double size = slip.norm();
      status.is = size > 0 ? Status::kSlips : Status::kSticks;
      if (size > 0) status.direction = -slip / size;
    }
  }
  return infeasible;
}

/// A step of Newton's method for friction: solves the complementarity problem of the normal forces, with the
/// friction of each place linearised. Exchanges contacts in blocks; where that gains nothing, one by one
/// until it does, which ends for a P-matrix (Murty 1974; Judice and Pires 1994, Comput. Oper. Res. 21:587).
/// `z`: the solution, or what is nearest to one.
bool CoulombSolver::solve_unilateral(const Matrix& g_matrix, const Vector& g,
                                     Eigen::Ref<Eigen::VectorXd> z) noexcept {
  const double gap_noise = kPivotNoise * g.head(z.size()).cwiseAbs().maxCoeff();
  const double force_noise = gap_noise * rho_.head(contacts_).minCoeff();
  int fewest = static_cast<int>(z.size()), patience = kFruitless;
  for (int exchanges = 0; exchanges < kExchanges; ++exchanges, --patience) {
    assemble(g_matrix);
    const auto rows = static_cast<double>(kept_.size()), all = static_cast<double>(z.size());
    if (!spend(rows * rows * rows / 3 + all * all)) return false;
    if (!solve_closed(g, z)) return false;
    compute_slack(g_matrix, g, z);
    const int infeasible = pivot(z, force_noise, gap_noise, patience <= 0);
    if (infeasible == 0) return true;
    if (infeasible >= fewest) continue;
    fewest = infeasible;
    patience = kFruitless;
  }
  return false;
}

bool CoulombSolver::differentiate(const Matrix& g_matrix, const Vector& z, const Vector& w,
                                  const FrictionPlaces& friction,
                                  Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept {
  start(g_matrix, friction);
  classify(z, w);
  for (Status& status : std::span(status_).first(friction.mu.size())) {
    if (status.is == Status::kSlips && status.fraction > 1 - kTie) status.is = Status::kSticks;
  }
  assemble(g_matrix);
  return solve_closed(change, change.topRows(g_matrix.cols()));
}

}  // namespace palpate
