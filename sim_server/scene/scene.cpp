#include "sim_server/scene/scene.h"

#include <fmt/core.h>

#include "common/error.h"
#include "common/log.h"
#include "common/memory_budget.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/mesh_faults.h"
#include "sim_server/mesh/refinement.h"

namespace palpate::sim {
namespace {

/// Bytes a tetrahedron: eight in its place, with their vertices, and, for the surface, four faces of each.
constexpr double kRefiningTakes = 8 * (16 + 4 * 32 + 8);

}  // namespace

TetMesh read_mesh_of(const Scene& scene) {
  TetMesh mesh = read_mesh(scene.mesh_file, scene.mesh_scale);
  if (const std::string odd = odd_size(mesh); !odd.empty()) log::warning("{}: {}", scene.mesh_where, odd);
  for (double remaining = scene.mesh_refinements; remaining > 0; --remaining) {
    require_memory(kRefiningTakes * static_cast<double>(mesh.tetrahedra.size()), free_memory(),
                   scene.mesh_where,
                   fmt::format("cutting {} tetrahedra into smaller ones", mesh.tetrahedra.size()),
                   "take a smaller `refine` or a coarser mesh");
    mesh = remaining < 1 ? halved(mesh) : refined(mesh);
  }
  return mesh;
}

std::vector<int> fixed_vertices(const Scene& scene, const TetMesh& mesh) {
  std::vector<char> is_fixed(mesh.vertices.size(), 0);
  for (const FixedRegion& region : scene.fixed) {
    if (region.axes != kAllAxes) continue;
    for (const int vertex : vertices_in(region, mesh)) is_fixed[vertex] = 1;
  }
  for (std::size_t k = 0; k < mesh.mid_edges.size(); ++k) {
    const auto [a, b] = mesh.mid_edges[k];
    is_fixed[static_cast<std::size_t>(mesh.corners()) + k] = is_fixed[a] & is_fixed[b];
  }
  std::vector<int> fixed;
  for (int v = 0; v < static_cast<int>(is_fixed.size()); ++v) {
    if (is_fixed[v]) fixed.push_back(v);
  }
  if (scene.material && !scene.fixed.empty() && fixed.size() == mesh.vertices.size()) {
    fail(
        "{}: holds all {} vertices of the mesh together with what other [[fixed]] hold: nothing can move; "
        "make it smaller",
        scene.fixed.back().where, fixed.size());
  }
  return fixed;
}

}  // namespace palpate::sim
