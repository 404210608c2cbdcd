#include "sim_server/solvers/quasi_newton.h"

#include <algorithm>

namespace palpate::sim {
namespace {
constexpr std::size_t kMostPairs = 8;  // of 3 to 20 (Nocedal and Wright, section 7.2)
}

void QuasiNewton::add_point(const Eigen::VectorXd& x, const Eigen::VectorXd& f) {
  if (last_x_.size() > 0) {
    Pair pair{x - last_x_, f - last_f_, 0};
    pair.curvature = pair.s.dot(pair.y);
    if (pair.curvature > 0) {
      if (pairs_.size() < kMostPairs) {
        pairs_.push_back(std::move(pair));
      } else {
        std::rotate(pairs_.begin(), pairs_.begin() + 1, pairs_.end());
        pairs_.back() = std::move(pair);
      }
    }
  }
  last_x_ = x;
  last_f_ = f;
}

Eigen::VectorXd QuasiNewton::direction(const NewtonMatrix& matrix, const Eigen::VectorXd& residual) const {
  Eigen::VectorXd q = residual;
  std::vector<double> alpha(pairs_.size());
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    alpha[k] = pairs_[k].s.dot(q) / pairs_[k].curvature;
    q -= alpha[k] * pairs_[k].y;
  }
  Eigen::VectorXd r = matrix.turned_solve(q);
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    r += (alpha[k] - pairs_[k].y.dot(r) / pairs_[k].curvature) * pairs_[k].s;
  return r;
}

}  // namespace palpate::sim
