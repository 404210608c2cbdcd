// Relaxation through the implicit model in whole simulations, against closed forms. Every stress fades by the
// same function R(t) = 1 - sum g_i (1 - exp(-t / tau_i)), so where the shape of the body is held and inertia
// is negligible, so does every force, under any law: the tissue is in the jaws of a tool, as a sphere's area
// of contact would change.
#include <array>
#include <cmath>

#include "sim_server/models/implicit.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr std::array kCells{6, 3, 6};
const Vec3 kPlace(0.001, 0.005, 0.0005);  // the tool touches the top, y = 0

Scene grasped(std::string_view model, ElasticLaw law, std::vector<Relaxation> relaxations, double rate_hz) {
  Scene scene = scene_of({.young_modulus = 1e4,
                          .poisson_ratio = 0.4,
                          .density = 1e-3,  // no inertia to speak of
                          .law = law,
                          .relaxations = std::move(relaxations)},
                         {Vec3(-1, -1, -1), Vec3(1, -0.0119, 1)}, 0.005);
  scene.deformation.model = model;
  scene.deformation.of<RayleighDamping>().mass = scene.deformation.of<RayleighDamping>().stiffness = 0;
  scene.deformation.of<ImplicitSettings>().tolerance = 1e-10;
  scene.deformation.of<ImplicitSettings>().max_newton = 50;
  scene.tools[0].grasp_place = kPlace;
  scene.rate_hz = rate_hz;
  return scene;
}

const std::vector<Relaxation> kSeries{{0.3, 0.2}, {0.25, 1.5}};

/// R at time t of a strain that came all at once.
double relaxed(double t) {
  double remaining = 1;
  for (const auto& [fraction, time] : kSeries) remaining += fraction * std::expm1(-t / time);
  return remaining;
}
/// The same of a strain that came evenly from t = 0 to h: the mean of R over the times since.
double relaxed_after_ramp(double t, double h) {
  double remaining = 1;
  for (const auto& [fraction, time] : kSeries)
    remaining += fraction * (std::exp(-(t - h) / time) * -std::expm1(-h / time) * time / h - 1);
  return remaining;
}

}  // namespace

TEST_CASE("relaxation: the force of tissue that is grasped and held away fades along its Prony series") {
  const Vec3 away(0.001, 0.002, -0.0005);
  constexpr double kRate = 30;
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff,
                               ElasticLaw::kNeoHookean}) {
    Simulation elastic(grasped("implicit", law, {}, kRate), little_block(kCells));
    Vec3 full = Vec3::Zero();
    for (int i = 0; i < 5; ++i) full = elastic.step(kPlace + away, 1 / kRate).force;
    if (law == ElasticLaw::kLinear) {
      Simulation still(grasped("quasi_static", law, {}, kRate), little_block(kCells));
      CHECK((still.step(kPlace + away, 1 / kRate).force - full).norm() < 1e-6 * full.norm());
    }
    Simulation simulation(grasped("implicit", law, kSeries, kRate), little_block(kCells));
    for (int i = 1; i <= 120; ++i) {
      const Vec3 force = simulation.step(kPlace + away, 1 / kRate).force;
      const double t = i / kRate;
      CAPTURE(static_cast<int>(law), t, force.norm() / full.norm(), relaxed(t));
      REQUIRE((force - relaxed_after_ramp(t, 1 / kRate) * full).norm() < 1e-5 * full.norm());
      // But for how the strain came, half a step before its end, that is the series itself.
      REQUIRE((force - relaxed(t - 0.5 / kRate) * full).norm() < 1e-3 * full.norm());
    }
  }
}

TEST_CASE(
    "relaxation: under loads that are held a linear tissue creeps as its closed form, in second order") {
  // Of one term: u(t) = u_0 (1 - g exp(-(1 - g) t / tau)) / (1 - g), by Laplace's transform of R. A load
  // comes evenly within its first step: as if all at once in the middle of it.
  const double fraction = 0.4, time = 0.3, end = 0.6;
  const TetMesh mesh = little_block(kCells);
  const Surface surface = boundary_surface(mesh);
  const auto moved_by_the_end = [&](std::vector<Relaxation> relaxations, double rate_hz) {
    Scene scene = grasped("implicit", ElasticLaw::kLinear, std::move(relaxations), rate_hz);
    const std::vector<int> fixed = fixed_vertices(scene, mesh);
    Implicit model({scene, mesh, surface, fixed, {}, kSilent});
    const auto top = static_cast<int>(
        std::ranges::find_if(surface.vertices,
                             [&](int v) { return mesh.vertices[v].isApprox(Vec3(0.005, 0, 0)); }) -
        surface.vertices.begin());
    REQUIRE(top < static_cast<int>(surface.vertices.size()));
    Vec3 at = Vec3::Zero();
    for (int i = 0; i < std::lround(end * rate_hz); ++i) {
      model.free_motion(1 / rate_hz);
      at = model.apply(std::vector<VertexLoad>{{top, Vec3(0.01, -0.05, 0)}})[top];
    }
    return Vec3(at - Vec3(0.005, 0, 0));
  };
  const Vec3 at_once = moved_by_the_end({}, 30);
  const auto error = [&](double rate_hz) {
    const double since = end - 0.5 / rate_hz;
    const Vec3 exact = (1 - fraction * std::exp(-(1 - fraction) * since / time)) / (1 - fraction) * at_once;
    return (moved_by_the_end({{fraction, time}}, rate_hz) - exact).norm() / exact.norm();
  };
  const double coarse = error(20), fine = error(40);
  CAPTURE(coarse, fine);
  CHECK(fine < 1e-3);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.4));
}
