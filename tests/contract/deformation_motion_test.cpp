// What every deformation model must do over many steps: energy, and where it comes to rest.
#include "sim_server/elasticity/equilibrium.h"
#include "tests/support/catch.h"
#include "tests/support/model_bench.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

/// The body of a bench, at positions of its surface: all there is of it where it is thin.
struct Body {
  const ModelBench& bench;
  Solid solid{bench.mesh, *bench.scene.material};
  std::vector<double> mass = solid.masses();

  std::vector<Vec3> nodes(std::span<const Vec3> surface) const {
    std::vector<Vec3> x = bench.mesh.vertices;
    for (int v = 0; v < bench.size(); ++v) x[bench.surface.vertices[v]] = surface[v];
    return x;
  }
  double elastic(std::span<const Vec3> surface) const { return solid.energy(nodes(surface)); }
  /// 1/2 of mass times the velocities by which it came from `before` in `h`, J.
  double kinetic(std::span<const Vec3> before, std::span<const Vec3> now, double h) const {
    double sum = 0;
    for (int v = 0; v < bench.size(); ++v)
      sum += 0.5 * mass[bench.surface.vertices[v]] * ((now[v] - before[v]) / h).squaredNorm();
    return sum;
  }
  /// u . K v / 2 of two displacements, of the linear law, J.
  double mixed(std::span<const Vec3> before, std::span<const Vec3> now) const {
    const std::vector<Vec3> a = nodes(before), b = nodes(now);
    std::vector<Vec3> f(a.size());
    solid.forces(a, f);
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) sum += 0.5 * f[i].dot(b[i] - solid.rest()[i]);
    return sum;
  }
};

std::vector<NodalLoad> pull(const ModelBench& bench, double share) {
  return {{bench.size() - 1, share * Vec3(0.06, -0.03, 0.1)},
          {bench.size() - 3, share * Vec3(0, 0.1, -0.05)}};
}

/// Up, held, down, nothing: of step i.
double share_of(int i) {
  return std::clamp(std::min(0.1 * i, 0.1 * (30 - i)), 0.0, 1.0);
}

}  // namespace

TEST_CASE(
    "contract: what a body stores is never more than loads have put in, and a cycle of them takes work") {
  for (const ModelCase& choice : model_cases()) {
    DYNAMIC_SECTION(choice.name()) {
      ModelBench bench(choice, {.thin = true, .rate_hz = 250});
      const Body body{bench};
      REQUIRE(bench.size() == static_cast<int>(bench.mesh.vertices.size()));
      const bool stores = !exempt(choice.row.name, "elastic energy");
      double work = 0, most = 0;
      std::vector<Vec3> before = bench.step({});
      for (int i = 0; i < 300; ++i) {
        const std::vector<NodalLoad> loads = pull(bench, share_of(i));
        const std::vector<Vec3> now = bench.step(loads);
        for (const NodalLoad& load : loads) work += load.force.dot(now[load.vertex] - before[load.vertex]);
        const double elastic = stores ? body.elastic(now) : 0;
        most = std::max(most, elastic);
        CHECK(elastic <= work * (1 + 1e-9) + 1e-18);
        before = now;
      }
      CAPTURE(work, most);
      CHECK(work >= 0);
      if (stores && bench.compliance(bench.reachable).norm() > 0) {
        CHECK(most > 1e-5);
        CHECK(body.elastic(before) < 1e-3 * most);  // damped
        CHECK(work > 1e-3 * most);
      }
    }
  }
}

TEST_CASE("contract: let go, a body in motion never gains energy") {
  for (const ModelCase& choice : model_cases()) {
    const bool implicit = choice.row.name == "implicit", leaps = choice.row.name == "tensor_mass";
    if (!implicit && !leaps) continue;  // their velocity is not seen from outside
    DYNAMIC_SECTION(choice.name()) {
      const double rate = 2000;  // so that explicit has one sub-step a period, and implicit damps little
      ModelBench bench(choice, {.thin = true, .rate_hz = rate, .rayleigh_mass = 0, .rayleigh_stiffness = 0});
      const Body body{bench};
      std::vector<Vec3> before;
      for (int i = 0; i < 20; ++i) before = bench.step(pull(bench, 1));
      double last = 0, first = 0;
      for (int i = 0; i < 400; ++i) {
        const std::vector<Vec3> now = bench.step({});
        const double kinetic = body.kinetic(before, now, 1 / rate),
                     energy = kinetic + (implicit ? body.elastic(now) : body.mixed(before, now));
        // The force fades in the middle of the first explicit step.
        if (i == 1) first = energy;
        if (i > 1) CHECK(energy <= last + 1e-10 * first);
        last = energy;
        before = now;
      }
      CAPTURE(first, last);
      CHECK(first > 1e-5);
      if (leaps) CHECK(last == Approx(first).epsilon(1e-9));  // which keeps it
    }
  }
}

TEST_CASE("contract: under loads that stay, a body comes to rest in the static equilibrium, to 1e-6") {
  for (const ModelCase& choice : model_cases()) {
    if (exempt(choice.row.name, "static limit")) continue;
    DYNAMIC_SECTION(choice.name()) {
      ModelBench bench(choice, {.rate_hz = 30, .rayleigh_mass = 30, .rayleigh_stiffness = 1e-3});
      const std::vector<NodalLoad> loads = pull(bench, 1);
      std::vector<Vec3> moved;
      for (int i = 0; i < 120; ++i) moved = bench.step(loads);
      const Solid solid(bench.mesh, *bench.scene.material);
      std::vector<HeldAxes> held(bench.mesh.vertices.size(), 0);
      for (const int v : bench.fixed) held[v] = kAllAxes;
      const auto forces = [&](std::span<const Vec3>, std::span<Vec3> f) {
        for (const NodalLoad& load : loads) f[bench.surface.vertices[load.vertex]] += load.force;
      };
      const Equilibrium found = find_equilibrium(solid, {.forces = forces, .held = held}, "test");
      double off = 0;
      for (int v = 0; v < bench.size(); ++v)
        off = std::max(off, (moved[v] - found.x[bench.surface.vertices[v]]).norm());
      CAPTURE(off, bench.largest_way(moved));
      CHECK(bench.largest_way(moved) > 0.002);
      CHECK(off < 1e-6 * bench.largest_way(moved));
    }
  }
}
