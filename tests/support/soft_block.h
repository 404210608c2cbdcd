#pragma once
/// Blocks of soft tissue to press on: around x = z = 0, top at y = 0, held at their bottoms.
#include <array>
#include <string_view>
#include <vector>

#include "sim_server/mesh/shapes.h"
#include "tests/support/scenes.h"

namespace palpate::test {

/// So long along x, y and z (m), in so many cells. Lines are whole multiples of the cell, counted from 0:
/// what is symmetric stays so to the last bit.
inline sim::TetMesh soft_block(const Vec3& size, const std::array<int, 3>& cells) {
  const auto lines_of = [&](int axis, int below) {  // so many of the cells lie below 0
    const int n = cells[static_cast<std::size_t>(axis)];
    std::vector<double> at;
    for (int i = -below; i <= n - below; ++i) at.push_back(size[axis] / n * i);
    return at;
  };
  return sim::grid_block(lines_of(0, cells[0] / 2), lines_of(1, cells[1]), lines_of(2, cells[2] / 2));
}

/// Around a block of that depth (m): 10 kPa and a Poisson's ratio of 0.4, under a sphere.
inline sim::Scene soft_block_scene(double depth, std::string_view model = "quasi_static",
                                   sim::ElasticLaw law = sim::ElasticLaw::kLinear,
                                   double tool_radius = 0.005) {
  sim::Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.4, .law = law},
                              {Vec3(-1, -1, -1), Vec3(1, 1e-4 - depth, 1)}, tool_radius);
  scene.deformation.model = model;
  return scene;
}

// Those that several tests use. A scene is that around the block named so, whatever its cells.

/// 30 mm by 12 mm by 30 mm; its scene is under a sphere of 5 mm.
inline sim::TetMesh little_block(const std::array<int, 3>& cells) {
  return soft_block(Vec3(0.03, 0.012, 0.03), cells);
}
inline sim::Scene little_block_scene(std::string_view model = "quasi_static") {
  return soft_block_scene(0.012, model);
}

/// 30 mm by 15 mm by 30 mm, in cells of 5 mm.
inline sim::TetMesh thick_block() {
  return soft_block(Vec3(0.03, 0.015, 0.03), {6, 3, 6});
}
/// Of that Poisson's ratio, under a sphere of that radius (m).
inline sim::Scene thick_block_scene(std::string_view model, sim::ElasticLaw law, double tool_radius,
                                    double poisson_ratio = 0.45) {
  sim::Scene scene = soft_block_scene(0.015, model, law, tool_radius);
  scene.material->poisson_ratio = poisson_ratio;
  return scene;
}

/// 40 mm by 16 mm by 40 mm, in cells of 4 mm unless said otherwise; its scene is under a sphere of 5 mm.
inline sim::TetMesh shallow_block(const std::array<int, 3>& cells = {10, 4, 10}) {
  return soft_block(Vec3(0.04, 0.016, 0.04), cells);
}
inline sim::Scene shallow_block_scene(std::string_view model,
                                      sim::ElasticLaw law = sim::ElasticLaw::kLinear) {
  return soft_block_scene(0.016, model, law);
}

/// 40 mm by 20 mm by 40 mm, in cells of 5 mm unless said otherwise.
inline sim::TetMesh deep_block(const std::array<int, 3>& cells = {8, 4, 8}) {
  return soft_block(Vec3(0.04, 0.02, 0.04), cells);
}
/// Under a sphere of that radius (m).
inline sim::Scene deep_block_scene(std::string_view model, double tool_radius = 0.005) {
  return soft_block_scene(0.02, model, sim::ElasticLaw::kLinear, tool_radius);
}

/// 80 mm by 30 mm by 40 mm, in cells of 5 mm: room for several tools.
inline sim::TetMesh wide_block() {
  return soft_block(Vec3(0.08, 0.03, 0.04), {16, 6, 8});
}
/// Under so many spheres of that radius (m).
inline sim::Scene wide_block_scene(std::size_t tools, double tool_radius,
                                   std::string_view model = "quasi_static") {
  sim::Scene scene = soft_block_scene(0.03, model, sim::ElasticLaw::kLinear, tool_radius);
  scene.tools.resize(tools, scene.tools.front());
  return scene;
}

}  // namespace palpate::test
