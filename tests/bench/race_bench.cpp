// The cases in which Palpate was raced against SOFA v26.06 (facts of the peer: its own fastest choice, one
// thread, 2 cores of AMD Zen 3, one run), on meshes of 6, 30 and 100 thousand tetrahedra in the folder that
// $PALPATE_RACE_MESHES names (peer_liver_S.msh, _M, _L). A body of E = 5 kPa and nu = 0.45 is held where y >=
// 48 mm and pulled by 0.3 N along -y where x >= 88 mm, from rest. `race/explicit`: a sub-step of linear
// tensors, by one thread, and by all cores. `race/implicit`: steps of 20 ms of corotational tissue solved to
// 1e-5 of the forces, by each solver: beside the mean stand the median and the worst step, and how many
// factors were made. `race/swing`: the same body swung by gravity that turns about, its tip by a third of its
// length and more. `race/static`: the linear equilibrium, assembled, factored and solved once. `sofa` and
// `ratio` are of that run, on another machine: a ratio says something only where both are raced anew.
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <optional>

#include "common/clock.h"
#include "sim_server/explicit/explicit_motion.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/solvers/dynamics.h"
#include "tests/bench/bench.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr double kStep = 0.02, kTolerance = 1e-5;  // s; relative residual
constexpr int kSteps = 40;
using Solver = DynamicsSettings::Solver;

/// One of the meshes, and what the peer takes, ms: a step of explicit tensor-mass; of implicit corotational,
/// its mean; the static equilibrium.
struct Racer {
  const char* name;
  double explicit_ms, implicit_ms, static_ms;
};
constexpr std::array kRacers{Racer{"S", 0.150, 42.3, 162}, Racer{"M", 0.799, 275, 5981},
                             Racer{"L", 3.91, 2357, 78500}};

struct Body {
  TetMesh mesh;
  std::vector<HeldAxes> held;
  std::vector<int> fixed, pulled;

  explicit Body(const Racer& racer) {
    const char* const folder = std::getenv("PALPATE_RACE_MESHES");
    if (folder == nullptr)
      fail("left out: $PALPATE_RACE_MESHES names no folder with peer_liver_{}.msh", racer.name);
    mesh = read_mesh(std::filesystem::path(folder) / fmt::format("peer_liver_{}.msh", racer.name));
    held.assign(mesh.vertices.size(), 0);
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
      if (mesh.vertices[v][1] >= 0.048) {
        held[v] = kAllAxes;
        fixed.push_back(v);
      }
      if (mesh.vertices[v][0] >= 0.088) pulled.push_back(v);
    }
  }

  std::vector<Vec3> pull() const {
    std::vector<Vec3> forces(mesh.vertices.size(), Vec3::Zero());
    for (const int v : pulled) forces[v] = Vec3(0, -0.3, 0) / static_cast<double>(pulled.size());
    return forces;
  }
};

Material tissue(ElasticLaw law) {
  return {.young_modulus = 5e3, .poisson_ratio = 0.45, .density = 1060, .law = law};
}

void compare(benchmark::State& state, double ours_ms, double peers_ms) {
  state.counters["sofa"] = peers_ms;
  state.counters["ratio"] = peers_ms / ours_ms;
}

void run_explicit(benchmark::State& state, const Racer& racer, bool all_cores) {
  const Body body(racer);
  const ElasticTensors tensors(body.mesh, tissue(ElasticLaw::kLinear), body.fixed);
  const RayleighDamping damping{0.1, 0};
  const double h = 0.9 * longest_sub_step(highest_frequency(tensors), damping);
  ExplicitMotion motion(tensors, damping, 1, all_cores ? 0 : 1);
  std::vector<double> force = motion.state.f;
  const std::vector<Vec3> pull = body.pull();
  for (std::size_t v = 0; v < pull.size(); ++v) {
    if (tensors.places()[v] >= 0) Eigen::Map<Vec3>(force.data() + 3 * tensors.places()[v]) = pull[v];
  }
  int calls = 0;
  const Time begin = now();
  time_calls(state, 10, [&] {
    ++calls;
    motion.run(1, h, force);
    return motion.state.u[force.size() / 2];
  });
  compare(state, 1e3 * to_seconds(now() - begin) / calls, racer.explicit_ms);
}

/// Forces of a step, by its number.
using Forces = std::function<std::vector<Vec3>(int step)>;

void run_implicit(benchmark::State& state, const Body& body, const DynamicsSettings& settings,
                  const Forces& forces, std::optional<double> peers_ms) {
  const Solid solid(body.mesh, tissue(ElasticLaw::kCorotational));
  Dynamics dynamics(solid, body.held, settings, "race");
  const int before = dynamics.factor().count();
  std::vector<double> ms;
  double moved = 0;
  for (auto _ : state) {
    const std::vector<Vec3> external = forces(static_cast<int>(ms.size()));
    const Time begin = now();
    dynamics.start_step(kStep);
    dynamics.solve(external, 100, kTolerance);
    dynamics.finish_step();
    const double took = to_seconds(now() - begin);
    state.SetIterationTime(took);
    ms.push_back(1e3 * took);
    for (std::size_t v = 0; v < solid.rest().size(); ++v)
      moved = std::max(moved, (dynamics.position()[v] - solid.rest()[v]).norm());
    if (!(dynamics.relative_residual() <= kTolerance)) return state.SkipWithError("a step was not solved");
  }
  Fnv1a hash;
  for (const Vec3& x : dynamics.position()) hash.add(x);
  show(state, hash.value());
  const double mean = std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(ms.size());
  std::ranges::sort(ms);
  state.counters["p50"] = 1e3 * ms[ms.size() / 2];
  state.counters["worst"] = ms.back();
  state.counters["moved"] = 1e3 * moved;
  state.counters["factors"] = dynamics.factor().count() - before;
  if (peers_ms) compare(state, mean, *peers_ms);
}

void pull_once(benchmark::State& state, const Racer& racer, Solver solver) {
  const Body body(racer);
  const std::vector<Vec3> pull = body.pull();
  run_implicit(
      state, body, {.rayleigh_mass = 0.1, .rayleigh_stiffness = 0.1, .solver = solver},
      [&](int) { return pull; }, racer.implicit_ms);
}

void swing(benchmark::State& state, const Racer& racer, Solver solver) {
  constexpr double kGravity = 2, kPeriod = 0.8;  // m/s^2, s: of a liver on too small a hold
  const Body body(racer);
  const std::vector<double> masses = Solid(body.mesh, tissue(ElasticLaw::kLinear)).masses();
  const Forces forces = [&](int step) {
    const double angle = 2 * 3.14159265358979 * step * kStep / kPeriod;
    const Vec3 gravity = kGravity * Vec3(std::sin(angle), 0.3 * std::sin(angle), 1 - std::cos(angle));
    std::vector<Vec3> weight;
    for (const double mass : masses) weight.emplace_back(mass * gravity);
    return weight;
  };
  run_implicit(state, body, {.rayleigh_mass = 1, .rayleigh_stiffness = 0.01, .solver = solver}, forces, {});
}

void run_static(benchmark::State& state, const Racer& racer) {
  const Body body(racer);
  const std::vector<Vec3> pull = body.pull();
  Eigen::VectorXd moved;
  double seconds = 0;
  for (auto _ : state) {
    const Time begin = now();
    const Solid solid(body.mesh, tissue(ElasticLaw::kLinear));
    const FreeDofs dofs(solid.nodes(), body.fixed);
    StiffnessMatrix stiffness = solid.stiffness_matrix(dofs);
    solid.add_stiffness(solid.rest(), stiffness);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(dofs.count);
    for (std::size_t v = 0; v < pull.size(); ++v) {
      if (dofs.first[v] >= 0) load.segment<3>(dofs.first[v]) = pull[v];
    }
    moved = SparseCholesky(stiffness.lower(), "race").solve(load).col(0);
    seconds = to_seconds(now() - begin);
    state.SetIterationTime(seconds);
  }
  Fnv1a hash;
  hash.add(moved.data(), static_cast<std::size_t>(moved.size()) * sizeof(double));
  show(state, hash.value());
  compare(state, 1e3 * seconds, racer.static_ms);
}

}  // namespace

void add_race_rows() {
  constexpr std::array kSolvers{std::pair{"direct", Solver::kDirect},
                                std::pair{"quasi_newton", Solver::kQuasiNewton}};
  for (const Racer& racer : kRacers) {
    const std::string name = racer.name;
    for (const bool all : {false, true}) {
      add("race/explicit/" + name + (all ? "/all_cores" : ""),
          [&racer, all](benchmark::State& state) { run_explicit(state, racer, all); });
    }
    for (const auto& [solver_name, solver] : kSolvers) {
      add("race/implicit/" + name + "/" + solver_name,
          [&racer, solver = solver](benchmark::State& state) { pull_once(state, racer, solver); })
          ->UseManualTime()
          ->Iterations(kSteps);
      add("race/swing/" + name + "/" + solver_name,
          [&racer, solver = solver](benchmark::State& state) { swing(state, racer, solver); })
          ->UseManualTime()
          ->Iterations(kSteps);
    }
    add("race/static/" + name, [&racer](benchmark::State& state) { run_static(state, racer); })
        ->UseManualTime()
        ->Iterations(1);
  }
}

}  // namespace palpate::bench
