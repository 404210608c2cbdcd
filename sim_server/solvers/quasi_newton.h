#pragma once
#include <Eigen/Core>
#include <vector>

#include "sim_server/solvers/newton_matrix.h"

namespace palpate::sim {

/// Search directions of Newton's method with a stale factor, corrected by what the last iterations showed of
/// how the forces change: limited-memory BFGS (Nocedal 1980, Math. Comput. 35:773; the two-loop recursion of
/// Nocedal and Wright 2006, algorithm 7.4) that begins from A^-1. Vectors are by unknowns. A direction costs
/// one solve and a few passes over the unknowns.
class QuasiNewton {
 public:
  /// Forgets all points, as for another matrix.
  void clear() { pairs_.clear(), last_x_.resize(0); }
  /// The next point is not compared with the last: forces have changed for other reasons between them.
  void restart() { last_x_.resize(0); }
  /// Adds a point: at `x` (m) the body resists with the forces `f` (N).
  void add_point(const Eigen::VectorXd& x, const Eigen::VectorXd& f);
  /// The increment (m) that is expected to balance `residual` (N).
  Eigen::VectorXd direction(const NewtonMatrix& matrix, const Eigen::VectorXd& residual) const;

 private:
  struct Pair {
    Eigen::VectorXd s, y;  // change of place, m, and of force, N
    double curvature;      // s . y, J, > 0
  };
  std::vector<Pair> pairs_;  // oldest first
  Eigen::VectorXd last_x_, last_f_;
};

}  // namespace palpate::sim
