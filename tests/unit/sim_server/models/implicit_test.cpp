// The implicit model in whole simulations: it comes to rest where statics say, also under contact.
#include "sim_server/models/implicit.h"

#include "common/error.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/carved.h"
#include "tests/support/catch.h"
#include "tests/support/column.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

Scene damped_scene(std::string_view model, ElasticLaw law = ElasticLaw::kLinear, double friction = 0) {
  Scene scene = shallow_block_scene(model, law);
  scene.deformation.of<RayleighDamping>().mass = 20;
  scene.deformation.of<RayleighDamping>().stiffness = 0.01;
  scene.tools[0].shape.friction = friction;
  return scene;
}

/// Presses from above to that depth (m) and waits there.
ToolForce pressed(Simulation& simulation, double depth, double dt = 1.0 / 30) {
  ToolForce force;
  for (int i = 0; i < 120; ++i)
    force = simulation.step({Vec3(0.001, 0.0055 - std::min(1.0, i / 20.0) * (depth + 0.0005), 0.0015)}, dt);
  return force;
}

}  // namespace

TEST_CASE("implicit: a sphere on a linear block is felt as in quasi-statics, with and without friction") {
  for (const double friction : {0.0, 0.3}) {
    Simulation moving(damped_scene("implicit", ElasticLaw::kLinear, friction), shallow_block()),
        resting(damped_scene("quasi_static", ElasticLaw::kLinear, friction), shallow_block());
    const ToolForce a = pressed(moving, 0.003), b = pressed(resting, 0.003);
    CAPTURE(friction);
    CHECK(b.force.norm() > 0.3);
    CHECK((a.force - b.force).norm() <
          (friction > 0 ? 1e-3 : 1e-5) * b.force.norm());  // friction: another path
    CHECK_FALSE(a.flagged);
  }
}

TEST_CASE(
    "implicit: in contact the other laws come to the force that statics give for where the surface is") {
  for (const ElasticLaw law :
       {ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean}) {
    Scene scene = damped_scene("implicit", law);
    scene.deformation.of<ImplicitSettings>().tolerance = 1e-9;
    scene.deformation.of<ImplicitSettings>().max_newton = 30;
    Simulation simulation(scene, shallow_block());
    // Saint Venant and Kirchhoff's collapses under more.
    const ToolForce rendered = pressed(simulation, law == ElasticLaw::kStVenantKirchhoff ? 0.002 : 0.004);
    REQUIRE(rendered.contacts > 0);
    // The same body with its surface held where it is now, but for what moves freely inside: the force that
    // the held surface takes is the tool's.
    const Solid solid(shallow_block(), *scene.material);
    std::vector<HeldAxes> held(solid.rest().size(), 0);
    std::vector<Vec3> moved(held.size(), Vec3::Zero());
    for (std::size_t v = 0; v < simulation.surface().vertices.size(); ++v) {
      const int node = simulation.surface().vertices[v];
      held[node] = kAllAxes;
      moved[node] = simulation.positions()[v] - solid.rest()[node];
    }
    const Equilibrium found = find_equilibrium(solid, {.held = held, .moved = moved}, "test");
    std::vector<Vec3> f(found.x.size());
    solid.forces(found.x, f);
    Vec3 above = Vec3::Zero();
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (solid.rest()[i][1] > -0.0159) above += f[i];
    }
    CAPTURE(static_cast<int>(law), rendered.force.transpose(), above.transpose());
    CHECK((rendered.force + above).norm() < 1e-4 * rendered.force.norm());
  }
}

TEST_CASE("implicit: the force does not depend on how old the factor is") {
  Scene scene = damped_scene("implicit", ElasticLaw::kCorotational);
  scene.deformation.of<ImplicitSettings>().tolerance = 1e-8;
  scene.deformation.of<ImplicitSettings>().max_newton = 60;
  Simulation once(scene, shallow_block()), again(scene, shallow_block());
  // The second has been bent elsewhere before: its factor is another's.
  for (int i = 0; i < 30; ++i) again.step({Vec3(-0.012, 0.001, -0.01)}, 1.0 / 30);
  for (int i = 0; i < 150; ++i) again.step({Vec3(0, 0.03, 0)}, 1.0 / 30);
  const ToolForce a = pressed(once, 0.004), b = pressed(again, 0.004);
  CHECK((a.force - b.force).norm() < 1e-4 * a.force.norm());
}

TEST_CASE("implicit: with a factor of the background the force is that of a factor made when it is needed",
          "[threads]") {
  using Solver = DynamicsSettings::Solver;
  // Pressed and drawn along, then let go; the largest difference of forces, and the largest force, N.
  const auto drawn = [](Scene scene, std::vector<Vec3>& forces) {
    Simulation simulation(scene, shallow_block());
    for (int i = 0; i < 50; ++i) {
      const double down = i < 40 ? std::min(1.0, i / 10.0) * 0.0045 : -0.01,
                   along = std::max(0, i - 10) * 2e-4;
      const ToolForce force = simulation.step({Vec3(0.001 + along, 0.0055 - down, 0.0015)}, 1.0 / 30);
      CHECK_FALSE(force.flagged);
      forces.push_back(force.force);
    }
    return simulation.state_hash();
  };
  for (const ElasticLaw law : {ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    // With friction the way there counts, which looks at the surface at other moments.
    for (const double friction : {0.0, 0.2}) {
      Scene scene = damped_scene("implicit", law, friction);
      const DeformationSettings usual = scene.deformation;
      scene.deformation.of<ImplicitSettings>().tolerance = 1e-9;
      scene.deformation.of<ImplicitSettings>().max_newton = 60;
      std::vector<Vec3> exact;
      drawn(scene, exact);
      double most = 0;
      for (const Vec3& force : exact) most = std::max(most, force.norm());
      REQUIRE(most > 0.4);
      for (const Solver solver : {Solver::kQuasiNewton}) {
        if (friction > 0) scene.deformation = usual;
        scene.deformation.of<ImplicitSettings>().solver = solver;
        scene.deformation.of<ImplicitSettings>().refresh_steps = 4;
        std::vector<Vec3> forces, again;
        const std::uint64_t hash = drawn(scene, forces);
        CHECK(drawn(scene, again) == hash);  // whenever the background is ready
        CHECK(again == forces);
        double off = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) off = std::max(off, (forces[i] - exact[i]).norm());
        CAPTURE(static_cast<int>(law), static_cast<int>(solver), friction, off / most);
        CHECK(off < (friction > 0 ? 0.01 : 1e-4) * most);
      }
    }
  }
}

TEST_CASE("implicit: the tangent is what the force changes by over one step") {
  const Scene scene = damped_scene("implicit");
  Simulation simulation(scene, shallow_block());
  const ToolForce before = pressed(simulation, 0.003);
  const Vec3 place(0.001, 0.0025 - 0.0005, 0.0015);
  for (int axis = 0; axis < 3; ++axis) {
    const double h = 1e-6;
    Vec3 change[2];
    for (const int side : {0, 1}) {
      Simulation other(scene, shallow_block());
      pressed(other, 0.003);
      const Vec3 at = simulation.tool(0).place() + (side == 0 ? -h : h) * Vec3::Unit(axis);
      change[side] = other.step({at}, 1.0 / 30).force;
    }
    CHECK(((change[1] - change[0]) / (2 * h) - before.tangent.col(axis)).norm() <
          1e-3 * before.tangent.norm());
  }
}

TEST_CASE("implicit: under its own weight it begins at rest and stays there") {
  Scene scene = damped_scene("implicit", ElasticLaw::kNeoHookean);
  Load weight{};
  weight.kind = Load::Kind::kGravity;
  weight.vector = Vec3(9.81, 0, 0);
  scene.loads.push_back(weight);
  Simulation simulation(scene, shallow_block());
  const std::vector<Vec3> begin(simulation.positions().begin(), simulation.positions().end());
  double sagged = 0;
  for (std::size_t v = 0; v < begin.size(); ++v)
    sagged =
        std::max(sagged, (begin[v] - simulation.mesh().vertices[simulation.surface().vertices[v]]).norm());
  CHECK(sagged > 1e-4);
  for (int i = 0; i < 30; ++i) simulation.step({Vec3(0, 1, 0)}, 1.0 / 30);
  for (std::size_t v = 0; v < begin.size(); ++v)
    CHECK((simulation.positions()[v] - begin[v]).norm() < 1e-4 * sagged);
}

TEST_CASE("implicit: a body that nothing holds flies off with the momentum that a tool gave it") {
  Scene scene = test::scene_of(
      {.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 1000, .law = ElasticLaw::kCorotational},
      {Vec3(-1, -1, -1), Vec3(1, -0.5, 1)}, 0.006);
  scene.fixed.clear();
  scene.rate_hz = 500;
  scene.deformation.model = "implicit";
  scene.deformation.of<RayleighDamping>().mass = 0;
  scene.deformation.of<RayleighDamping>().stiffness = 2e-3;
  scene.deformation.of<ImplicitSettings>().tolerance = 1e-10;
  scene.deformation.of<ImplicitSettings>().max_newton = 60;
  Simulation simulation(scene, grid_block(test::lines(-0.015, 0.015, 4), test::lines(-0.015, 0, 2),
                                          test::lines(-0.015, 0.015, 4)));
  const auto middle = [&] {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : simulation.positions())
      sum += x / static_cast<double>(simulation.positions().size());
    return sum;
  };
  // Pressed on aside of its middle, the block turns as it goes; let go, it shakes until it is stiff again.
  const double dt = 1 / scene.rate_hz, mass = 1000 * 0.03 * 0.015 * 0.03;
  Vec3 impulse = Vec3::Zero();
  for (int i = 0; i < 40; ++i)
    impulse -= dt * simulation.step(Vec3(0.002, 0.0065 - 1e-4 * i, 0.001), dt).force;
  const std::vector<ToolInput> away(1);
  for (int i = 0; i < 200; ++i) simulation.step(away, dt);
  CHECK(impulse.y() < -1e-4);
  // The middle of all vertices is that of the block, stiff and whole, wherever it has turned.
  const Vec3 from = middle();
  for (int i = 0; i < 100; ++i) simulation.step(away, dt);
  const Vec3 velocity = (middle() - from) / (100 * dt);
  CHECK((mass * velocity - impulse).norm() < 1e-3 * impulse.norm());
}

TEST_CASE("implicit: a body that nothing holds is refused with the linear law, and with a reach") {
  test::TemporaryFolder folder;
  folder.write("column.msh", test::column());
  const auto said = [&](const std::string& law, const std::string& tool) {
    const auto file = folder.write(
        "scene.toml",
        "[mesh]\nfile = \"column.msh\"\n[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.3\nlaw = \"" +
            law + "\"\n[deformation]\nmodel = \"implicit\"\n[[tool]]\n" + tool);
    try {
      read_scene(file);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(said("linear", "").find("take law \"corotational\", by which it flies") != std::string::npos);
  CHECK(said("corotational", "reach = [[0, 0, 0], [1, 1, 1]]")
            .find("scene.toml:10: no [[fixed]] holds the body") != std::string::npos);
  CHECK(said("corotational", "").empty());
}

TEST_CASE("implicit: a body that a displacement alone holds is served in its shape under it") {
  Scene scene = test::scene_of({.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 1000},
                               {Vec3(-1, -1, -1), Vec3(1, -0.5, 1)}, 0.006);
  scene.fixed.clear();
  scene.deformation.model = "implicit";
  const auto held = [](double from, double to, const Vec3& moved) {
    Load load{Load::Kind::kDisplacement};
    load.region.box = Box{Vec3(from, -1, -1), Vec3(to, 1, 1)};
    load.vector = moved;
    return load;
  };
  const Vec3 shift(0, 0.002, 0);
  scene.loads = {held(-0.021, -0.019, shift), held(0.019, 0.021, shift)};
  Simulation simulation(scene, shallow_block());
  for (int i = 0; i < 3; ++i) {
    double most = 0;
    for (std::size_t v = 0; v < simulation.rest().size(); ++v)
      most = std::max(most, (simulation.positions()[v] - simulation.rest()[v] - shift).norm());
    CHECK(most < 1e-9);
    simulation.step(Vec3(0, 0.1, 0), 1 / scene.rate_hz);
  }
}

TEST_CASE("implicit: two blocks that share an edge are refused, with the hinge and where it is") {
  const auto either = [](const Vec3& x) { return (x.x() < 0) == (x.y() < -0.008); };
  const TetMesh crossed = carved(lines(-0.02, 0.02, 4), lines(-0.016, 0, 4), lines(-0.02, 0.02, 2), either);
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kNeoHookean}) {
    CHECK_THROWS_WITH(Simulation(damped_scene("implicit", law), crossed),
                      Catch::Contains("hang on a hinge at 0,-0.008,"));
  }
}
