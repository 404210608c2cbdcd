#pragma once
#include <span>
#include <vector>

#include "sim_server/mesh/surface.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Triangles of the surface that each tool can touch: those whose box meets its `reach`.
std::vector<std::vector<Triangle>> touchable_by(std::span<const ToolSettings> tools, const Surface& surface,
                                                const TetMesh& mesh);

/// Their corners, of all lists, ascending: surface vertices.
std::vector<int> vertices_of(const std::vector<std::vector<Triangle>>& lists);

/// Surface vertices that any of the tools can touch, ascending.
std::vector<int> reachable_vertices(const Surface& surface, const TetMesh& mesh,
                                    std::span<const ToolSettings> tools);

}  // namespace palpate::sim
