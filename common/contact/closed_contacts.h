#pragma once
#include <span>
#include <vector>

#include "common/contact/bounded_matrix.h"
#include "common/contact/work_budget.h"
#include "common/types.h"

namespace palpate {

/// Contacts that stay closed while an elastic body and the tools move a little. With the compliance C of the
/// body and the tools, the changes B of the gaps, the compliance eps of the contacts and the curvature S of
/// the gaps under their forces, all over the same unknowns, a displacement v that forces and gaps ask for
/// becomes
///   v + P S v + ...,  P = C - C B^T (B C B^T + eps)^-1 B C,
/// as the forces turn with the gaps. That is the minimum of an energy, (P^-1 - S) / 2 in what P can do, which
/// conjugate gradients find with P as preconditioner (Gould, Hribar and Nocedal 2001, SIAM J. Sci. Comput.
/// 23:1376): C is only multiplied by, and never eliminated. Where the energy has no minimum, they meet a
/// direction in which it falls. Allocates only in the constructor; one thread.
class ClosedContacts {
 public:
  /// Entry of a row of B: how the gap changes with three unknowns, from this one on.
  struct GapChange {
    int at;
    Vec3 by;
  };

  ClosedContacts() = default;
  /// Room for so many unknowns, contacts, entries of their rows, and blocks of S.
  ClosedContacts(int max_unknowns, int max_contacts, int max_entries, int max_blocks);

  /// Starts on a body of this compliance (n x n, m/N, symmetric), which stays there, with no contact closed
  /// and no curvature; each contact will give way by `give`, m/N. Counts its work in `work`.
  void start(const BoundedMatrix& compliance, double give, WorkBudget& work) noexcept;
  /// Adds a block of S, N/m, from this row and column on.
  void add_curvature(int row, int column, const Mat3& block) noexcept;
  /// Opens all contacts; then closes one more, by its row of B.
  void open_all() noexcept;
  void close(std::span<const GapChange> row) noexcept;
  /// Factorises for the contacts that are closed; before all below. False: it is not positive definite, or
  /// too much work. O(contacts^3 / 6).
  bool factor() noexcept;

  /// Returns the forces in the contacts (N), which close their `gaps` (m) under `loads` (n, N), in their
  /// place.
  void find_forces(Eigen::Ref<Eigen::VectorXd> gaps, const Eigen::Ref<const Eigen::VectorXd>& loads) noexcept;
  /// Returns C B^T of these forces, m, in `moved` (n).
  void press(const Eigen::Ref<const Eigen::VectorXd>& forces,
             Eigen::Ref<Eigen::VectorXd> moved) const noexcept;
  /// Replaces a displacement by what the curvature makes of it, v = v0 + P S v, to `tolerance` of that.
  /// False: the energy has no minimum, or there is not enough work. O(n^2) an iteration, of some ten.
  bool bend(Eigen::Ref<Eigen::VectorXd> v, double tolerance) noexcept;
  /// Writes S v to `loads`.
  void curve(const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> loads) const noexcept;
  /// Returns the change of a gap by a displacement, m.
  static double along(std::span<const GapChange> row, const Eigen::Ref<const Eigen::VectorXd>& v) noexcept;

  std::size_t bytes() const { return pressed_.bytes() + factor_.bytes(); }

 private:
  struct Block {
    int row, column;
    Mat3 value;
  };
  std::span<const GapChange> row(Eigen::Index contact) const noexcept;
  void hold(const Eigen::Ref<const Eigen::VectorXd>& loads, Eigen::Ref<Eigen::VectorXd> moved) noexcept;

  const BoundedMatrix* compliance_ = nullptr;
  double give_ = 0;
  WorkBudget* work_ = nullptr;
  std::vector<GapChange> entries_;
  std::vector<std::size_t> ends_;  // of the rows, in these
  std::vector<Block> blocks_;
  BoundedMatrix pressed_;  // C B^T
  BoundedMatrix factor_;   // of B C B^T + eps
  Eigen::VectorXd held_;   // forces of the contacts
  Eigen::MatrixXd steps_;  // residual, the same by P, direction, that by P^-1, and by the energy's matrix
};

}  // namespace palpate
