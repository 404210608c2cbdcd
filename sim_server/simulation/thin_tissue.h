#pragma once
#include <vector>

#include "sim_server/mesh/surface.h"
#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// Tissue that bends under a tool, of elements too long to do so: linear ones bend too stiffly, by one to
/// three times the square of an edge over the thickness (clamped sheets and beams, by plate and beam theory),
/// however many layers of them there are. A table of elements to a radius of the tool knows nothing of that.
/// One thread.
class ThinTissue {
 public:
  /// Thickness, in longest edges of its surface, below which tissue is thin; and of a bar, which bends more.
  static constexpr double kEdges = 2.5, kEdgesOfBar = 3.5;

  /// `held`: vertices of `mesh` that do not move: tissue that rests on them does not bend.
  /// O(tetrahedra + surface), with all vertices within `kEdgesOfBar` edges of each of the surface.
  ThinTissue(const TetMesh& mesh, const Surface& surface, const std::vector<int>& held);

  /// True if at least half of what a tool loads the surface with presses such tissue through its thickness.
  /// O(loads); does not allocate.
  bool bears(std::span<const VertexLoad> loads) const noexcept;
  std::size_t bytes() const noexcept;

 private:
  /// Normals at rest, by vertices of the surface, of the faces there whose other side is so near.
  std::vector<std::vector<Vec3>> thin_;
};

}  // namespace palpate::sim
