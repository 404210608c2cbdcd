#pragma once
#include <Eigen/Cholesky>
#include <array>

#include "sim_server/deformation/cuttable_body.h"

namespace palpate::sim {

/// A body of which more is in motion takes over from one of the same mesh of which less is: from then on the
/// tool meets another body that is where the one before was, as fast. Vertices that join what is in motion
/// stood where the forces on them balanced, but for what modes of the rest before did besides: so they do,
/// with the static stiffness S of the vertices that join (their part of the Schur complement of the whole
/// body's stiffness). At rest no force changes; what the condensed rest before swung in modes that the rest
/// now does not have is lost.
class HandOver {
 public:
  /// Both keep the shapes of modes. `places`: of the mesh vertices in the motion of `before`. Of that, reads
  /// what never changes: another thread may step it.
  /// O(j (edges + b^2) + j^3) of j unknowns that join; throws `Error` where S is singular, or where it would
  /// take more memory than is free.
  HandOver(CuttableBody& after, const CuttableBody& before, const std::vector<int>& places);

  /// Puts `after` where `before` is, which bears these loads and is of no use from then on. What was parted
  /// of one by now was parted of the other. O(edges + b^2 + j^2).
  void operator()(CuttableBody& before, std::span<const NodalLoad> loads);

  std::size_t joining() const { return joining_.size(); }  ///< vertices

 private:
  std::vector<double> shared(const CuttableBody& before, const std::vector<double>& of_before) const;
  void balance(std::vector<double>& x, std::span<const NodalLoad> loads);

  CuttableBody& after_;
  struct Joining {
    int vertex;  // of the mesh
    int number;  // first, in the motion of `after`
  };
  std::vector<Joining> joining_;
  Eigen::LLT<Eigen::MatrixXd> stiffness_;  // S
  std::vector<CondensedRest::Overlap> overlaps_;
  std::vector<double> force_;  // scratch, N
};

}  // namespace palpate::sim
