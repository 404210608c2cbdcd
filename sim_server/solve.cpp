#include "sim_server/solve.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/report.h"
#include "sim_server/elasticity/dynamics.h"
#include "sim_server/elasticity/equilibrium.h"
#include "sim_server/loads.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/vtu_output.h"
#include "sim_server/set_up_memory.h"

namespace palpate::sim {
namespace {

constexpr double kInside = -1e-9;  // barycentric: on the boundary, but for rounding

/// A place in the body at rest and how it follows the nodes.
struct Probe {
  std::string text;
  Vec3 place;
  std::vector<std::pair<int, double>> nodes;
};

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

/// In the tetrahedron that holds the place. Throws `Error` where none does, with the nearest of the corners,
/// which come first.
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

double von_mises(const Mat3& stress) {
  const Mat3 deviator = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

/// The body as it stands, and what it bears: means over each tetrahedron.
void write_state(const std::filesystem::path& file, const Solid& solid, std::span<const Vec3> x) {
  std::vector<Solid::State> states(solid.points());
  solid.evaluate(x, states);
  VtuArray moved{"displacement", 3, {}}, stress{"stress", 9, {}}, mises{"von_mises", 1, {}},
      energy{"energy_density", 1, {}};
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
    double density = 0;
    for (std::size_t q = 0; q < points; ++q) {
      const Solid::State& state = states[e * points + q];
      const bool linear = solid.material().law == ElasticLaw::kLinear;
      cauchy += linear ? state.stress : Mat3(state.stress * state.F.transpose() / state.F.determinant());
      density += state.energy;
    }
    cauchy /= static_cast<double>(points);
    for (int i = 0; i < 9; ++i) stress.values.push_back(cauchy(i / 3, i % 3));
    mises.values.push_back(von_mises(cauchy));
    energy.values.push_back(density / static_cast<double>(points));
  }
  write_vtu(file, x, cells, static_cast<int>(solid.element(0).size()), {moved}, {stress, mises, energy});
}

void print_result(const Solid& solid, const Loads& loads, std::span<const Vec3> x,
                  const std::vector<Probe>& probes) {
  std::vector<Vec3> internal(x.size()), external(x.size(), Vec3::Zero());
  solid.forces(x, internal);
  loads.add_forces(x, external);
  Vec3 held = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      held[axis] += (loads.held()[i] >> axis & 1) != 0 ? internal[i][axis] - external[i][axis] : 0.0;
  }
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if ((x[i] - solid.rest()[i]).norm() > (x[farthest] - solid.rest()[farthest]).norm()) farthest = i;
  }
  const Vec3& from = solid.rest()[farthest];
  fmt::print("  elastic energy         {:.9g} J\n", solid.energy(x));
  fmt::print("  force of the supports  {:.9g} {:.9g} {:.9g} N\n", held[0], held[1], held[2]);
  fmt::print("  largest displacement   {:.9g} m at {:.6g},{:.6g},{:.6g}\n", (x[farthest] - from).norm(),
             from[0], from[1], from[2]);
  for (const Probe& probe : probes) {
    Vec3 u = Vec3::Zero();
    for (const auto& [node, weight] : probe.nodes) u += weight * (x[node] - solid.rest()[node]);
    fmt::print("  probe {}: displacement {:.9g} {:.9g} {:.9g} m\n", probe.text, u[0], u[1], u[2]);
  }
}

/// At rest under all loads.
std::vector<Vec3> find_rest(const Scene& scene, const Solid& solid, const Loads& loads,
                            ProgressLine& progress) {
  const StaticLoad load{[&](std::span<const Vec3> x, std::span<Vec3> f) { loads.add_forces(x, f); },
                        loads.held(), loads.moved()};
  const Time begin = now();
  Equilibrium found =
      find_equilibrium(solid, load, scene.source, [&](double share) { progress("loading", share); });
  progress("loading", 1);
  fmt::print(
      "  static equilibrium     {} Newton steps in {} increments, residual {:.1e} of the forces at work, "
      "{:.3g} "
      "ms\n",
      found.iterations, found.increments, found.residual, 1e3 * to_seconds(now() - begin));
  return std::move(found.x);
}

/// Files of a series: beside it, numbered.
class Series {
 public:
  explicit Series(const SolveOptions& options) : options_(options) {}
  void add(double t, const Solid& solid, std::span<const Vec3> x) {
    const std::filesystem::path name =
        fmt::format("{}_{:04}.vtu", options_.series->stem().string(), frames_.size());
    write_state(options_.series->parent_path() / name, solid, x);
    frames_.emplace_back(t, name);
  }
  void finish() const { write_pvd(*options_.series, frames_); }

 private:
  const SolveOptions& options_;
  std::vector<std::pair<double, std::filesystem::path>> frames_;
};

/// How a motion is stepped: as model "implicit" of the scene says; where it names none, by BDF2, undamped.
struct Stepping {
  DynamicsSettings dynamics{.second_order = true};
  double tolerance = 1e-9;
  explicit Stepping(const DeformationSettings& settings) {
    if (settings.model != "implicit") return;
    dynamics = settings.dynamics();
    tolerance = settings.tolerance;
  }
  const char* name() const { return dynamics.second_order ? "BDF2" : "backward Euler"; }
};

/// One step of `h` to balance, at time `t`. Returns the steps of Newton's method that it took; 0: no balance.
int step_to_balance(Dynamics& dynamics, const Loads& loads, double t, double h, double tolerance,
                    std::vector<Vec3>& external) {
  constexpr int kMostNewton = 50;
  dynamics.start_step(h);
  loads.put_held(t, dynamics.put());
  for (int k = 1; k <= kMostNewton; ++k) {
    std::fill(external.begin(), external.end(), Vec3::Zero());
    loads.add_forces(dynamics.position(), external);
    if (dynamics.improve(external, tolerance) > tolerance) continue;
    dynamics.finish_step();
    return k;
  }
  return 0;
}

/// From rest, with all loads there at once, what is displaced moved at once, and what swings on its way.
std::vector<Vec3> move_for(const SolveOptions& options, const Scene& scene, const Solid& solid,
                           const Loads& loads, ProgressLine& progress) {
  const Stepping stepping(scene.deformation);
  Dynamics dynamics(solid, loads.held(), stepping.dynamics, scene.source);
  const auto steps = static_cast<int>(std::ceil(*options.seconds / options.step - 1e-9));
  const double h = *options.seconds / steps;
  const int every = std::max(1, steps / options.frames);
  Series series(options);
  std::vector<Vec3> external(static_cast<std::size_t>(solid.nodes()));
  std::vector<Time> times;
  int newton = 0;
  if (options.series) series.add(0, solid, dynamics.position());
  for (int step = 1; step <= steps; ++step) {
    const Time begin = now();
    const int looks = step_to_balance(dynamics, loads, step * h, h, stepping.tolerance, external);
    if (looks == 0)
      fail_at_run_time("{}: no convergence at {:g} s; a smaller --step than {:g} s would help", scene.source,
                       step * h, h);
    times.push_back(now() - begin);
    newton += looks;
    progress("moving", static_cast<double>(step) / steps);
    if (options.series && (step % every == 0 || step == steps))
      series.add(step * h, solid, dynamics.position());
  }
  if (options.series) series.finish();
  std::nth_element(times.begin(), times.begin() + steps / 2, times.end());
  fmt::print(
      "  after {:g} s            {} steps of {:g} s ({}, to {:g} of the forces), {} looks, {:.3g} ms a step "
      "(median), kinetic energy {:.9g} J\n",
      *options.seconds, steps, h, stepping.name(), stepping.tolerance, newton,
      1e3 * to_seconds(times[static_cast<std::size_t>(steps / 2)]), dynamics.kinetic_energy());
  return {dynamics.position().begin(), dynamics.position().end()};
}

}  // namespace

int solve(const SolveOptions& options) {
  const Scene scene = read_scene(options.scene, Purpose::kSolve);
  if (!scene.material) fail("{}: solving needs a [material] section", scene.source);
  if (options.series && !options.seconds) fail("--series: needs --seconds, the time that it is a series of");
  check_writable(options.out);
  if (options.series) check_writable(*options.series);
  ProgressLine progress;
  progress("reading the mesh", 0);
  const TetMesh mesh = with_nodes(read_mesh(scene.mesh_file), scene.material->element);
  const Surface surface = boundary_surface(mesh);
  require_memory_for(scene, Purpose::kSolve, count_parts(mesh, surface));
  const Solid solid(mesh, *scene.material);
  const Loads loads(scene, mesh, surface, solid);
  std::vector<Probe> probes;
  for (const std::string& text : options.probes) probes.push_back(find_probe(text, solid, mesh.corners()));
  fmt::print("{}: {} nodes, {} tetrahedra\n", scene.source, solid.nodes(), solid.elements());
  const std::vector<Vec3> x = options.seconds ? move_for(options, scene, solid, loads, progress)
                                              : find_rest(scene, solid, loads, progress);
  write_state(options.out, solid, x);
  print_result(solid, loads, x, probes);
  return 0;
}

}  // namespace palpate::sim
