#include "sim_server/commands/solve_results.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/core.h>

#include "common/error.h"
#include "common/log.h"
#include "sim_server/mesh/vtu_output.h"

namespace palpate::sim {
namespace {

constexpr double kInside = -1e-9;  // barycentric: on the boundary, but for rounding

Vec3 parse_place(const std::string& text) {
  Vec3 place;
  int used = 0;
  const bool read =
      std::sscanf(text.c_str(), " %lf , %lf , %lf %n", &place[0], &place[1], &place[2], &used) == 3;
  if (!read || static_cast<std::size_t>(used) != text.size() || !place.allFinite())
    fail("--probe \"{}\": three numbers in metres, with commas between them, are a place: 0.1,0.02,0", text);
  return place;
}

/// Shape functions at barycentric coordinates: of four nodes, or of ten.
void weigh(std::span<const int> nodes, const Eigen::Vector4d& l, Probe& probe) {
  probe.nodes.clear();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double weight = nodes.size() == 4 ? l[static_cast<long>(i)]
                          : i < 4           ? l[static_cast<long>(i)] * (2 * l[static_cast<long>(i)] - 1)
                                            : 4 * l[kEdges[i - 4][0]] * l[kEdges[i - 4][1]];
    probe.nodes.emplace_back(nodes[i], weight);
  }
}

double von_mises(const Mat3& stress) {
  const Mat3 deviator = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

/// Sums the forces of nodes along the axes in which they are held, N.
Vec3 held_force(std::span<const Vec3> residual, std::span<const std::pair<int, HeldAxes>> nodes) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [i, axes] : nodes) {
    for (int axis = 0; axis < 3; ++axis) sum[axis] += (axes >> axis & 1) != 0 ? residual[i][axis] : 0.0;
  }
  return sum;
}

void print_forces(const Loads& loads, const std::vector<HeldRegion>& regions, const Outcome& outcome) {
  std::vector<Vec3> residual = outcome.resistance, external(residual.size(), Vec3::Zero());
  loads.add_forces(outcome.x, external);
  std::vector<std::pair<int, HeldAxes>> all;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] -= external[i];
    all.emplace_back(static_cast<int>(i), loads.held()[i]);
  }
  const auto print = [&](const std::string& name, std::span<const std::pair<int, HeldAxes>> nodes) {
    const Vec3 force = held_force(residual, nodes);
    fmt::print("  {:<22} {:.9g} {:.9g} {:.9g} N\n", name, force[0], force[1], force[2]);
  };
  print("force of the supports", all);
  if (regions.size() < 2) return;
  for (const HeldRegion& region : regions) print("  of " + region.name, region.nodes);
}

void warn_of_inverted(const std::string& where, const Solid& solid, std::span<const Vec3> x) {
  std::vector<Solid::State> states(solid.points());
  solid.evaluate(x, states);
  const auto points = static_cast<std::size_t>(solid.points_per_element());
  std::size_t inverted = 0;
  double least = 1;
  for (std::size_t e = 0; e < solid.elements(); ++e) {
    double own = 1;
    for (std::size_t q = 0; q < points; ++q) own = std::min(own, states[e * points + q].F.determinant());
    inverted += own > 0 ? 0 : 1;
    least = std::min(least, own);
  }
  if (inverted > 0)
    log::warning(
        "{}: {} of {} tetrahedra are inside out (volume ratio down to {:.3g}): no tissue does that; a "
        "smaller load, a "
        "finer mesh or another law",
        where, inverted, solid.elements(), least);
}

}  // namespace

Probe find_probe(const std::string& text, const Solid& solid, int corners) {
  Probe probe{text, parse_place(text), {}};
  const auto& x = solid.rest();
  for (std::size_t e = 0; e < solid.elements(); ++e) {
    const std::span<const int> nodes = solid.element(e);
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = x[nodes[static_cast<std::size_t>(k) + 1]] - x[nodes[0]];
    const Vec3 l = edges.inverse() * (probe.place - x[nodes[0]]);
    const Eigen::Vector4d all(1 - l.sum(), l[0], l[1], l[2]);
    if (all.minCoeff() < kInside) continue;
    weigh(nodes, all, probe);
    return probe;
  }
  int nearest = 0;
  for (int v = 1; v < corners; ++v) {
    if ((x[v] - probe.place).norm() < (x[nearest] - probe.place).norm()) nearest = v;
  }
  fail("--probe {}: outside the body at rest, whose nearest vertex is {},{},{}, {:.3g} m off", text,
       x[nearest][0], x[nearest][1], x[nearest][2], (x[nearest] - probe.place).norm());
}

void write_outcome(const std::filesystem::path& file, const Solid& solid, const Outcome& outcome) {
  const std::vector<Vec3>& x = outcome.x;
  std::vector<Solid::State> states(solid.points());
  solid.evaluate(x, states, outcome.viscosity());
  VtuArray moved{"displacement", 3, {}}, stress{"stress", 9, {}}, mises{"von_mises", 1, {}},
      energy{"energy_density", 1, {}}, volume{"volume_ratio", 1, {}};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 u = x[i] - solid.rest()[i];
    moved.values.insert(moved.values.end(), u.data(), u.data() + 3);
  }
  const auto points = static_cast<std::size_t>(solid.points_per_element());
  std::vector<int> cells;
  for (std::size_t e = 0; e < solid.elements(); ++e) {
    const std::span<const int> nodes = solid.element(e);
    cells.insert(cells.end(), nodes.begin(), nodes.end());
    Mat3 cauchy = Mat3::Zero();
    double density = 0, ratio = 0;
    for (std::size_t q = 0; q < points; ++q) {
      const Solid::State& state = states[e * points + q];
      const bool linear = solid.material().law == ElasticLaw::kLinear;
      const double times = solid.stiffness_of(e * points + q);
      cauchy +=
          times * (linear ? state.stress : Mat3(state.stress * state.F.transpose() / state.F.determinant()));
      density += times * state.energy;
      ratio += state.F.determinant();
    }
    cauchy /= static_cast<double>(points);
    for (int i = 0; i < 9; ++i) stress.values.push_back(cauchy(i / 3, i % 3));
    mises.values.push_back(von_mises(cauchy));
    energy.values.push_back(density / static_cast<double>(points));
    volume.values.push_back(ratio / static_cast<double>(points));
  }
  write_vtu(file, x, cells, static_cast<int>(solid.element(0).size()), {moved},
            {stress, mises, energy, volume});
}

std::vector<HeldRegion> held_regions(const Scene& scene, const TetMesh& mesh) {
  std::vector<HeldRegion> regions;
  std::vector<std::array<int, 3>> owner(mesh.vertices.size(), {-1, -1, -1});  // of each axis
  const auto add = [&](const std::string& what, const Region& region, HeldAxes axes) {
    const auto own = static_cast<int>(regions.size());
    for (const int v : vertices_in(region, mesh)) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((axes >> axis & 1) != 0) owner[v][axis] = own;
      }
    }
    regions.push_back({what + " " + region.where, {}});
  };
  for (const FixedRegion& region : scene.fixed) add("[[fixed]]", region, region.axes);
  for (const Load& load : scene.loads) {
    if (load.kind == Load::Kind::kDisplacement) add("[[load]]", load.region, load.axes);
  }
  for (std::size_t k = 0; k < mesh.mid_edges.size(); ++k) {
    const auto [a, b] = mesh.mid_edges[k];
    for (int axis = 0; axis < 3; ++axis)
      owner[static_cast<std::size_t>(mesh.corners()) + k][axis] = std::min(owner[a][axis], owner[b][axis]);
  }
  for (std::size_t i = 0; i < owner.size(); ++i) {
    for (int r = 0; r < static_cast<int>(regions.size()); ++r) {
      int axes = 0;
      for (int axis = 0; axis < 3; ++axis) axes |= owner[i][axis] == r ? 1 << axis : 0;
      if (axes != 0) regions[r].nodes.emplace_back(static_cast<int>(i), static_cast<HeldAxes>(axes));
    }
  }
  return regions;
}

void print_outcome(const std::string& where, const Solid& solid, const Loads& loads,
                   const std::vector<HeldRegion>& regions, const Outcome& outcome,
                   const std::vector<Probe>& probes) {
  const std::vector<Vec3>& x = outcome.x;
  std::size_t furthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if ((x[i] - solid.rest()[i]).norm() > (x[furthest] - solid.rest()[furthest]).norm()) furthest = i;
  }
  const Vec3& from = solid.rest()[furthest];
  fmt::print("  elastic energy         {:.9g} J{}\n", solid.energy(x),
             outcome.memory.empty() ? "" : ", of the law at once: what has relaxed is not taken off");
  print_forces(loads, regions, outcome);
  fmt::print("  largest displacement   {:.9g} m at {:.6g},{:.6g},{:.6g}\n", (x[furthest] - from).norm(),
             from[0], from[1], from[2]);
  warn_of_inverted(where, solid, x);
  for (const Probe& probe : probes) {
    Vec3 u = Vec3::Zero();
    for (const auto& [node, weight] : probe.nodes) u += weight * (x[node] - solid.rest()[node]);
    fmt::print("  probe {}: displacement {:.9g} {:.9g} {:.9g} m\n", probe.text, u[0], u[1], u[2]);
  }
}

}  // namespace palpate::sim
