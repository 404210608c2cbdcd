#include "sim_server/scene/loads.h"

#include "sim_server/mesh/shapes.h"
#include "sim_server/mesh/surface.h"
#include "tests/support/catch.h"

namespace palpate::sim {

TEST_CASE("a scene that holds all vertices of its tissue is refused, with the last region that does so") {
  const TetMesh mesh = grid_block({0, 0.5, 1}, {0, 0.1}, {0, 0.5, 1});
  Scene scene;
  scene.material.emplace();
  for (const double to : {0.6, 2.0}) {
    FixedRegion region;
    region.box = {Vec3(-1, -1, -1), Vec3(to, 1, 2)};
    region.where = "scene.toml:" + std::to_string(scene.fixed.size() + 7);
    scene.fixed.push_back(region);
    if (to < 1) CHECK(fixed_vertices(scene, mesh).size() == 12);
  }
  CHECK_THROWS_WITH(fixed_vertices(scene, mesh), Catch::StartsWith("scene.toml:8: holds all 18 vertices") &&
                                                     Catch::Contains("nothing can move"));
  scene.material.reset();  // a wall
  CHECK(fixed_vertices(scene, mesh).size() == 18);
}

TEST_CASE("traction on a tag loads the triangles that are tagged, not all between tagged vertices") {
  // A plate one cell thick: all vertices are tagged, but only the triangles on top and below.
  TetMesh mesh = grid_block({0, 0.5, 1}, {0, 0.1}, {0, 0.5, 1});
  const Surface surface = boundary_surface(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    mesh.surface_tags["skin"].push_back(static_cast<int>(v));
  const auto height = [&](int corner) { return mesh.vertices[surface.vertices[corner]].y(); };
  for (const Triangle& t : surface.triangles) {
    if (height(t[0]) != height(t[1]) || height(t[0]) != height(t[2])) continue;
    mesh.tagged_triangles["skin"].push_back(
        {surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]});
  }
  sort_tags(mesh);
  Scene scene;
  scene.loads.push_back(
      {.kind = Load::Kind::kTraction, .region = {.surface_tag = "skin"}, .vector = {3, -100, 0}});
  for (const ElementKind element : {ElementKind::kLinear, ElementKind::kQuadratic}) {
    const TetMesh nodes = with_nodes(mesh, element);
    const Solid solid(nodes, {.element = element});
    const Loads loads(scene, nodes, boundary_surface(nodes), solid);
    std::vector<Vec3> forces(nodes.vertices.size(), Vec3::Zero());
    loads.add_forces(nodes.vertices, forces);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& force : forces) sum += force;
    CHECK((sum - 2 * Vec3(3, -100, 0)).norm() < 1e-12);  // two faces of 1 m^2
  }
}

}  // namespace palpate::sim
