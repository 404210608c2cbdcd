#pragma once
#include <memory>
#include <vector>

#include "sim_server/distributed/mpi_ranks.h"
#include "sim_server/sparse/factored_matrix.h"

namespace palpate::sim {

/// Cost of a `MumpsFactor`.
struct MumpsCosts {
  Eigen::Index unknowns = 0, stored = 0;
  double analysis_s = 0, factor_s = 0, schur_s = 0;
  double flops = 0;                  ///< of the factor
  std::vector<RankMemory> memory{};  ///< used by each rank for it
};

/// A Cholesky factor L L^T = A spread over all ranks of MPI, by MUMPS (Amestoy, Duff, L'Excellent and Koster
/// 2001, SIAM J. Matrix Anal. Appl. 23:15). The unknowns of which `inverse_block` is asked are eliminated
/// last: MUMPS leaves their Schur complement S = A_kk - A_ki A_ii^-1 A_ik on rank 0, and the block of A^-1
/// is S^-1, so that nothing is solved for it, and of a factor that need not solve only what the elimination
/// still takes is held: half of the memory. On rank 0, while the others are in `serve_mumps`. The numbers
/// depend on the number of ranks in their last digits, and for more than one on the order in which messages
/// come.
class MumpsFactor final : public FactoredMatrix {
 public:
  /// `solve` needs `use` to be `kInverseAndSolve`. Throws `Error`, beginning with `where`, where A is not
  /// positive definite, or memory ends on some rank: known from the analysis, before it is taken. Memory on
  /// rank 0: A once more with its indices, S, and room for S^-1.
  MumpsFactor(const SparseMatrix& lower, std::span<const int> stored, FactorUse use, const std::string& where,
              const std::function<void(const std::string&)>& report);
  ~MumpsFactor() override;
  MumpsFactor(MumpsFactor&&) = delete;
  MumpsFactor& operator=(MumpsFactor&&) = delete;

  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const override;
  /// `unknowns` must be `stored`.
  void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                     const std::function<void(double)>& progress) const override;

  const MumpsCosts& costs() const { return costs_; }

 private:
  struct Instance;
  void analyse(const SparseMatrix& lower, const std::string& where);
  void factor(const std::string& where);
  void take_all(const SparseMatrix& lower, const std::string& where);
  void take_schur(const std::string& where);
  Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;
  void require(const char* stage, const std::string& where) const;

  std::unique_ptr<Instance> mumps_;
  FactorUse use_;
  std::vector<int> rows_, columns_;  // of the entries of A's lower triangle, counted from 1
  std::vector<double> values_;
  std::vector<int> stored_;  // of S, counted from 1
  Eigen::MatrixXd schur_;    // S, then its Cholesky factor
  MumpsCosts costs_;
};

/// Serves MUMPS on all ranks but 0: they take part in every call of rank 0, until it calls `end_mumps`.
void serve_mumps();
/// Lets the other ranks return from `serve_mumps`. Rank 0.
void end_mumps();

}  // namespace palpate::sim
