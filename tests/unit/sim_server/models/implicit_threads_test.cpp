// The implicit model in whole simulations gives the same bytes whatever the number of threads.
#ifdef PALPATE_WITH_TBB
#include <oneapi/tbb/global_control.h>

#include "sim_server/models/implicit.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

/// A block of liver, 50 x 24 x 50 mm, its top at y = 0, under a sphere of 6 mm.
Scene liver_block(DynamicsSettings::Solver solver) {
  Scene scene = scene_of({.law = ElasticLaw::kCorotational}, {Vec3(-1, -1, -1), Vec3(1, -0.0239, 1)}, 0.006);
  scene.deformation.model = "implicit";
  scene.deformation.of<ImplicitSettings>().solver = solver;
  scene.deformation.of<ImplicitSettings>().refresh_steps = 3;
  return scene;
}

struct Run {
  std::vector<Vec3> forces;
  std::vector<std::uint64_t> hashes;  // of the whole surface, after each step
};

/// Pressed by 3 mm, drawn along by 6 mm, let go.
Run palpated(DynamicsSettings::Solver solver, std::size_t threads) {
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  Simulation simulation(liver_block(solver),
                        grid_block(lines(-0.025, 0.025, 10), lines(-0.024, 0, 4), lines(-0.025, 0.025, 10)));
  Run run;
  for (int i = 0; i < 30; ++i) {
    const double down = i < 26 ? std::min(i / 8.0, 1.0) * 0.0035 : -0.01,
                 along = 3e-4 * std::clamp(i - 8, 0, 20);
    run.forces.push_back(simulation.step({Vec3(0.001 + along, 0.0065 - down, 0.0015)}, 1.0 / 30).force);
    run.hashes.push_back(simulation.state_hash());
  }
  return run;
}

}  // namespace

TEST_CASE("implicit: a run in contact has the same bytes with one thread and two, by each solver") {
  using Solver = DynamicsSettings::Solver;
  for (const Solver solver : {Solver::kDirect, Solver::kQuasiNewton}) {
    CAPTURE(static_cast<int>(solver));
    const Run one = palpated(solver, 1), two = palpated(solver, 2);
    CHECK(one.forces[24].norm() > 0.1);
    CHECK(one.forces == two.forces);
    CHECK(one.hashes == two.hashes);
  }
}
#endif
