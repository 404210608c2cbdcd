// Steps of corotational tissue in contact: the liver that ships, by a direct solver; blocks too large for
// that, with a factor of the background. Beside the time of a step stands how far its force is from that of
// steps solved to the end.
#include <cmath>

#include "common/clock.h"
#include "sim_server/models/implicit.h"
#include "sim_server/simulation/simulation.h"
#include "tests/bench/bench.h"
#include "tests/bench/liver.h"
#include "tests/support/solids.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr double kPressed = 1.0;  // s until the tool is down; then it slides
using Solver = DynamicsSettings::Solver;

/// A tissue, and a tool that is pressed on it and then drawn along.
struct Case {
  Scene scene;
  TetMesh mesh;
  Vec3 place = Vec3::Zero(), normal = Vec3::UnitY(), along = Vec3::UnitX();  // on the surface
  double depth = 0;                                                          // m

  Vec3 at(double t) const {
    const double down = depth * std::min(1.0, t / kPressed), slid = 0.01 * std::max(0.0, t - kPressed);
    return place + (scene.tools[0].shape.radius + 0.001 - down) * normal + slid * along;
  }
};

Scene corotational(Scene scene, double rate_hz) {
  scene.rate_hz = rate_hz;
  scene.deformation.model = "implicit";
  scene.material->law = ElasticLaw::kCorotational;
  return scene;
}

Case liver_case() {
  Case made{.scene = corotational(test::liver_scene(), 100), .mesh = {}, .depth = 0.006};
  Simulation simulation(made.scene);
  const Press press = find_press(made.scene, simulation);
  made.mesh = simulation.mesh();
  made.normal = press.normal;
  made.place = press.place - made.scene.tools[0].shape.radius * press.normal;
  made.along = press.normal.unitOrthogonal();
  return made;
}

/// 60 x 27 x 60 mm, held below; its top, of `n` x `n` cells, under a sphere of 8 mm.
Case block_case(int n, double rate_hz, int refresh_steps, Solver solver = Solver::kQuasiNewton) {
  Scene scene = test::scene_of({.young_modulus = 5e3, .poisson_ratio = 0.45, .density = 1060},
                               {Vec3(-1, -1, -1), Vec3(1, -0.0269, 1)}, 0.008);
  scene.deformation.of<sim::ImplicitSettings>().solver = solver;
  scene.deformation.of<sim::ImplicitSettings>().refresh_steps = refresh_steps;
  scene.deformation.of<sim::ImplicitSettings>().tolerance = 1e-2;
  const int high = static_cast<int>(std::lround(0.45 * n));
  return {.scene = corotational(scene, rate_hz),
          .mesh = grid_block(test::lines(-0.03, 0.03, n), test::lines(-0.027, 0, high),
                             test::lines(-0.03, 0.03, n)),
          .place = Vec3(-0.005, 0, 0.001),
          .depth = 0.004};
}

struct Run {
  std::vector<Vec3> forces;
  double contacts = 0;  // mean
};

Run rendered(const Case& on, const Scene& scene, int steps) {
  Simulation simulation(scene, on.mesh);
  Run run;
  for (int i = 0; i < steps; ++i) {
    const ToolForce force = simulation.step(on.at(i / scene.rate_hz), 1 / scene.rate_hz);
    run.forces.push_back(force.force);
    run.contacts += static_cast<double>(force.contacts) / steps;
  }
  return run;
}

/// Of the largest force, %.
double largest_error(const Case& on, const Run& run) {
  Scene exact = on.scene;
  exact.deformation.of<sim::ImplicitSettings>().solver = Solver::kDirect;
  exact.deformation.of<sim::ImplicitSettings>().tolerance = 1e-8;
  exact.deformation.of<sim::ImplicitSettings>().max_newton = 60;
  const Run truth = rendered(on, exact, static_cast<int>(run.forces.size()));
  double error = 0, most = 0;
  for (std::size_t i = 0; i < run.forces.size(); ++i) {
    error = std::max(error, (run.forces[i] - truth.forces[i]).norm());
    most = std::max(most, truth.forces[i].norm());
  }
  return 100 * error / most;
}

void add_case(const std::string& name, Case (*make)()) {
  add("implicit/" + name,
      [make, hash = Fnv1a{}, error = 0.0, contacts = 0.0](benchmark::State& state) mutable {
        const Case on = make();
        const int pressed = static_cast<int>(kPressed * on.scene.rate_hz);
        if (contacts == 0) {
          const Run run = rendered(on, on.scene, 2 * pressed);
          contacts = run.contacts;
          for (const Vec3& force : run.forces) hash.add(force);
          error = largest_error(on, run);
        }
        show(state, hash.value());
        state.counters["error"] = error;
        state.counters["touching"] = contacts;
        Simulation simulation(on.scene, on.mesh);
        int i = 0;
        while (i < pressed) simulation.step(on.at(i++ / on.scene.rate_hz), 1 / on.scene.rate_hz);
        for (auto _ : state) {
          const Time begin = now();
          ToolForce force = simulation.step(on.at(i++ / on.scene.rate_hz), 1 / on.scene.rate_hz);
          benchmark::DoNotOptimize(force);
          state.SetIterationTime(to_seconds(now() - begin));
        }
      })
      ->UseManualTime()
      ->Iterations(30);
}

/// Setting up a large scene, without reading its mesh.
void add_set_up(const std::string& name, Case (*make)()) {
  add("setup/" + name,
      [make, hash = std::uint64_t{0}](benchmark::State& state) mutable {
        const Case on = make();
        for (auto _ : state) {
          const Time begin = now();
          const Simulation simulation(on.scene, on.mesh);
          state.SetIterationTime(to_seconds(now() - begin));
          hash = simulation.state_hash();
        }
        show(state, hash);
      })
      ->UseManualTime()
      ->Iterations(1);
}

}  // namespace

void add_implicit_rows() {
  add_case("liver_6k/direct", &liver_case);
  add_case("block_22k/quasi_newton", [] { return block_case(20, 30, 16); });
  add_case("block_98k/quasi_newton", [] { return block_case(33, 10, 64); });
  add_set_up("block_98k", [] { return block_case(33, 10, 64); });
}

}  // namespace palpate::bench
