#include "sim_server/solvers/quasi_newton.h"

#include <algorithm>

namespace palpate::sim {
namespace {
constexpr std::size_t kMostPairs = 8;
}

void QuasiNewton::learn(const Eigen::VectorXd& place, const Eigen::VectorXd& resistance) {
  if (last_place_.size() > 0) {
    Pair pair{place - last_place_, resistance - last_resistance_, 0};
    pair.work = pair.way.dot(pair.change);
    if (pair.work > 0) {
      if (pairs_.size() < kMostPairs) {
        pairs_.push_back(std::move(pair));
      } else {
        std::rotate(pairs_.begin(), pairs_.begin() + 1, pairs_.end());
        pairs_.back() = std::move(pair);
      }
    }
  }
  last_place_ = place;
  last_resistance_ = resistance;
}

Eigen::VectorXd QuasiNewton::step(const NewtonMatrix& matrix, const Eigen::VectorXd& left) const {
  Eigen::VectorXd rest = left;
  std::vector<double> share(pairs_.size());
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    share[k] = pairs_[k].way.dot(rest) / pairs_[k].work;
    rest -= share[k] * pairs_[k].change;
  }
  Eigen::VectorXd step = matrix.solve(rest).col(0);
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    step += (share[k] - pairs_[k].change.dot(step) / pairs_[k].work) * pairs_[k].way;
  return step;
}

}  // namespace palpate::sim
