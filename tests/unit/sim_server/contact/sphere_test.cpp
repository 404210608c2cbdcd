// The finite-element contact against closed forms: a rigid sphere pressed without friction on an elastic
// block.
#include <cmath>
#include <numbers>

#include "sim_server/mesh/shapes.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kSphere = 0.01, kContact = 0.002;  // m: sphere and contact radius
constexpr double kThick = 0.06, kHalfWidth = 0.03;  // m: 60 mm thick, 60 mm wide = 30 contact radii
const Material kTissue{10e3, 0.45, 1000};

/// Depth and force at contact radius a on a half-space (Sneddon 1965, Int. J. Eng. Sci. 3:47, eqs. 6.14
/// and 6.15).
double sneddon_depth(double a) {
  return 0.5 * a * std::log((kSphere + a) / (kSphere - a));
}
double sneddon_force(double a) {
  const double e = kTissue.young_modulus / (1 - kTissue.poisson_ratio * kTissue.poisson_ratio);
  return 0.5 * e * ((a * a + kSphere * kSphere) * std::log((kSphere + a) / (kSphere - a)) - 2 * a * kSphere);
}

/// By how much a bonded layer of thickness h is stiffer than the half-space (Dimitriadis et al. 2002,
/// Biophys. J. 82:2798, eq. 12).
double layer_factor(double depth) {
  constexpr double pi = std::numbers::pi;
  const double nu = kTissue.poisson_ratio, chi = std::sqrt(kSphere * depth) / kThick;
  const double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double beta = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  return 1 - 2 * alpha / pi * chi + 4 * alpha * alpha / (pi * pi) * chi * chi -
         8 / std::pow(pi, 3) * (std::pow(alpha, 3) + 4 * pi * pi / 15 * beta) * std::pow(chi, 3) +
         16 * alpha / std::pow(pi, 4) * (std::pow(alpha, 3) + 3 * pi * pi / 5 * beta) * std::pow(chi, 4);
}

/// Relative error of the computed force with `elements` across one contact radius.
double force_error(int elements, ElementKind element = ElementKind::kLinear) {
  const double fine = kContact / elements;
  const std::vector<double> across = graded_axis(kHalfWidth, 1.4 * kContact, fine, 1.4);
  std::vector<double> down;
  for (const double z : graded_axis(kThick, kContact, fine, 1.4)) {
    if (z <= 0) down.push_back(z);
  }
  Material tissue = kTissue;
  tissue.element = element;
  Scene scene = test::scene_of(tissue, {Vec3(-1, -1, -kThick), Vec3(1, 1, -kThick)}, kSphere);
  const double reach = 1.15 * kContact;
  scene.tools[0].reach = Box{Vec3(-reach, -reach, -1e-9), Vec3(reach, reach, 1)};
  Simulation block(scene, grid_block(across, across, down));
  const double depth = sneddon_depth(kContact);
  const ToolForce force = block.step(Vec3(0, 0, kSphere - depth), 1);
  CHECK_FALSE(force.flagged);
  return force.force[2] / (sneddon_force(kContact) * layer_factor(depth)) - 1;
}

}  // namespace

TEST_CASE("Sneddon's force goes over into Hertz' for small contacts") {
  const double a = 1e-5, e = kTissue.young_modulus / (1 - kTissue.poisson_ratio * kTissue.poisson_ratio);
  CHECK(sneddon_force(a) == Approx(4 * e * a * a * a / (3 * kSphere)).epsilon(1e-3));
}

TEST_CASE(
    "sphere on a graded block: within 5 % of Sneddon's force at six elements per contact radius, and "
    "converging") {
  const double coarse = force_error(2), middle = force_error(4), fine = force_error(6);
  CAPTURE(coarse, middle, fine);
  CHECK(std::abs(fine) < 0.05);
  CHECK(middle < 0.6 * coarse);
  CHECK(fine < 0.7 * middle);
}

TEST_CASE(
    "sphere on a graded block of quadratic elements, pressed on corners and mid-edges: within 3 % at two "
    "elements per contact radius") {
  // On corners alone it would be 15 to 18 % too soft, at any number of elements.
  const double coarse = force_error(1, ElementKind::kQuadratic),
               fine = force_error(2, ElementKind::kQuadratic);
  CAPTURE(coarse, fine);
  CHECK(std::abs(coarse) < 0.1);
  CHECK(std::abs(fine) < 0.03);
}

TEST_CASE("sphere on a graded block of averaged dilation: within 4 % at three elements per contact radius") {
  const double coarse = force_error(2, ElementKind::kNodalPressure),
               fine = force_error(3, ElementKind::kNodalPressure);
  CAPTURE(coarse, fine);
  CHECK(std::abs(fine) < 0.04);
  CHECK(std::abs(fine) < 0.5 * std::abs(coarse));
}
