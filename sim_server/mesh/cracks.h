#pragma once
#include <span>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Outer faces that lie on others.
struct Cracks {
  std::size_t faces = 0;
  double area = 0;            ///< of one side, m^2
  Vec3 place = Vec3::Zero();  ///< on the first of these faces, m
};

/// Finds outer faces (corners index `mesh.vertices`, outward) on whose middle another lies that faces them:
/// within a millionth of an edge, or `same_place` (m) if that is more. There the solid looks whole, and is
/// not: its parts were meshed apart, and their faces do not match. O(n) for n faces of about one size.
Cracks find_cracks(const TetMesh& mesh, std::span<const Triangle> outer_faces, double same_place);

}  // namespace palpate::sim
