#pragma once
/// A block of soft tissue to press on: around x = z = 0, top at y = 0, held at its bottom.
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

}  // namespace palpate::test
