#pragma once
#include <Eigen/Core>
#include <vector>

#include "sim_server/solvers/newton_matrix.h"

namespace palpate::sim {

/// Steps of Newton's method with a matrix of elsewhere, mended by what the last steps showed of how the
/// forces change: limited-memory BFGS (Nocedal 1980, Math. Comput. 35:773; two loops, as Nocedal and Wright
/// 2006, algorithm 7.4) that begins from A^-1. Cost of a step: one solve, and a few passes over the unknowns.
class QuasiNewton {
 public:
  /// All that was learned is of no use: another matrix.
  void forget() { pairs_.clear(), last_place_.resize(0); }
  /// The next place is not reached from the last by a step: forces have changed for other reasons.
  void begin() { last_place_.resize(0); }
  /// At `place` (m, by unknowns) the body resists with `resistance` (N).
  void learn(const Eigen::VectorXd& place, const Eigen::VectorXd& resistance);
  /// The step that would balance `left` (N, by unknowns), m.
  Eigen::VectorXd step(const NewtonMatrix& matrix, const Eigen::VectorXd& left) const;

 private:
  struct Pair {
    Eigen::VectorXd way, change;  // m, N
    double work;                  // of the one along the other, J, > 0
  };
  std::vector<Pair> pairs_;  // oldest first
  Eigen::VectorXd last_place_, last_resistance_;
};

}  // namespace palpate::sim
