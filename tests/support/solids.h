#pragma once
/// Meshes of shapes that have closed forms.
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "sim_server/mesh/shapes.h"
#include "sim_server/solvers/equilibrium.h"

namespace palpate::test {

/// n + 1 lines from `from` to `to`.
inline std::vector<double> lines(double from, double to, int n) {
  std::vector<double> at;
  for (int i = 0; i <= n; ++i) at.push_back(from + (to - from) * i / n);
  return at;
}

/// count + 1 lines, the first at `from`, `step` from each to the next. To the last bit they may be others
/// than those of `lines`.
inline std::vector<double> lines_by(double from, double step, int count) {
  std::vector<double> at;
  for (int i = 0; i <= count; ++i) at.push_back(from + i * step);
  return at;
}

/// A block from the origin to `size` (m), in so many cells along x, y and z.
inline sim::TetMesh corner_block(const Vec3& size, const std::array<int, 3>& cells) {
  return sim::grid_block(lines(0, size[0], cells[0]), lines(0, size[1], cells[1]),
                         lines(0, size[2], cells[2]));
}

/// The vertices moved by a map that keeps tetrahedra the right way round.
inline sim::TetMesh mapped(sim::TetMesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& x : mesh.vertices) x = map(x);
  return mesh;
}

/// Prisms on each other along z, three tetrahedra each: no vertex inside, and no edge. The corners of the
/// first go round against the clock.
inline sim::TetMesh triangular_bar(const std::array<Vec3, 3>& corners, double height, int layers) {
  sim::TetMesh mesh;
  for (int l = 0; l <= layers; ++l) {
    for (const Vec3& corner : corners) mesh.vertices.push_back(corner + height * l / layers * Vec3::UnitZ());
  }
  for (int a = 0; a < 3 * layers; a += 3)
    mesh.tetrahedra.insert(mesh.tetrahedra.end(),
                           {{a, a + 1, a + 2, a + 5}, {a, a + 4, a + 1, a + 5}, {a, a + 3, a + 4, a + 5}});
  return mesh;
}

/// Of the square of half side s to the disc of radius s, lines max(|x|, |z|) = r to circles (Shirley and Chiu
/// 1997).
inline Vec3 square_to_disc(const Vec3& p) {
  const double a = p[0], b = p[2];
  if (a == 0 && b == 0) return p;
  const bool wide = std::abs(a) >= std::abs(b);
  const double r = wide ? a : b, angle = std::atan(1.0) * (wide ? b / a : a / b);
  return wide ? Vec3(r * std::cos(angle), p[1], r * std::sin(angle))
              : Vec3(r * std::sin(angle), p[1], r * std::cos(angle));
}

/// A hollow sphere: an icosahedron divided `level` times, its triangles as prisms in `layers` shells from
/// radius a to b, three tetrahedra each.
inline sim::TetMesh hollow_sphere(double a, double b, int level, int layers) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<int, 3>> faces{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                        {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                        {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                        {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3& p : points) p.normalize();
  for (int round = 0; round < level; ++round) {
    std::map<std::array<int, 2>, int> middle;
    const auto between = [&](int i, int j) {
      const auto [found, fresh] =
          middle.try_emplace({std::min(i, j), std::max(i, j)}, static_cast<int>(points.size()));
      if (fresh) points.push_back((points[i] + points[j]).normalized());
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [i, j, k] : faces) {
      const int ij = between(i, j), jk = between(j, k), ki = between(k, i);
      finer.insert(finer.end(), {{i, ij, ki}, {ij, j, jk}, {ki, jk, k}, {ij, jk, ki}});
    }
    faces = std::move(finer);
  }
  sim::TetMesh mesh;
  const int n = static_cast<int>(points.size());
  for (int l = 0; l <= layers; ++l) {
    for (const Vec3& p : points) mesh.vertices.push_back((a + (b - a) * l / layers) * p);
  }
  for (int l = 0; l < layers; ++l) {
    for (std::array<int, 3> f : faces) {
      std::ranges::sort(f);  // so that neighbours cut their common face the same way
      const std::array<std::array<int, 4>, 3> cut{
          {{f[0] + l * n, f[1] + l * n, f[2] + l * n, f[2] + (l + 1) * n},
           {f[0] + l * n, f[1] + l * n, f[1] + (l + 1) * n, f[2] + (l + 1) * n},
           {f[0] + l * n, f[0] + (l + 1) * n, f[1] + (l + 1) * n, f[2] + (l + 1) * n}}};
      for (std::array<int, 4> t : cut) {
        if (sim::six_volumes(mesh, t) < 0) std::swap(t[0], t[1]);
        mesh.tetrahedra.push_back(t);
      }
    }
  }
  return mesh;
}

}  // namespace palpate::test
