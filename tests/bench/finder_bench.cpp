// What of the surface is near a tool, and nearest to it: by the hierarchy, fitted anew each time as the
// surface moves, and by looking at every triangle. On the liver that ships, and on blocks of more and more
// triangles.
#include <cmath>

#include "common/contact/simplex_distance.h"
#include "sim_server/contact/bvh.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/shapes.h"
#include "tests/bench/bench.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr double kReach = 0.006, kDepth = 0.003;  // m
constexpr int kHashed = 10;

/// A surface pressed in at one of its vertices.
struct Skin {
  explicit Skin(const TetMesh& mesh) : triangles(boundary_surface(mesh).triangles) {
    for (const int vertex : boundary_surface(mesh).vertices) rest.push_back(mesh.vertices[vertex]);
    const auto higher = [](const Vec3& a, const Vec3& b) { return a[1] - a.norm() < b[1] - b.norm(); };
    place = *std::ranges::max_element(rest, higher);
    for (const Vec3& x : rest)
      now.push_back(x - kDepth * std::exp(-(x - place).norm() / kReach) * Vec3::UnitY());
    box = {place.array() - kReach, place.array() + kReach};
  }
  bool is_near(const Triangle& t) const {
    const Vec3 &a = now[t[0]], &b = now[t[1]], &c = now[t[2]];
    return (a.cwiseMin(b).cwiseMin(c).array() <= box.max().array()).all() &&
           (a.cwiseMax(b).cwiseMax(c).array() >= box.min().array()).all();
  }
  double squared_distance(const Triangle& t) const {
    const auto w = closest_point(place, now[t[0]], now[t[1]], now[t[2]]).weight;
    return (place - w[0] * now[t[0]] - w[1] * now[t[1]] - w[2] * now[t[2]]).squaredNorm();
  }
  std::vector<Triangle> triangles;
  std::vector<Vec3> rest, now;
  Vec3 place;
  Eigen::AlignedBox3d box;
};

TetMesh block(int cells) {
  std::vector<double> across, down;
  for (int i = 0; i <= cells; ++i) across.push_back(0.06 * i / cells - 0.03);
  for (int i = 0; i <= 4; ++i) down.push_back(0.01 * i - 0.04);
  return grid_block(across, down, across);
}

/// Hashes agree between the two ways.
void add_rows(const std::string& mesh, const Skin& skin) {
  const auto name = [&](std::string_view what, std::string_view how) {
    return fmt::format("surface/{}/{}_{}_triangles/{}", what, mesh, skin.triangles.size(), how);
  };
  add(name("near", "every_triangle"), [skin](benchmark::State& state) {
    time_calls(state, kHashed, [&] {
      long sum = 0;
      for (std::size_t i = 0; i < skin.triangles.size(); ++i)
        sum += skin.is_near(skin.triangles[i]) ? static_cast<long>(i) : 0;
      return sum;
    });
  });
  add(name("near", "hierarchy"),
      [skin, bvh = Bvh(skin.rest, skin.triangles)](benchmark::State& state) mutable {
        time_calls(state, kHashed, [&] {
          long sum = 0;
          bvh.refit(skin.now);
          for (const int i : bvh.near(skin.box)) sum += skin.is_near(skin.triangles[i]) ? i : 0;
          return sum;
        });
      });
  add(name("nearest", "every_triangle"), [skin](benchmark::State& state) {
    time_calls(state, kHashed, [&] {
      std::size_t best = 0;
      double least = skin.squared_distance(skin.triangles[0]);
      for (std::size_t i = 1; i < skin.triangles.size(); ++i) {
        const double distance = skin.squared_distance(skin.triangles[i]);
        if (distance >= least) continue;
        least = distance;
        best = i;
      }
      return static_cast<int>(best);
    });
  });
  add(name("nearest", "hierarchy"),
      [skin, bvh = Bvh(skin.rest, skin.triangles)](benchmark::State& state) mutable {
        time_calls(state, kHashed, [&] {
          bvh.refit(skin.now);
          return bvh.nearest(Eigen::AlignedBox3d(skin.place),
                             [&](int i) { return skin.squared_distance(skin.triangles[i]); });
        });
      });
}

}  // namespace

void add_finder_rows() {
  add_rows("liver", Skin(read_mesh(PALPATE_SOURCE_DIR "/configs/meshes/liver_paper.msh")));
  for (const int cells : {2, 10, 90}) add_rows("block", Skin(block(cells)));
}

}  // namespace palpate::bench
