#pragma once
#include <memory>
#include <vector>

#include "sim_server/distributed/mpi_ranks.h"
#include "sim_server/sparse/factored_matrix.h"

namespace palpate::sim {

/// Cost of a `HyprePcg` so far.
struct PcgCosts {
  Eigen::Index unknowns = 0, entries = 0;  ///< of the matrix
  double setup_s = 0, solve_s = 0;
  int systems = 0;                   ///< right-hand sides solved for
  int iterations = 0;                ///< of all of them
  std::vector<RankMemory> memory{};  ///< of each rank, all that it holds, when it is set up
};

/// A^-1 without a factor: conjugate gradients (Hestenes and Stiefel 1952), preconditioned by one V-cycle of
/// algebraic multigrid, spread by rows over all ranks of MPI. Both by hypre (BoomerAMG: Henson and Yang 2002,
/// Appl. Numer. Math. 41:155). Memory is in proportion to the matrix, where that of a factor is not; each
/// right-hand side is an iteration of its own. On rank 0, while the others are in `serve_hypre`. The numbers
/// depend on the number of ranks in their last digits.
class HyprePcg final : public FactoredMatrix {
 public:
  class Share;
  /// Throws `Error`, beginning with `where`, where memory would end on some rank: told before it is taken.
  HyprePcg(const SparseMatrix& lower, const std::string& where,
           const std::function<void(const std::string&)>& tell);
  ~HyprePcg() override;
  HyprePcg(HyprePcg&&) = delete;
  HyprePcg& operator=(HyprePcg&&) = delete;

  /// Solves to a residual of 1e-11 of each right-hand side. Throws `Error` where that is not reached: the
  /// matrix is not positive definite then.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const override;
  /// Computes the block by one solve for each of `unknowns`; made equal to its transpose.
  void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                     const std::function<void(double)>& progress) const override;

  /// They go on while it solves, and stay when it is gone.
  std::shared_ptr<const PcgCosts> costs() const { return costs_; }

 private:
  void share_out(const SparseMatrix& lower, const std::function<void(const std::string&)>& tell);
  Eigen::VectorXd solve_one(const Eigen::VectorXd& b) const;

  std::unique_ptr<Share> share_;  // of rank 0
  std::string where_;
  Eigen::VectorXi places_;  // of each unknown among the rows of all ranks
  std::shared_ptr<PcgCosts> costs_ = std::make_shared<PcgCosts>();
};

/// Serves hypre on all ranks but 0: they take part in every call of rank 0, until it calls `end_hypre`.
void serve_hypre();
/// Lets the other ranks return from `serve_hypre`. Rank 0.
void end_hypre();

}  // namespace palpate::sim
