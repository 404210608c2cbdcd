#pragma once
#include <vector>

#include "common/contact/bounded_matrix.h"
#include "common/contact/work_budget.h"

namespace palpate {

/// Unilateral contact with Coulomb friction on a small dense operator. For each of n contacts there are three
/// force components z = (lambda, beta_1, beta_2), N, and three slacks w = G z + g, m: the gap, and the slip
/// of the tool over the surface during a increment. Finds z with
///   lambda >= 0, w_n >= 0, lambda w_n = 0    and    |beta| <= mu lambda, beta = -mu lambda w_t / |w_t| where
///   w_t != 0
/// (Duriez, Dubois, Kheddar and Andriot 2006, IEEE TVCG 12:36, eq. 4 and 5: slip over the increment stands
/// for velocity, which is backward Euler). G need not be symmetric. Solved by semismooth Newton steps on the
/// augmented Lagrangian form (Alart and Curnier 1991, Comput. Methods Appl. Mech. Eng. 92:353), usually 2 to
/// 6 solves of a dense system of the closed contacts; where that does not end, from a better place, which
/// block Gauss-Seidel sweeps find. Allocates only in the constructor; one thread; the same input gives the
/// same output, bit by bit.
class CoulombSolver {
 public:
  /// `capacity`: the most contacts `solve` will be given.
  explicit CoulombSolver(int capacity);
  /// Counts its work in `work` from this call on, and stops where that is spent; `work` must outlive it.
  void count_work(WorkBudget& work) noexcept { work_ = &work; }

  /// `mu` (n): Coulomb's coefficient of each contact, 0: it slips freely. `z` (3n): where to start,
  /// overwritten by the solution, which obeys the conditions to 1e-12 of the largest force. False where the
  /// bound on iterations, or on work, was reached: z then lies in the friction cones, no more.
  bool solve(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix, const Eigen::Ref<const Eigen::VectorXd>& g,
             const Eigen::Ref<const Eigen::VectorXd>& mu, Eigen::Ref<Eigen::VectorXd> z) noexcept;

  /// Differentiates a solution z, with its slack w (both 3n): `change` (3n x 3) is the change of w at fixed
  /// z, overwritten by that of z. Implicit function theorem on the present contacts: contacts that are closed
  /// stay closed, those that stick stick, those that slip slip and turn with their slip. Returns false where
  /// that is singular.
  bool differentiate(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                     const Eigen::Ref<const Eigen::VectorXd>& z, const Eigen::Ref<const Eigen::VectorXd>& w,
                     const Eigen::Ref<const Eigen::VectorXd>& mu,
                     Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept;

  std::size_t bytes() const { return system_.bytes(); }

 private:
  using Matrix = Eigen::Ref<const Eigen::MatrixXd>;
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  /// State of a contact, by the augmented force z - rho w.
  struct Status {
    enum { kOpen, kSticks, kSlips } is = kOpen;
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();  // of beta, where it slips
    double fraction = 0;  // kappa = mu lambda / |beta - rho w_t|, [0, 1), where it slips
  };
  void scale(const Matrix& g_matrix) noexcept;
  void compute_slack(const Matrix& g_matrix, const Vector& g, const Vector& z) noexcept;
  double residual(const Vector& g, const Vector& mu, const Vector& z) const noexcept;
  void classify(const Vector& z, const Vector& w, const Vector& mu) noexcept;
  void assemble(const Matrix& g_matrix, const Vector& mu) noexcept;
  bool newton(const Matrix& g_matrix, const Vector& g, const Vector& mu,
              Eigen::Ref<Eigen::VectorXd> z) noexcept;
  void relax(const Matrix& g_matrix, const Vector& g, const Vector& mu, int sweeps,
             Eigen::Ref<Eigen::VectorXd> z) noexcept;
  template <class Source, class Target>
  bool solve_closed(const Source& constant, Target&& z) noexcept;

  bool spend(double multiplications) noexcept { return work_ == nullptr || work_->spend(multiplications); }

  WorkBudget* work_ = nullptr;
  BoundedMatrix system_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> rhs_;
  Eigen::VectorXd slack_, trial_, direction_, from_,
      rho_;  // rho: two per contact, N/m, along the normal and across it
  std::vector<Status> status_;
  std::vector<int> closed_;
};

}  // namespace palpate
