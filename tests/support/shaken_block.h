#pragma once
/// A block of soft tissue as `soft_block`, 40 mm by 20 mm by 40 mm, without planes in which vertices lie.
#include <random>

#include "tests/support/soft_block.h"

namespace palpate::test {

/// A block whose inner vertices lie anywhere within a fifth of a cell of their places.
inline sim::TetMesh shaken_block(const std::array<int, 3>& cells) {
  const double depth = 0.02;  // m
  sim::TetMesh mesh = soft_block(Vec3(0.04, depth, 0.04), cells);
  std::minstd_rand random(11);
  const auto outside = [](double x, double low, double high) { return x < low + 1e-9 || x > high - 1e-9; };
  for (Vec3& x : mesh.vertices) {
    Vec3 shift;
    for (double& value : shift)
      value = 0.2 * 0.04 / cells[0] * (2 * static_cast<double>(random()) / std::minstd_rand::max() - 1);
    if (!outside(x.x(), -0.02, 0.02) && !outside(x.y(), -depth, 0) && !outside(x.z(), -0.02, 0.02))
      x += shift;
  }
  return mesh;
}

}  // namespace palpate::test
