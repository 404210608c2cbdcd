#pragma once
/// Which part of a body a section of a scene speaks of.
#include <optional>
#include <string>
#include <vector>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Axis-aligned box, m, closed.
struct Box {
  Vec3 min, max;
  bool contains(const Vec3& x) const {
    return (x.array() >= min.array()).all() && (x.array() <= max.array()).all();
  }
};

/// Ball, m, closed.
struct Ball {
  Vec3 center;
  double radius;  ///< m, (0, 1e3]
  bool contains(const Vec3& x) const { return (x - center).squaredNorm() <= radius * radius; }
};

/// Mesh vertices by a box, by a surface tag of the mesh, or by a ball: one of them.
struct Region {
  std::optional<Box> box{};
  std::string surface_tag{};
  std::string where{};  ///< "FILE:LINE" of this section
  std::optional<Ball> ball{};

  bool contains(const Vec3& x) const { return box ? box->contains(x) : ball && ball->contains(x); }
};

/// Mesh vertices of a region, of those that are corners. Throws `Error` as `fixed_vertices`.
std::vector<int> vertices_in(const Region& region, const TetMesh& mesh);

}  // namespace palpate::sim
