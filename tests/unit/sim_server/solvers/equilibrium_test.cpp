// Static equilibria against closed forms and published figures, with the order in which they converge.
#include "sim_server/solvers/equilibrium.h"

#include <cmath>
#include <numbers>

#include "common/error.h"
#include "sim_server/scene/loads.h"
#include "tests/support/catch.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

const Box kAll{Vec3::Constant(-1e3), Vec3::Constant(1e3)};

Box box(const Vec3& min, const Vec3& max) {
  return {min - Vec3::Constant(1e-9), max + Vec3::Constant(1e-9)};
}

Load load(Load::Kind kind, const Box& where, const Vec3& vector, double pressure = 0,
          HeldAxes axes = kAllAxes) {
  Load made{};
  made.kind = kind;
  made.region.box = where;
  made.region.where = "test";
  made.vector = vector;
  made.axes = axes;
  made.pressure = pressure;
  return made;
}

/// A body, what acts on it, and where that leads.
struct Case {
  TetMesh mesh;
  Scene scene;
  explicit Case(TetMesh m) : mesh(std::move(m)) { scene.source = "test"; }
  void fix(const Box& where, HeldAxes axes = kAllAxes) {
    FixedRegion region;
    region.box = where;
    region.axes = axes;
    scene.fixed.push_back(region);
  }
  Equilibrium solve(const Material& material) {
    mesh = with_nodes(std::move(mesh), material.element);
    solid.emplace(mesh, material);
    loads.emplace(scene, mesh, boundary_surface(mesh), *solid);
    return find_equilibrium(*solid,
                            {[this](std::span<const Vec3> x, std::span<Vec3> f) { loads->add_forces(x, f); },
                             loads->held(), loads->moved()},
                            "test");
  }
  /// Force that holds the nodes in `where`, N.
  Vec3 held_in(const Box& where, const Equilibrium& found) const {
    std::vector<Vec3> f(found.x.size());
    solid->forces(found.x, f);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (where.contains(solid->rest()[i])) sum += f[i];
    }
    return sum;
  }
  int node_at(const Vec3& place) const {
    int nearest = 0;
    for (int i = 0; i < solid->nodes(); ++i) {
      if ((solid->rest()[i] - place).norm() < (solid->rest()[nearest] - place).norm()) nearest = i;
    }
    return nearest;
  }
  std::optional<Solid> solid;
  std::optional<Loads> loads;
};

Material material(double e, double nu, ElementKind element, ElasticLaw law = ElasticLaw::kLinear) {
  return {e, nu, 1000, law, element, {}, {}};
}

}  // namespace

TEST_CASE(
    "equilibrium: a bar under its own weight: quadratic elements are exact, linear ones of second order") {
  // u = rho g (y L - y^2 / 2) / E with nu = 0 (Timoshenko and Goodier 1970, section 96).
  const double e = 2e4, g = 9.81, length = 0.4;
  const auto error = [&](int n, ElementKind element) {
    Case bar(grid_block(lines(0, 0.1, n / 4), lines(0, length, n), lines(0, 0.1, n / 4)));
    bar.fix(box({0, 0, 0}, {0.1, 0, 0.1}));
    bar.scene.loads.push_back(load(Load::Kind::kGravity, kAll, Vec3(0, g, 0)));
    const Equilibrium found = bar.solve(material(e, 0, element));
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < found.x.size(); ++i) {
      const double y = bar.solid->rest()[i][1], exact = 1000 * g * (y * length - y * y / 2) / e;
      sum += (found.x[i] - bar.solid->rest()[i] - Vec3(0, exact, 0)).squaredNorm();
      all += exact * exact;
    }
    return std::sqrt(sum / all);
  };
  CHECK(error(4, ElementKind::kQuadratic) < 1e-10);
  const double coarse = error(16, ElementKind::kLinear), fine = error(32, ElementKind::kLinear);
  CAPTURE(coarse, fine);
  CHECK(fine < 0.02);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.5));
}

TEST_CASE("equilibrium: a thick hollow sphere under pressure, held outside (Lame)") {
  // u = A r + B / r^2 with u(b) = 0 and sigma_r(a) = -p.
  const double a = 0.05, b = 0.1, p = 500;
  for (const ElementKind element :
       {ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic}) {
    const Material tissue = material(8e3, 0.4, element);
    const double bulk3 = 3 * tissue.lame_lambda() + 2 * tissue.lame_mu();
    const double exact_b = p / (bulk3 / (b * b * b) + 4 * tissue.lame_mu() / (a * a * a));
    const double exact = exact_b * (1 / (a * a) - a / (b * b * b));
    const auto error = [&](int level, int layers) {
      Case sphere(with_nodes(hollow_sphere(a, b, level, layers), element));
      FixedRegion outside;
      outside.box = kAll;
      sphere.scene.fixed.push_back(outside);
      Solid solid(sphere.mesh, tissue);
      std::vector<HeldAxes> held;
      const auto on_outside = [&](int v) { return solid.rest()[v].norm() > 0.999 * b; };
      for (int i = 0; i < solid.nodes(); ++i) {
        const int corners = sphere.mesh.corners();
        const bool out = i < corners ? on_outside(i)
                                     : on_outside(sphere.mesh.mid_edges[i - corners][0]) &&
                                           on_outside(sphere.mesh.mid_edges[i - corners][1]);
        held.push_back(out ? kAllAxes : 0);
      }
      sphere.scene.fixed.clear();
      Load inside = load(Load::Kind::kPressure, kAll, Vec3::Zero(), p);
      inside.region.box.reset();
      inside.region.ball = Ball{Vec3::Zero(), 1.001 * a};
      sphere.scene.loads.push_back(inside);
      const Loads loads(sphere.scene, sphere.mesh, boundary_surface(sphere.mesh), solid);
      // The surface of the mesh is a little smaller than the sphere's: so is the push on it.
      const Equilibrium found = find_equilibrium(
          solid, {[&](std::span<const Vec3> x, std::span<Vec3> f) { loads.add_forces(x, f); }, held, {}},
          "test");
      double sum = 0;
      int count = 0;
      for (int i = 0; i < sphere.mesh.corners(); ++i) {
        if (solid.rest()[i].norm() > 1.001 * a) continue;
        sum += (found.x[i] - solid.rest()[i]).dot(solid.rest()[i].normalized());
        ++count;
      }
      return std::abs(sum / count / exact - 1);
    };
    const double coarse = error(1, 3), fine = error(2, 6);
    CAPTURE(static_cast<int>(element), coarse, fine);
    CHECK(fine < 0.06);
    CHECK(std::log2(coarse / fine) == Approx(2).margin(0.6));  // of all three: edges are straight
  }
}

TEST_CASE("equilibrium: a slender cantilever of quadratic elements bends as Timoshenko's beam") {
  const double e = 1e6, nu = 0.3, length = 2, side = 0.1, force = 0.5;
  Case beam(grid_block(lines(0, length, 40), lines(0, side, 3), lines(0, side, 3)));
  beam.fix(box({0, 0, 0}, {0, side, side}));
  beam.scene.loads.push_back(load(Load::Kind::kTraction, box({length, 0, 0}, {length, side, side}),
                                  Vec3(0, -force / (side * side), 0)));
  const Equilibrium found = beam.solve(material(e, nu, ElementKind::kQuadratic));
  const double inertia = std::pow(side, 4) / 12, shear = 10 * (1 + nu) / (12 + 11 * nu);  // Cowper 1966
  const double exact = force * length * length * length / (3 * e * inertia) +
                       force * length / (shear * e / (2 * (1 + nu)) * side * side);
  const int tip = beam.node_at({length, side / 2, side / 2});
  CHECK(beam.solid->rest()[tip][1] - found.x[tip][1] ==
        Approx(exact).epsilon(0.01));  // the clamp stiffens it a little
}

TEST_CASE("equilibrium: Cook's membrane as a thin slab: 23.96 at the middle of its edge") {
  const auto tip = [](int n, ElementKind element) {
    Case slab(mapped(grid_block(lines(0, 1, n), lines(0, 1, n), lines(0, 1, 1)), [](const Vec3& p) {
      const double low = 44 * p[0], high = 44 + 16 * p[0];
      return Vec3(48 * p[0], low + (high - low) * p[1], p[2]);
    }));
    slab.fix(box({0, 0, 0}, {0, 44, 1}), 3);
    slab.fix(box({0, 0, 0}, {48, 60, 0}), 4);
    slab.scene.loads.push_back(
        load(Load::Kind::kTraction, box({48, 44, 0}, {48, 60, 1}), Vec3(0, 1.0 / 16, 0)));
    const Equilibrium found = slab.solve(material(1, 1.0 / 3, element));
    const int node = slab.node_at({48, 52, 0.5});
    return found.x[node][1] - slab.solid->rest()[node][1];
  };
  CHECK(tip(16, ElementKind::kQuadratic) == Approx(23.96).epsilon(0.005));
  const double coarse = 23.96 - tip(16, ElementKind::kLinear), fine = 23.96 - tip(32, ElementKind::kLinear);
  CAPTURE(coarse, fine);
  CHECK(fine > 0);  // bends too stiffly
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.5));
}

namespace {
/// A flat punch of radius a without friction on a layer of thickness 1 that is bonded below: F (1 - nu^2) /
/// (2 a E w), which is the factor kappa of Hayes, Keer, Herrmann and Mockros (1972, J. Biomech. 5:541). A
/// quarter of it, the circle of the punch on grid lines.
double kappa(double a, double nu, ElementKind element, int under, int beyond, int deep, double power) {
  const double far = a + 2, e = 1e4, w = 1e-3;
  // Fine towards the rim from both sides, and from the surface down.
  std::vector<double> across, down;
  for (int i = 0; i < under; ++i) across.push_back(a * std::sin(std::numbers::pi / 2 * i / under));
  for (int i = 0; i <= beyond; ++i) across.push_back(a + (far - a) * std::pow(1.0 * i / beyond, 3));
  for (int i = 0; i <= deep; ++i) down.push_back(-std::pow(1 - 1.0 * i / deep, power));
  Case layer(mapped(grid_block(across, down, across), square_to_disc));
  layer.fix(box({0, -1, 0}, {far, -1, far}));
  layer.fix(box({0, -1, 0}, {1e-12, 0, far}), 1);
  layer.fix(box({0, -1, 0}, {far, 0, 1e-12}), 4);
  Load punch = load(Load::Kind::kDisplacement, kAll, Vec3(0, -w, 0), 0, 2);
  punch.region.box.reset();
  punch.region.ball = Ball{Vec3(0, 2, 0), std::hypot(2, a * (1 + 1e-9))};
  layer.scene.loads.push_back(punch);
  const Equilibrium found = layer.solve(material(e, nu, element));
  std::vector<Vec3> f(found.x.size());
  layer.solid->forces(found.x, f);
  double force = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (found.x[i][1] < -0.9) force += 4 * f[i][1];  // what the ground bears
  }
  return force * (1 - nu * nu) / (2 * a * e * w);
}
}  // namespace

TEST_CASE("equilibrium: flat punch on a bonded layer (Hayes 1972), from above, in more than first order") {
  struct Row {
    double a, nu, kappa, power;
    int under, beyond, deep;  // half of them first
  };
  for (const Row& row : {Row{0.4, 0.45, 1.5993, 1.5, 6, 8, 8}, Row{0.1, 0.45, 1.1146, 2.5, 6, 10, 8}}) {
    const auto error = [&](int divided) {
      return kappa(row.a, row.nu, ElementKind::kQuadratic, row.under / divided, row.beyond / divided,
                   row.deep / divided, row.power) /
                 row.kappa -
             1;
    };
    const double coarse = error(2), fine = error(1);
    CAPTURE(row.a, coarse, fine);
    CHECK(fine > 0);
    CHECK(fine < 0.015);
    CHECK(std::log2(coarse / fine) > 2);
  }
}

TEST_CASE(
    "equilibrium: nearly incompressible, the bonded layer does not lock but with plain linear elements") {
  // Hayes 1972, towards nu = 1/2.
  constexpr double kWide = 1.684, kNarrow = 1.126;
  CHECK(kappa(0.4, 0.499, ElementKind::kQuadratic, 6, 8, 8, 1.5) == Approx(kWide).epsilon(0.03));
  CHECK(kappa(0.1, 0.499, ElementKind::kQuadratic, 4, 12, 8, 2.5) == Approx(kNarrow).epsilon(0.03));
  const double coarse = kappa(0.4, 0.499, ElementKind::kNodalPressure, 4, 8, 7, 1.5) - kWide;
  const double fine = kappa(0.4, 0.499, ElementKind::kNodalPressure, 8, 16, 14, 1.5) - kWide;
  CAPTURE(coarse, fine);
  CHECK(std::abs(fine) < 0.03 * kWide);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.5));
  CHECK(kappa(0.4, 0.499, ElementKind::kLinear, 8, 10, 10, 2) > 1.5 * kWide);
}

TEST_CASE("equilibrium: turned by a quarter, a body bears its load as before") {
  for (const ElasticLaw law :
       {ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean}) {
    const auto result = [&](bool turned) {
      const Mat3 turn =
          Eigen::AngleAxisd(turned ? std::numbers::pi / 2 : 0, Vec3::UnitZ()).toRotationMatrix();
      Case bar(grid_block(lines(0, 0.1, 3), lines(0, 0.1, 3), lines(0, 0.1, 3)));
      const Solid solid(bar.mesh, material(1e4, 0.4, ElementKind::kLinear, law));
      std::vector<HeldAxes> held;
      std::vector<Vec3> start;
      std::vector<Vec3> forces(bar.mesh.vertices.size(), Vec3::Zero());
      for (std::size_t i = 0; i < bar.mesh.vertices.size(); ++i) {
        const Vec3& x = bar.mesh.vertices[i];
        held.push_back(x[1] == 0 ? kAllAxes : 0);
        start.push_back(turn * x);
        if (x[1] > 0.099) forces[i] = turn * Vec3(0.2, -0.1, 0.05);
      }
      const Equilibrium found = find_equilibrium(
          solid,
          {[&](std::span<const Vec3>, std::span<Vec3> f) { std::ranges::copy(forces, f.begin()); },
           held,
           {},
           start},
          "test");
      std::vector<Vec3> back = found.x;
      for (Vec3& x : back) x = turn.transpose() * x;
      return back;
    };
    const auto straight = result(false), turned = result(true);
    double largest = 0;
    for (std::size_t i = 0; i < straight.size(); ++i)
      largest = std::max(largest, (straight[i] - turned[i]).norm());
    CHECK(largest < 1e-9);
  }
}

TEST_CASE("equilibrium: beyond Euler's load a straight column is refused, or found bent as the elastica") {
  // Held below, loaded above: P_cr = pi^2 E I / (4 l^2). A straight column is in equilibrium under any load,
  // but beyond that one unstable. Bent, with its top turned by 2 asin k, it bears P_cr (2 K(k) / pi)^2, with
  // the top 2 k / K(k) of its length aside (Timoshenko and Gere 1961, section 2.7).
  const double e = 1e6, length = 1, side = 0.025, excess = 1.2;
  const double critical = std::pow(std::numbers::pi / length, 2) / 4 * e * std::pow(side, 4) / 12;
  const TetMesh mesh = with_nodes(grid_block(lines(0, length, 25), lines(0, side, 1), lines(0, side, 1)),
                                  ElementKind::kQuadratic);
  for (const ElasticLaw law : {ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    const Solid solid(mesh, material(e, 0, ElementKind::kQuadratic, law));
    std::vector<HeldAxes> held;
    std::vector<Vec3> forces(static_cast<std::size_t>(solid.nodes()), Vec3::Zero());
    std::vector<std::size_t> top;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      held.push_back(solid.rest()[i][0] == 0 ? kAllAxes : 0);
      if (solid.rest()[i][0] > length - 1e-9) top.push_back(i);
    }
    for (const std::size_t i : top) forces[i][0] = -excess * critical / static_cast<double>(top.size());
    CAPTURE(static_cast<int>(law));
    double reached = 0;
    try {
      const Equilibrium found = find_equilibrium(
          solid,
          {[&](std::span<const Vec3>, std::span<Vec3> f) { std::ranges::copy(forces, f.begin()); }, held},
          "test", [&](double fraction) { reached = fraction; });
      double k = 0;
      while (std::pow(2 * std::comp_ellint_1(k) / std::numbers::pi, 2) < excess) k += 1e-5;
      Vec3 aside = found.x[top.front()] - solid.rest()[top.front()];
      aside[0] = 0;
      CHECK(aside.norm() == Approx(2 * k / std::comp_ellint_1(k) * length).epsilon(0.03));
    } catch (const Error& error) {
      CHECK_THAT(error.what(), Catch::Contains("no stable equilibrium"));
      CHECK(reached == Approx(1 / excess).epsilon(0.01));
    }
  }
}

TEST_CASE("equilibrium: a body that nothing holds is told") {
  Case loose(grid_block(lines(0, 0.1, 2), lines(0, 0.1, 2), lines(0, 0.1, 2)));
  loose.scene.loads.push_back(load(Load::Kind::kGravity, kAll, Vec3(0, -9.81, 0)));
  CHECK_THROWS_WITH(loose.solve(material(1e4, 0.4, ElementKind::kLinear)), Catch::Contains("[[fixed]]"));
}

TEST_CASE("equilibrium: a body that its supports move as one is at rest there, by any law") {
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    Case shifted(grid_block(lines(0, 0.1, 4), lines(0, 0.05, 2), lines(0, 0.05, 2)));
    const Box bottom = box(Vec3(0, 0, 0), Vec3(0.1, 0, 0.05));
    shifted.fix(bottom);
    const Vec3 way(0.003, 0.004, -0.001);
    shifted.scene.loads = {load(Load::Kind::kDisplacement, bottom, way)};
    const Equilibrium found = shifted.solve(material(8e3, 0.3, ElementKind::kLinear, law));
    for (std::size_t i = 0; i < found.x.size(); ++i) {
      CAPTURE(static_cast<int>(law), i);
      CHECK((found.x[i] - shifted.solid->rest()[i] - way).norm() < 1e-12);
    }
  }
}
