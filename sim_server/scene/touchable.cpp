#include "sim_server/scene/touchable.h"

#include <algorithm>

#include "sim_server/scene/tool_reach.h"

namespace palpate::sim {
namespace {

/// Triangles of the surface that come near enough to the reach box of the tool to be touched there.
std::vector<Triangle> touchable_triangles(const Surface& surface, const TetMesh& mesh,
                                          const ToolSettings& tool) {
  if (!tool.reach) return surface.triangles;
  std::vector<Triangle> touchable;
  for (const Triangle& t : surface.triangles) {
    const auto corner = [&](int i) -> const Vec3& { return mesh.vertices[surface.vertices[t[i]]]; };
    if (may_touch(*tool.reach, corner(0), corner(1), corner(2))) touchable.push_back(t);
  }
  return touchable;
}

}  // namespace

std::vector<std::vector<Triangle>> touchable_by(std::span<const ToolSettings> tools, const Surface& surface,
                                                const TetMesh& mesh) {
  std::vector<std::vector<Triangle>> lists;
  for (const ToolSettings& tool : tools) lists.push_back(touchable_triangles(surface, mesh, tool));
  return lists;
}

std::vector<int> vertices_of(const std::vector<std::vector<Triangle>>& lists) {
  std::vector<int> vertices;
  for (const auto& triangles : lists) {
    for (const Triangle& t : triangles) vertices.insert(vertices.end(), t.begin(), t.end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::vector<int> reachable_vertices(const Surface& surface, const TetMesh& mesh,
                                    std::span<const ToolSettings> tools) {
  return vertices_of(touchable_by(tools, surface, mesh));
}

}  // namespace palpate::sim
