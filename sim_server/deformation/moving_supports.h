#pragma once
#include <vector>

#include "sim_server/deformation/deformation_models.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/elasticity/sparse_cholesky.h"

namespace palpate::sim {

/// What the prescribed motion of fixed vertices does to a linear tissue. With the displacements split into
/// free ones u and prescribed ones d, K_ff u = -K_fd d (Bathe 1996, section 4.2.2), so each motion of the
/// scene has one column: how the surface stands at its unit displacement. Set-up solves for the columns; a
/// step adds them up, each times its sinusoid. A common translation of all supports moves the surface as one.
class MovingSupports {
 public:
  /// `solid`: of the linear law; `factor`: of its K_ff over `dofs`. Nothing is kept where no [[fixed]] has a
  /// motion. A vertex that lies in several [[fixed]] belongs to the first; a node between two that are fixed
  /// moves by the mean of both.
  MovingSupports(const ModelInputs& inputs, const Solid& solid, const FreeDofs& dofs,
                 const SparseCholesky& factor);

  /// Goes on by `dt` (s) from time 0. No allocation.
  FreeMotion advance(double dt) noexcept;
  /// Where that led the surface, m.
  std::span<const Vec3> positions() const { return positions_; }

  bool any() const { return !columns_.empty(); }
  std::size_t bytes() const;

 private:
  struct Column {
    SupportMotion motion;
    std::vector<Vec3> moved;  // of each surface vertex per unit displacement, no unit
  };
  std::vector<Vec3> rest_, positions_, velocities_;
  std::vector<Column> columns_;
  double time_ = 0;  // s
};

}  // namespace palpate::sim
