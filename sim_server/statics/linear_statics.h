#pragma once
#include "sim_server/elasticity/solid.h"
#include "sim_server/solvers/vibration_modes.h"
#include "sim_server/sparse/sparse_cholesky.h"
#include "sim_server/statics/moving_supports.h"
#include "sim_server/statics/surface_compliance.h"

namespace palpate::sim {

/// Throws `Error` where some of the body could still turn or go, with the part and what would hold it.
void require_no_loose_part(const ModelInputs& inputs);

/// The stiffness K of a linear tissue at rest: what its models pre-compute from. Set-up only; the inputs must
/// outlive it.
struct LinearStatics {
  Solid solid;
  FreeDofs dofs;
  StiffnessMatrix stiffness;  ///< K over `dofs`

  /// Tells the progress of `inputs`.
  explicit LinearStatics(const ModelInputs& inputs);
  /// Returns the factor of K, computed at the first call, and once more where the first was not to solve and
  /// this one is. Throws `Error` where K is singular.
  const FactoredMatrix& factor(FactorUse use = FactorUse::kInverseAndSolve) const;
  /// Returns the supports that move, where some [[fixed]] has a motion.
  std::optional<MovingSupports> supports(Following following) const;
  /// Returns the lumped mass of each unknown, kg.
  Eigen::VectorXd masses() const { return masses_of(solid, dofs); }
  /// The `count` lowest modes of vibration over `dofs`, or what the cache of the inputs has of them. Throws
  /// `Error`, beginning with `where`, as `vibration_modes`, and where the build has no Spectra. "What the
  /// inputs have" is the folder of `sim_server condense` where there is one, else the cache.
  VibrationModes modes(int count, const std::string& where) const { return modes(count, where, masses()); }
  /// Returns the modes of a body with these masses of the unknowns, kg > 0.
  VibrationModes modes(int count, const std::string& where, const Eigen::VectorXd& masses) const;
  /// Fills `compliance` with J K^-1 J^T, on all cores, or with what the cache of the inputs has of it.
  void fill(SurfaceCompliance& compliance) const;

 private:
  std::vector<int> rows_of(std::span<const int> vertices) const;

  const ModelInputs& inputs_;
  mutable std::unique_ptr<FactoredMatrix> factor_;
  mutable FactorUse factor_use_ = FactorUse::kInverseAndSolve;
};

}  // namespace palpate::sim
