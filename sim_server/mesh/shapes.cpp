#include "sim_server/mesh/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::sim {

std::vector<double> graded_axis(double half, double core, double fine, double growth) {
  std::vector<double> positive{0};
  double step = fine;
  while (positive.back() < half) {
    if (positive.back() >= core - 1e-9 * fine) step *= growth;
    positive.push_back(positive.back() + step);
  }
  // Stretch what lies beyond the core so that it ends exactly at `half`.
  const double reached = positive.back();
  for (double& x : positive) {
    if (x > core) x = core + (x - core) * (half - core) / (reached - core);
  }
  positive.back() = half;
  std::vector<double> lines;
  for (auto x = positive.rbegin(); x + 1 != positive.rend(); ++x) lines.push_back(-*x);
  lines.insert(lines.end(), positive.begin(), positive.end());
  return lines;
}

TetMesh grid_block(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z) {
  TetMesh mesh;
  const int nx = static_cast<int>(x.size()), ny = static_cast<int>(y.size()), nz = static_cast<int>(z.size());
  for (const double zk : z) {
    for (const double yj : y) {
      for (const double xi : x) mesh.vertices.emplace_back(xi, yj, zk);
    }
  }
  // Kuhn's subdivision: one tetrahedron per order in which the three axes are walked from corner to corner.
  std::array<int, 3> axes{0, 1, 2};
  const std::array<int, 3> stride{1, nx, nx * ny};
  std::vector<std::array<int, 3>> orders;
  do orders.push_back(axes);
  while (std::next_permutation(axes.begin(), axes.end()));
  for (int k = 0; k + 1 < nz; ++k) {
    for (int j = 0; j + 1 < ny; ++j) {
      for (int i = 0; i + 1 < nx; ++i) {
        for (const auto& order : orders) {
          Tetrahedron t;
          t[0] = i + nx * (j + ny * k);
          for (int c = 0; c < 3; ++c) t[c + 1] = t[c] + stride[order[c]];
          if (six_volumes(mesh, t) < 0) std::swap(t[2], t[3]);
          mesh.tetrahedra.push_back(t);
        }
      }
    }
  }
  return mesh;
}

}  // namespace palpate::sim
