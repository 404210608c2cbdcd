// What the removal of one tetrahedron takes, on blocks of 3 to 300 thousand: its own updates (surface,
// pieces, tensors), which do not grow with the mesh; and with them those that are made once for all that goes
// in a step (the collision tree over the surface).
#include <algorithm>
#include <numeric>
#include <random>

#include "sim_server/contact/contact_finder.h"
#include "sim_server/cutting/resection.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/mesh/shapes.h"
#include "tests/bench/bench.h"

namespace palpate::bench {
using namespace sim;

namespace {

/// A cube of 0.1 m, held at one side, with a ball in the middle of its top that is removed from outside in.
struct Body {
  explicit Body(int cells) {
    std::vector<double> lines;
    for (int i = 0; i <= cells; ++i) lines.push_back(0.1 * i / cells);
    mesh = grid_block(lines, lines, lines);
    std::vector<int> fixed;
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
      if (mesh.vertices[v][1] == 0) fixed.push_back(v);
    }
    surface = boundary_surface(mesh);
    tensors = std::make_unique<ElasticTensors>(mesh, material, fixed);
    resection = std::make_unique<Resection>(Cutting{.smallest_piece = 0, .where = "bench"}, mesh, fixed,
                                            surface, false);
    for (const int v : surface.vertices) rest.push_back(mesh.vertices[v]);
    order.resize(mesh.tetrahedra.size());
    std::iota(order.begin(), order.end(), 0);
    const auto depth = [this](int t) {
      Vec3 centre = Vec3::Zero();
      for (const int v : mesh.tetrahedra[t]) centre += mesh.vertices[v] / 4;
      return (centre - Vec3(0.05, 0.1, 0.05)).squaredNorm();
    };
    std::ranges::stable_sort(order, [&](int a, int b) { return depth(a) < depth(b); });
  }
  void remove_next() {
    const auto removed = resection->remove({&order[next++], 1}, surface);
    tensors->remove(removed, resection->remaining(), material);
  }

  Material material{.young_modulus = 5e3, .poisson_ratio = 0.45};
  TetMesh mesh;
  Surface surface;
  std::vector<Vec3> rest;
  std::unique_ptr<ElasticTensors> tensors;
  std::unique_ptr<Resection> resection;
  std::vector<int> order;
  std::size_t next = 0;
};

void run(benchmark::State& state, int cells, bool tree) {
  auto body = std::make_unique<Body>(cells);
  for (int i = 0; i < 20; ++i) body->remove_next();
  Fnv1a hash;
  hash.add(body->surface.triangles.data(), body->surface.triangles.size() * sizeof(Triangle));
  show(state, hash.value());
  ContactFinder finder(body->rest, body->surface.triangles, body->surface.triangles, 0.0075);
  for (auto _ : state) {
    if (body->next + 10 > body->order.size() / 2) {
      state.PauseTiming();
      body = std::make_unique<Body>(cells);
      state.ResumeTiming();
    }
    body->remove_next();
    if (tree) finder.change_surface(body->rest, body->surface.triangles, body->surface.triangles);
  }
}

}  // namespace

void add_removal_rows() {
  for (const int cells : {8, 17, 26, 37}) {
    const std::string size = fmt::format("{}k", (6 * cells * cells * cells + 500) / 1000);
    add("removal/" + size, [cells](benchmark::State& state) { run(state, cells, false); });
    add("removal_with_tree/" + size, [cells](benchmark::State& state) { run(state, cells, true); });
  }
}

}  // namespace palpate::bench
