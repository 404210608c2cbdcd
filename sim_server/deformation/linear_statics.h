#pragma once
#include "sim_server/deformation/moving_supports.h"
#include "sim_server/deformation/surface_compliance.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/sparse/sparse_cholesky.h"

namespace palpate::sim {

/// Throws `Error` where some of the body could still turn or go, with the part and what would hold it.
void require_no_loose_part(const ModelInputs& inputs);

/// The stiffness K of a linear tissue at rest, factored: what its models pre-compute from.
struct LinearStatics {
  Solid solid;
  FreeDofs dofs;
  SparseCholesky factor;  ///< of K over `dofs`

  /// Tells the progress of `inputs`. Throws `Error` where K is singular.
  explicit LinearStatics(const ModelInputs& inputs);
  /// What moves the surface where some [[fixed]] has a motion.
  std::optional<MovingSupports> supports(const ModelInputs& inputs, Following following) const;
  /// Of each unknown, kg, lumped.
  Eigen::VectorXd masses() const { return masses_of(solid, dofs); }
  /// Fills `compliance` with J K^-1 J^T, on all cores.
  void fill(SurfaceCompliance& compliance, const ModelInputs& inputs) const;
};

}  // namespace palpate::sim
