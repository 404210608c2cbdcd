#pragma once
#include <span>
#include <vector>

#include "common/contact/bounded_matrix.h"
#include "common/contact/work_budget.h"

namespace palpate {

/// Places at which friction acts, m of them, each pressed by its shares of the normal forces of n contacts.
/// Where G and g have m rows more than there are forces, these give the further force that presses on each
/// place, N, as shares change with the motion of the surface.
struct FrictionPlaces {
  struct Share {
    int contact, place;
    double share;  ///< of the normal force of the contact, 0 to 1
  };
  std::span<const Share> shares;
  std::span<const double> mu;  ///< (m) Coulomb's coefficient of each place, 0: it slips freely
};

/// Unilateral contact with Coulomb friction on a small dense operator. The forces z are those of n contacts
/// along their normals, lambda, and two components across the normal of each of m places, beta, all in N; of
/// the same order are the slacks w = G z + g, m: gaps, and slips of the tool over the surface during an
/// increment. Finds z with
///   lambda >= 0, w_n >= 0, lambda w_n = 0    and    |beta| <= mu p, beta = -mu p w_t / |w_t| where w_t != 0
/// where p is what presses on the place (Duriez, Dubois, Kheddar and Andriot 2006, IEEE TVCG 12:36, eq. 4 and
/// 5: slip over the increment stands for velocity, which is backward Euler). G need not be symmetric. Several
/// contacts may share the place of their friction: so the problem stays well posed where contacts are more
/// than the nodes that they touch. Semismooth Newton steps on the augmented Lagrangian form of friction
/// (Alart and Curnier 1991, Comput. Methods Appl. Mech. Eng. 92:353); in each, the contacts that are closed
/// are found by block pivoting (Judice and Pires 1994, Comput. Oper. Res. 21:587), with the friction of each
/// place linearised: one or two solves of a dense system of what is closed. Where that does not end, it
/// begins again from a better place, which Gauss-Seidel sweeps find. Allocates only in the constructor; one
/// thread; the same input gives the same output, bit by bit.
class CoulombSolver {
 public:
  /// `contacts`, `places`: the most that `solve` will be given.
  CoulombSolver(int contacts, int places);
  /// Counts its work in `work` from this call on, and stops where that is spent; `work` must outlive it.
  void count_work(WorkBudget& work) noexcept { work_ = &work; }

  /// `z` (n + 2 m): where to start, overwritten by the solution, which obeys the conditions to 1e-12 of the
  /// largest force, or within `share` of what they lacked at the start. False where the bound on iterations,
  /// or on work, was reached: z then lies in the friction cones, no more.
  bool solve(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix, const Eigen::Ref<const Eigen::VectorXd>& g,
             const FrictionPlaces& friction, Eigen::Ref<Eigen::VectorXd> z, double share = 0) noexcept;
  /// Solves from a `z` near the solution. False, with `z` unchanged, soon after it turns out to be far.
  bool solve_near(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                  const Eigen::Ref<const Eigen::VectorXd>& g, const FrictionPlaces& friction,
                  Eigen::Ref<Eigen::VectorXd> z, double share = 0) noexcept;

  /// Differentiates a solution z, with its slack w (both n + 2 m): `change` (n + 2 m, 3) is the change of w
  /// at fixed z, overwritten by that of z. Implicit function theorem on the present contacts: contacts that
  /// are closed stay closed, places that stick stick, those that slip slip and turn with their slip. Returns
  /// false where that is singular.
  bool differentiate(const Eigen::Ref<const Eigen::MatrixXd>& g_matrix,
                     const Eigen::Ref<const Eigen::VectorXd>& z, const Eigen::Ref<const Eigen::VectorXd>& w,
                     const FrictionPlaces& friction,
                     Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept;

  std::size_t bytes() const { return system_.bytes(); }

 private:
  using Matrix = Eigen::Ref<const Eigen::MatrixXd>;
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  /// State of a place, by the augmented force z - rho w.
  struct Status {
    enum { kOpen, kSticks, kSlips } is = kOpen;
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();  // of beta, where it slips
    double fraction = 0;  // kappa = mu p / |beta - rho w_t|, [0, 1), where it slips
  };
  /// Returns the force that presses on a place beyond its shares, N.
  double more_pressure(int place) const {
    return moves_ ? slack_[row_of(static_cast<int>(friction_.mu.size())) + place] : 0;
  }
  /// First row of a place.
  Eigen::Index row_of(int place) const { return contacts_ + 2 * place; }
  void start(const Matrix& g_matrix, const FrictionPlaces& friction) noexcept;
  void compute_slack(const Matrix& g_matrix, const Vector& g, const Vector& z) noexcept;
  template <class Force>
  void press(const Force& force) noexcept;
  void put_into_cones(Eigen::Ref<Eigen::VectorXd> z) noexcept;
  double residual(const Vector& g, const Vector& z) noexcept;
  void classify(const Vector& z, const Vector& w) noexcept;
  void classify_by_force(const Vector& z, const Vector& w) noexcept;
  void classify_places(const Vector& z, const Vector& w) noexcept;
  void keep_rows() noexcept;
  void assemble(const Matrix& g_matrix) noexcept;
  template <class Source, class Target>
  bool solve_closed(const Source& constant, Target&& z) noexcept;
  int pivot(const Vector& z, double force_noise, double gap_noise, bool one) noexcept;
  bool solve_unilateral(const Matrix& g_matrix, const Vector& g, Eigen::Ref<Eigen::VectorXd> z) noexcept;
  bool newton(const Matrix& g_matrix, const Vector& g, int steps, double share,
              Eigen::Ref<Eigen::VectorXd> z) noexcept;
  void relax(const Matrix& g_matrix, const Vector& g, int sweeps, Eigen::Ref<Eigen::VectorXd> z) noexcept;

  bool spend(double multiplications) noexcept { return work_ == nullptr || work_->spend(multiplications); }

  WorkBudget* work_ = nullptr;
  FrictionPlaces friction_;  // of the problem in hand
  Eigen::Index contacts_ = 0;
  bool moves_ = false;  // there are rows of pressures
  BoundedMatrix system_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> rhs_;
  Eigen::VectorXd slack_, trial_, direction_, from_, pressure_, rho_;  // rho: of each row, N/m
  std::vector<char> closed_;                                           // of each contact
  std::vector<Status> status_;                                         // of each place
  std::vector<int> kept_, column_;  // the rows of the system, and where in it a row is; -1: it is not
};

}  // namespace palpate
