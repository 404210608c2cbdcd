#pragma once
#include <vector>

#include "sim_server/mesh/surface.h"
#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// Tissue that bends under a tool, of too few elements to do so: linear ones bend too stiffly by several
/// hundred percent where one layer of them is all there is (a clamped sheet, by plate theory 442 %), which a
/// table of elements to a radius of the tool knows nothing of. One thread.
class ThinTissue {
 public:
  static constexpr int kLayers = 3;  ///< of elements, fewer than which are too few

  /// `held`: vertices of `mesh` that do not move: tissue that rests on them does not bend.
  /// O(tetrahedra + surface), with all vertices within two edges of each of the surface.
  ThinTissue(const TetMesh& mesh, const Surface& surface, const std::vector<int>& held);

  /// True if some face at this vertex of the surface is of such tissue.
  bool is_thin_at(int vertex) const noexcept { return !thin_[static_cast<std::size_t>(vertex)].empty(); }
  /// True if at least half of what a tool loads the surface with presses such tissue through its thickness.
  /// O(loads); does not allocate.
  bool bears(std::span<const VertexLoad> loads) const noexcept;

 private:
  /// Normals at rest, by vertices of the surface, of the faces there whose other side is so near.
  std::vector<std::vector<Vec3>> thin_;
};

}  // namespace palpate::sim
