#pragma once
#include <Eigen/Core>
#include <vector>

namespace palpate {

/// Linear complementarity problem with a symmetric positive definite matrix:
///   find lambda >= 0 with w = G lambda + g >= 0 and lambda . w = 0,
/// here contact forces lambda (N), gaps g (m) and the Delassus operator G (m/N). Solved by block principal
/// pivoting (Judice and Pires 1994, Comput. Oper. Res. 21:587, algorithm 3.1): exchange every infeasible
/// index at once while that helps, else one at a time (Murty 1974), which ends for any P-matrix. Usually 2 to
/// 5 small Cholesky solves. Allocates only in the constructor; one thread.
class ComplementaritySolver {
 public:
  /// `capacity`: the largest problem `solve` will be given.
  explicit ComplementaritySolver(int capacity);

  /// Writes lambda (n). False when the matrix was not positive definite or the bound on exchanges was
  /// reached; lambda is then finite and >= 0 but not the solution. O(n^3) per exchange.
  bool solve(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix, const Eigen::Ref<const Eigen::VectorXd>& gap,
             Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

 private:
  bool solve_on_basis(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                      const Eigen::Ref<const Eigen::VectorXd>& gap,
                      Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

  Eigen::MatrixXd factor_;
  Eigen::VectorXd slack_;
  std::vector<char> active_;
  std::vector<int> basis_;
};

}  // namespace palpate
