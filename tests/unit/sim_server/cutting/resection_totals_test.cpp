#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "sim_server/cutting/resection.h"
#include "sim_server/elasticity/tensors.h"
#include "tests/support/catch.h"
#include "tests/support/cut_bodies.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 1.0 / 30;  // s
constexpr double kDepth = 0.02;     // m

/// Of what two sets of tensors make of the same displacements, at random.
double relative_difference(const ElasticTensors& a, const ElasticTensors& b) {
  std::minstd_rand random(7);
  Eigen::VectorXd x(static_cast<Eigen::Index>(3 * a.masses().size())), of_a(x.size()), of_b(x.size());
  for (double& value : x) value = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
  a.multiply(x.data(), of_a.data());
  b.multiply(x.data(), of_b.data());
  return (of_a - of_b).norm() / of_b.norm();
}

}  // namespace

TEST_CASE("tensors after removals have the bits of a fresh assembly of what is left") {
  const TetMesh mesh = deep_block();
  const Material material{.young_modulus = 1e4, .poisson_ratio = 0.4};
  std::vector<int> fixed;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (mesh.vertices[v].y() < 1e-4 - kDepth) fixed.push_back(v);
  }
  ElasticTensors tensors(mesh, material, fixed);
  Surface surface = boundary_surface(mesh);
  CutMesh cut(mesh, std::vector<char>(mesh.tetrahedra.size(), 1), surface);
  std::minstd_rand random(3);
  std::vector<int> order(mesh.tetrahedra.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::shuffle(order, random);
  for (std::size_t at = 0; at + 40 < order.size(); at += 40) {
    const std::span<const int> removed = std::span(order).subspan(at, 40);
    cut.remove(removed, surface);
    tensors.remove(removed, cut, material);
  }
  CHECK(cut.count() <= 40);
  const ElasticTensors fresh(rest_of(mesh, cut), material, fixed);
  REQUIRE(fresh.places() == tensors.places());
  std::vector<double> x(3 * tensors.masses().size()), y(x.size()), z(x.size());
  for (double& value : x) value = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
  tensors.multiply(x.data(), y.data());
  fresh.multiply(x.data(), z.data());
  CHECK(y == z);
  for (std::size_t v = 0; v < fresh.masses().size(); ++v) {
    if (fresh.masses()[v] > 0) CHECK(tensors.masses()[v] == fresh.masses()[v]);
    CHECK(tensors.masses()[v] > 0);
  }
}

TEST_CASE("volume, area and distances of what is gone are those of the cells that it filled") {
  TetMesh mesh = deep_block();  // cells of 5 mm
  Surface surface = boundary_surface(mesh);
  Cutting cutting{.smallest_piece = 0, .where = "test"};
  cutting.plan = CutPlan{.point = Vec3(0.01, 0, 0), .normal = Vec3::UnitX()};
  Resection resection(cutting, mesh, {}, surface, false);
  const auto remove_cell_at = [&](const Vec3& middle) {
    std::vector<int> inside;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
      const Vec3 centre = centre_of(mesh, mesh.tetrahedra[static_cast<std::size_t>(t)]);
      if ((centre - middle).cwiseAbs().maxCoeff() < 0.0025) inside.push_back(t);
    }
    resection.remove(inside, surface);
  };
  const ResectionTotals& totals = resection.totals();
  remove_cell_at(Vec3(0.0025, -0.0025, 0.0025));  // of the top: five of its sides are cut
  CHECK(totals.volume == Approx(125e-9));
  CHECK(totals.cut_area == Approx(5 * 25e-6));
  CHECK(totals.mean_distance() == Approx(0.0075));
  CHECK(totals.furthest > 0.0075);
  CHECK(totals.furthest < 0.01);
  remove_cell_at(Vec3(-0.0025, -0.0025, 0.0025));  // next to it: their common side is gone
  CHECK(totals.volume == Approx(250e-9));
  CHECK(totals.cut_area == Approx(8 * 25e-6));
  CHECK(totals.mean_distance() == Approx(0.01));
}

TEST_CASE("a tip that goes far in a step heats along its way, and by no more than its power") {
  TetMesh mesh = deep_block();
  Surface surface = boundary_surface(mesh);
  std::vector<Vec3> positions;
  const Cutting cutting{.power = 1000, .energy = 1e6, .spot = 1e-3, .where = "test"};
  Resection resection(cutting, mesh, {}, surface, false);
  for (const int v : surface.vertices) positions.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  const HotTip tip{Vec3(-0.02, 0.002, 0.001), Vec3(0.02, 0.002, 0.001), 0.002};
  double least = 1, most = -1;
  std::set<int> columns;  // of 5 mm, in which something went
  for (const int t : resection.advance({&tip, 1}, positions, kStep, surface)) {
    double middle = 0;
    for (const int v : mesh.tetrahedra[static_cast<std::size_t>(t)])
      middle += mesh.vertices[static_cast<std::size_t>(v)].x() / 4;
    columns.insert(static_cast<int>(std::floor(middle / 0.005)));
    for (const int v : mesh.tetrahedra[static_cast<std::size_t>(t)]) {
      least = std::min(least, mesh.vertices[static_cast<std::size_t>(v)].x());
      most = std::max(most, mesh.vertices[static_cast<std::size_t>(v)].x());
    }
  }
  CHECK(least == Approx(-0.02));
  CHECK(most == Approx(0.02));
  CHECK(columns.size() == 8);  // not at its ends alone
  CHECK(resection.totals().heat == Approx(1000 * kStep));
}

TEST_CASE("how long a tip was at the end of what can be cut is counted") {
  TetMesh mesh = deep_block();
  Surface surface = boundary_surface(mesh);
  Cutting cutting{.power = 1e-3, .spot = 1e-3, .where = "test"};
  cutting.plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.01};
  Resection resection(cutting, mesh, {}, surface, false);
  std::vector<Vec3> positions;
  for (const int v : surface.vertices) positions.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  const auto heat_at = [&](double x, int steps) {
    const HotTip tip{Vec3(x, 0.002, 0.001), Vec3(x, 0.002, 0.001), 0.002};
    for (int i = 0; i < steps; ++i) resection.advance({&tip, 1}, positions, kStep, surface);
    return resection.totals().time_at_end;
  };
  CHECK(heat_at(0.001, 5) == 0);
  CHECK(heat_at(0.016, 3) == Approx(3 * kStep));
  CHECK(heat_at(0.001, 5) == Approx(3 * kStep));
  CHECK(resection.totals().hot_time == Approx(13 * kStep));
}

TEST_CASE("ten thousand removals leave a closed surface, tensors as assembled anew, and nothing behind") {
  TetMesh mesh = soft_block(Vec3(0.1, 0.05, 0.1), {16, 8, 16});
  const Material material{.young_modulus = 1e4, .poisson_ratio = 0.4};
  Surface surface = boundary_surface(mesh);
  std::vector<int> held;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (mesh.vertices[static_cast<std::size_t>(v)].y() < -0.049) held.push_back(v);
  }
  ElasticTensors tensors(mesh, material, held);
  Resection resection(Cutting{.smallest_piece = 0, .where = "test"}, mesh, held, surface, false);
  std::size_t bytes = 0;
  std::vector<int> order(mesh.tetrahedra.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::shuffle(order, std::minstd_rand(5));
  REQUIRE(order.size() > 10000);
  for (int k = 0; k < 10000; ++k) {
    if (k == 2000) bytes = resection.bytes();
    const std::span<const int> one(&order[static_cast<std::size_t>(k)], 1);
    tensors.remove(resection.remove(one, surface), resection.remaining(), material);
  }
  CHECK(resection.remaining().count() == mesh.tetrahedra.size() - 10000);
  CHECK(resection.totals().tetrahedra == 10000);
  CHECK(resection.bytes() <= bytes);
  const TetMesh rest = rest_of(mesh, resection.remaining());
  const OuterFaces right = outer_faces(rest);
  CHECK(right.overlaps.empty());
  CHECK(in_order(by_mesh_vertices(surface)) == in_order(right.triangles));
  CHECK(open_edges(right.triangles) == 0);
  CHECK(relative_difference(tensors, ElasticTensors(rest, material, held)) < 1e-9);
}
