// What a step of `implicit` may cost ([deformation] budget_ms): bounded by counts, told, and made up for
// later.
#include <cmath>

#include "common/error.h"
#include "sim_server/deformation/implicit.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDepth = 0.016;  // m, of test::shallow_block

/// `budget_ms` 0: none.
Scene scene_of(double budget_ms, DynamicsSettings::Solver solver = DynamicsSettings::Solver::kQuasiNewton) {
  Scene scene = test::shallow_block_scene("implicit", ElasticLaw::kCorotational);
  scene.deformation.of<ImplicitSettings>().solver = solver;
  scene.deformation.of<ImplicitSettings>().budget_ms = budget_ms;
  scene.deformation.of<ImplicitSettings>().max_newton = 30;
  return scene;
}

/// Pressed quickly to 4 mm, drawn along by 6 mm, then held still.
ToolForce pressed_and_drawn(Simulation& simulation) {
  ToolForce force;
  for (int i = 0; i < 90; ++i) {
    const double down = std::min(1.0, i / 4.0) * 0.0045, along = std::clamp(i - 10, 0, 10) * 6e-4;
    force = simulation.step({Vec3(0.001 + along, 0.0055 - down, 0.0015)}, 1.0 / 30);
  }
  return force;
}

StepCosts costs_of(const TetMesh& mesh) {
  const Solid solid(mesh, *scene_of(0).material);
  std::vector<int> below;
  for (int v = 0; v < solid.nodes(); ++v) {
    if (solid.rest()[v][1] < 1e-9 - kDepth) below.push_back(v);
  }
  const FreeDofs dofs(solid.nodes(), below);
  return {solid, NewtonMatrix(solid, dofs, {}, "test")};
}

}  // namespace

TEST_CASE("budget of a step: what it costs is told from counts") {
  const StepCosts costs = costs_of(test::shallow_block());
  const double elements = static_cast<double>(test::shallow_block().tetrahedra.size());
  CHECK(costs.evaluation == Approx(80e-6 * elements));  // ns an element, one point each
  CHECK(costs.factor > 0.8e-3 * elements);              // us an element to assemble, and the numbers
  CHECK(costs.columns(0) == 0);
  CHECK(costs.columns(1) > costs.solve);
  CHECK(costs.columns(10) < 10 * costs.columns(1));
  CHECK(costs.least(false) == Approx(costs.least(true) + costs.factor));
}

TEST_CASE("budget of a step: an ample one changes nothing, to the last bit", "[threads]") {
  Simulation without(scene_of(0), test::shallow_block()), ample(scene_of(1e4), test::shallow_block());
  pressed_and_drawn(without);
  pressed_and_drawn(ample);
  CHECK(ample.state_hash() == without.state_hash());
  CHECK(ample.budget_use().steps == 0);
}

TEST_CASE("budget of a step: a small one leaves steps before they have converged, which make it up at rest",
          "[threads]") {
  const StepCosts costs = costs_of(test::shallow_block());
  Simulation without(scene_of(0), test::shallow_block()),
      small(scene_of(1.3 * costs.least(true)), test::shallow_block());
  const ToolForce wanted = pressed_and_drawn(without), felt = pressed_and_drawn(small);
  CHECK(small.budget_use().steps > 3);
  CHECK(small.budget_use().largest_residual > scene_of(0).deformation.of<ImplicitSettings>().tolerance);
  CHECK(wanted.force.norm() > 0.1);
  CHECK((felt.force - wanted.force).norm() < 2e-3 * wanted.force.norm());
  CHECK_FALSE(felt.flagged);
}

namespace {

/// A block held from below, in implicit dynamics.
struct Sheared {
  TetMesh mesh = test::shallow_block();
  Solid solid{mesh, *scene_of(0).material};
  StepCosts costs = costs_of(mesh);
  std::vector<HeldAxes> held = std::vector<HeldAxes>(mesh.vertices.size(), 0);
  std::vector<Vec3> load = std::vector<Vec3>(mesh.vertices.size(), Vec3(0, 0, 8e-3));  // N: it shears far

  Sheared() {
    for (std::size_t v = 0; v < held.size(); ++v) {
      if (mesh.vertices[v][1] < 1e-9 - kDepth) held[v] = kAllAxes;
    }
  }
};

/// Its second step: the first makes a factor for its length.
struct SecondStep {
  Dynamics dynamics;

  SecondStep(const Sheared& body, double budget_ms, DynamicsSettings::Solver solver)
      : dynamics(body.solid, body.held,
                 {.rayleigh_mass = 10, .solver = solver, .refresh_steps = 1000, .budget_ms = budget_ms},
                 "test") {
    dynamics.start_step(1.0 / 30);
    dynamics.iterate(body.load);
    dynamics.finish_step();
    dynamics.start_step(1.0 / 30);
  }
};

}  // namespace

TEST_CASE("budget of a step: no iteration begins that it has no room for") {
  using Solver = DynamicsSettings::Solver;
  const Sheared body;
  for (const Solver solver : {Solver::kQuasiNewton, Solver::kConjugateGradients}) {
    for (const double times : {1.0, 1.5, 3.0, 5.0}) {
      const double budget = times * body.costs.least(true);
      SecondStep step(body, budget, solver);
      Dynamics& dynamics = step.dynamics;
      // Twisted, so that the factor is of elsewhere, and conjugate gradients take many iterations with it.
      for (Vec3& x : dynamics.mutable_position())
        x = Eigen::AngleAxisd(150 * (x[1] + kDepth), Vec3::UnitY()) * x;
      int iterations = 0;
      while (dynamics.affords_iteration() && iterations < 1000) {
        dynamics.iterate(body.load);
        ++iterations;
      }
      CAPTURE(times, budget, body.costs.iteration(), static_cast<int>(solver));
      CHECK(iterations >= 1);
      CHECK(iterations < 1000);
      // But for the first product of conjugate gradients, and a line search that halves its step.
      CHECK(dynamics.spent_ms() <= budget + body.costs.iteration() + 2 * body.costs.evaluation);
    }
  }
}

TEST_CASE("budget of a step: an iteration costs a solve and as many evaluations as it made") {
  const Sheared body;
  SecondStep step(body, 1e3, DynamicsSettings::Solver::kQuasiNewton);
  Dynamics& dynamics = step.dynamics;
  CHECK(dynamics.spent_ms() == Approx(body.costs.evaluation / 2));
  dynamics.iterate(body.load);
  const double evaluations =
      (dynamics.spent_ms() - body.costs.solve) / body.costs.evaluation - 0.5;  // all the rest
  CHECK(evaluations >= 1);
  CHECK(evaluations == Approx(std::round(evaluations)));
  CHECK(std::abs(body.costs.solve / body.costs.evaluation - std::round(evaluations)) > 0.01);
}

TEST_CASE("budget of a step: no factor is made that it has no room for, not even at rest") {
  const Sheared body;
  for (const bool ample : {false, true}) {
    SecondStep step(body, ample ? 1e3 : body.costs.least(false) + 0.5 * body.costs.factor,
                    DynamicsSettings::Solver::kDirect);
    step.dynamics.iterate(body.load);
    const int made = step.dynamics.factors();
    step.dynamics.iterate(body.load);
    step.dynamics.refactor_if_moved();
    CHECK(step.dynamics.factors() > made);  // there is room for one
    const int now = step.dynamics.factors();
    step.dynamics.mutable_position().back() += Vec3(0, 0.004, 0);
    step.dynamics.refactor_if_moved();
    CHECK(step.dynamics.factors() == now + (ample ? 1 : 0));
  }
}

TEST_CASE("budget of a step: the linear law, which takes one iteration, has none to bound") {
  Scene scene = scene_of(1e4, DynamicsSettings::Solver::kDirect);
  scene.material->law = ElasticLaw::kLinear;
  CHECK_THROWS_WITH(Simulation(scene, test::shallow_block()),
                    Catch::Contains("law \"linear\" takes one; leave it out"));
  scene.deformation.of<ImplicitSettings>().budget_ms = 0;
  CHECK_NOTHROW(Simulation(scene, test::shallow_block()));
}

TEST_CASE("budget of a step: one that has no room for the least step is refused, with what would help") {
  const StepCosts costs = costs_of(test::shallow_block());
  const auto refused = [](double budget_ms, DynamicsSettings::Solver solver) {
    try {
      Simulation(scene_of(budget_ms, solver), test::shallow_block());
      return std::string();
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  using Solver = DynamicsSettings::Solver;
  CHECK(refused(1.1 * costs.least(true), Solver::kQuasiNewton).empty());
  CHECK(refused(1.1 * costs.least(false), Solver::kDirect).empty());
  CHECK(refused(0.9 * costs.least(true), Solver::kQuasiNewton).find("budget_ms leaves ") !=
        std::string::npos);
  const std::string direct = refused(1.1 * costs.least(true), Solver::kDirect);
  CHECK(direct.find("solver = \"quasi_newton\"") != std::string::npos);
}
