// Fields that solve the equations of elasticity, held on the boundary of a body: what the inside makes of
// them, and with which order that converges.
#include <functional>
#include <numbers>

#include "sim_server/solvers/equilibrium.h"
#include "tests/support/catch.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr std::array kLaws{ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff,
                           ElasticLaw::kNeoHookean};
constexpr std::array kElements{ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic};

using Field = std::function<Vec3(const Vec3&)>;
using Where = std::function<bool(const Vec3&)>;

/// The unit cube of n cells a side, distorted inside.
TetMesh cube(int n) {
  return mapped(grid_block(lines(0, 1, n), lines(0, 1, n), lines(0, 1, n)), [](const Vec3& p) {
    const double bump = (std::numbers::pi * p.array()).sin().prod();
    return Vec3(p + 0.08 * bump * Vec3(1, -0.7, 0.5));
  });
}
bool on_cube(const Vec3& x) {
  return x.minCoeff() < 1e-12 || x.maxCoeff() > 1 - 1e-12;
}

/// A body held at the displacements of `exact` where `held` says.
struct Held {
  Solid solid;
  std::vector<HeldAxes> held;
  std::vector<Vec3> x;
  Held(const TetMesh& mesh, const Material& material, const Field& exact, const Where& where)
      : solid(with_nodes(mesh, material.element), material) {
    std::vector<Vec3> start = solid.rest();
    for (Vec3& p : start) {
      held.push_back(where(p) ? kAllAxes : 0);
      if (where(p)) p += exact(p);
    }
    x = find_equilibrium(solid, {.held = held, .start = start}, "test", {},
                         {.tolerance = 1e-14, .rounding = 1e-9})
            .x;
  }
  /// In the free nodes, of the size of the field (both root mean squares).
  double error(const Field& exact) const {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (held[i] != 0) continue;
      sum += (x[i] - solid.rest()[i] - exact(solid.rest()[i])).squaredNorm();
      all += exact(solid.rest()[i]).squaredNorm();
    }
    return std::sqrt(sum / all);
  }
};

}  // namespace

TEST_CASE("exact: patch test: held to one strain around it, the inside comes to it, to 1e-12") {
  const Mat3 strain = (Mat3() << 0.05, 0.03, 0, -0.02, -0.04, 0.05, 0.02, 0, 0.03).finished();
  const Field field = [&](const Vec3& p) { return Vec3(strain * p); };
  for (const ElasticLaw law : kLaws) {
    for (const ElementKind element : kElements) {
      const Held body(cube(3), {7e3, 0.4, 1000, law, element, {}, {}}, field, on_cube);
      CAPTURE(static_cast<int>(law), static_cast<int>(element));
      CHECK(body.error(field) < 1e-12);
    }
  }
}

TEST_CASE("exact: a smooth field converges with the order of the element, two and three") {
  // Neuber 1934: u = (3 - 4 nu) b e_z - z grad b for any harmonic b; here exp(s k x) sin(k y) sin(k z), s^2
  // = 2.
  const double nu = 0.4, k = 1.5, s = std::sqrt(2.0);
  const Field field = [&](const Vec3& p) {
    const double grows = 0.01 * std::exp(s * k * p[0]), sy = std::sin(k * p[1]), sz = std::sin(k * p[2]);
    const Vec3 slope = k * grows * Vec3(s * sy * sz, std::cos(k * p[1]) * sz, sy * std::cos(k * p[2]));
    return Vec3((3 - 4 * nu) * grows * sy * sz * Vec3::UnitZ() - p[2] * slope);
  };
  const auto error = [&](int n, ElementKind element) {
    return Held(cube(n), {7e3, nu, 1000, ElasticLaw::kLinear, element, {}, {}}, field, on_cube).error(field);
  };
  for (const ElementKind element : kElements) {
    const bool quadratic = element == ElementKind::kQuadratic;
    const double coarse = error(4, element), fine = error(8, element), order = std::log2(coarse / fine);
    CAPTURE(static_cast<int>(element), coarse, fine, order);
    CHECK(fine < (quadratic ? 3e-4 : 0.02));
    CHECK(order > (quadratic ? 2.6 : 1.5));
    CHECK(order < (quadratic ? 4.2 : 2.6));
  }
}

TEST_CASE(
    "exact: pure bending: quadratic elements have it all, moment too, linear ones are of second order") {
  // St Venant: u = kappa (x y, -(x^2 + nu (y^2 - z^2)) / 2, -nu y z), moment E I kappa (Timoshenko and
  // Goodier 1970, section 102).
  const double nu = 0.3, e = 1e4, kappa = 0.05, length = 0.4, half = 0.05;
  const Field field = [&](const Vec3& p) {
    return Vec3(kappa * Vec3(p[0] * p[1], -0.5 * (p[0] * p[0] + nu * (p[1] * p[1] - p[2] * p[2])),
                             -nu * p[1] * p[2]));
  };
  const Where ends = [&](const Vec3& p) { return p[0] < 1e-12 || p[0] > length - 1e-12; };
  const auto bent = [&](int n, ElementKind element) {
    return Held(grid_block(lines(0, length, 4 * n), lines(-half, half, n), lines(-half, half, n)),
                {e, nu, 1000, ElasticLaw::kLinear, element, {}, {}}, field, ends);
  };
  const auto moment = [&](const Held& bar) {
    std::vector<Vec3> f(bar.x.size());
    bar.solid.forces(bar.x, f);
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      const Vec3& rest = bar.solid.rest()[i];
      if (rest[0] > length - 1e-12) sum += rest[1] * f[i][0];
    }
    return sum / (e * std::pow(2 * half, 4) / 12 * kappa);
  };
  const Held quadratic = bent(2, ElementKind::kQuadratic);
  CHECK(quadratic.error(field) < 1e-11);
  CHECK(moment(quadratic) == Approx(1).epsilon(1e-10));
  for (const ElementKind element : {ElementKind::kLinear, ElementKind::kNodalPressure}) {
    const Held coarse = bent(4, element), fine = bent(8, element);
    const double order = std::log2(coarse.error(field) / fine.error(field));
    CAPTURE(static_cast<int>(element), order, moment(coarse), moment(fine));
    CHECK(order == Approx(2).margin(0.5));
    CHECK(std::log2((moment(coarse) - 1) / (moment(fine) - 1)) == Approx(2).margin(0.5));
  }
}
