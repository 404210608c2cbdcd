#pragma once
#include <Eigen/Core>
#include <vector>

#include "common/contact/bounded_matrix.h"
#include "common/contact/work_budget.h"

namespace palpate {

/// Linear complementarity problem with a symmetric positive definite matrix:
///   find lambda >= 0 with w = G lambda + g >= 0 and lambda . w = 0,
/// here contact forces lambda (N), gaps g (m) and the Delassus operator G (m/N). Solved by block principal
/// pivoting (Judice and Pires 1994, Comput. Oper. Res. 21:587): exchange every infeasible index at once,
/// usually 2 to 5 small Cholesky solves. Where that stops helping, by the active-set method of Lawson and
/// Hanson (1974, ch. 23), which lowers the energy at every step and so ends. Allocates only in the
/// constructor, and in Eigen's Cholesky factor where more than about 300 forces act at once; one thread.
/// Eigen has no such solver. ODE's, by Dantzig's method (Debian has it as a part of DART), takes 2.2 times as
/// long for 3 contacts and 1.2 to 1.7 times for 12 and 40, and allocates (`scripts/bench complementarity`).
class ComplementaritySolver {
 public:
  /// `capacity`: the largest problem `solve` will be given.
  explicit ComplementaritySolver(int capacity);
  /// Counts its work in `work` from this call on, and stops where that is spent; `work` must outlive it.
  void count_work(WorkBudget& work) noexcept { work_ = &work; }

  /// Writes lambda (n), which holds a guess: the exchanges begin with those in contact that have a force in
  /// it, or where there is none with those whose gap is negative. The solution is the same. False when the
  /// matrix was not positive definite or the bound on exchanges was reached; lambda is then finite and >= 0
  /// but not the solution. O(n^3) per exchange.
  bool solve(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix, const Eigen::Ref<const Eigen::VectorXd>& gap,
             Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

  std::size_t bytes() const { return factor_.bytes(); }

 private:
  bool pivot_blocks(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                    const Eigen::Ref<const Eigen::VectorXd>& gap,
                    Eigen::Ref<Eigen::VectorXd> lambda) noexcept;
  bool add_one_by_one(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                      const Eigen::Ref<const Eigen::VectorXd>& gap,
                      Eigen::Ref<Eigen::VectorXd> lambda) noexcept;
  void compute_slack(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                     const Eigen::Ref<const Eigen::VectorXd>& gap,
                     const Eigen::Ref<const Eigen::VectorXd>& lambda) noexcept;
  bool solve_on_basis(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                      const Eigen::Ref<const Eigen::VectorXd>& gap,
                      Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

  WorkBudget* work_ = nullptr;
  BoundedMatrix factor_;
  Eigen::VectorXd slack_, feasible_;
  std::vector<char> active_;
  std::vector<int> basis_;
};

}  // namespace palpate
