// What every deformation model must do over many steps: energy, and where it comes to rest.
#include <utility>

#include "sim_server/solvers/equilibrium.h"
#include "tests/support/catch.h"
#include "tests/support/contract.h"
#include "tests/support/model_bench.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

/// The share of stress that never fades.
double remaining_of(const Material& material) {
  double remaining = 1;
  for (const Relaxation& term : material.relaxations) remaining -= term.fraction;
  return remaining;
}
/// A tissue that has relaxed.
Material relaxed(Material material) {
  const double remaining = remaining_of(material);
  material.young_modulus *= remaining;
  if (material.fibres) material.fibres->modulus *= remaining;
  material.relaxations.clear();
  return material;
}

/// The body of a bench, at positions of its surface: all there is of it where it is thin. Its stresses are
/// those that never fade.
struct Body {
  const ModelBench& bench;
  Solid solid{bench.mesh, relaxed(*bench.scene.material)};
  std::vector<double> mass = solid.masses();
  double remaining = remaining_of(*bench.scene.material);

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
  /// Elastic energy between two places, J: u . K v / 2 of their displacements, of the linear law.
  double between(std::span<const Vec3> before, std::span<const Vec3> now) const {
    if (solid.material().law != ElasticLaw::kLinear) return 0.5 * (elastic(before) + elastic(now));
    const std::vector<Vec3> a = nodes(before), b = nodes(now);
    std::vector<Vec3> f(a.size());
    solid.forces(a, f);
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) sum += 0.5 * f[i].dot(b[i] - solid.rest()[i]);
    return sum;
  }
};

/// What stresses that fade store, of the linear law: term k is that of a body whose displacement follows as
///   u_k' = e^(-h / tau_k) u_k + gamma_k (u' - u),   gamma_k = (1 - e^(-h / tau_k)) tau_k / h (Simo 1987).
struct Fading {
  const ModelBench& bench;
  std::vector<std::vector<Vec3>> places{};  // rest + u_k
  explicit Fading(const ModelBench& of) : bench(of) {
    std::vector<Vec3> rest;
    for (int v = 0; v < bench.size(); ++v) rest.push_back(bench.rest(v));
    places.assign(bench.scene.material->relaxations.size(), rest);
  }
  void follow(std::span<const Vec3> before, std::span<const Vec3> now) {
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double x = 1 / (bench.scene.rate_hz * bench.scene.material->relaxations[k].time),
                   fade = std::exp(-x), gamma = (1 - fade) / x;
      for (int v = 0; v < bench.size(); ++v)
        places[k][v] = bench.rest(v) + fade * (places[k][v] - bench.rest(v)) + gamma * (now[v] - before[v]);
    }
  }
  double energy(const Body& body) const {
    double sum = 0;
    for (std::size_t k = 0; k < places.size(); ++k)
      sum += bench.scene.material->relaxations[k].fraction * body.elastic(places[k]) / body.remaining;
    return sum;
  }
};

std::vector<VertexLoad> pull(const ModelBench& bench, double fraction) {
  return {{bench.size() - 1, fraction * Vec3(0.06, -0.03, 0.1)},
          {bench.size() - 3, fraction * Vec3(0, 0.1, -0.05)}};
}

/// Up, held, down, nothing: of step i.
double fraction_of(int i) {
  return std::clamp(std::min(0.1 * i, 0.1 * (30 - i)), 0.0, 1.0);
}

}  // namespace

CONTRACT("what a body stores is never more than loads have put in, and a cycle of them takes work", ModelCase,
         choice, model_cases()) {
  ModelBench bench(choice, {.thin = true, .rate_hz = 250});
  const Body body{bench};
  REQUIRE(bench.size() == static_cast<int>(bench.mesh.vertices.size()));
  const bool stores = !exempt(choice, "elastic energy");
  double work = 0, most = 0;
  std::vector<Vec3> before = bench.step({});
  for (int i = 0; i < 300; ++i) {
    const std::vector<VertexLoad> loads = pull(bench, fraction_of(i));
    const std::vector<Vec3> now = bench.step(loads);
    for (const VertexLoad& load : loads) work += load.force.dot(now[load.vertex] - before[load.vertex]);
    const double elastic = stores ? body.elastic(now) : 0;
    most = std::max(most, elastic);
    CHECK(elastic <= work * (1 + 1e-9) + 1e-18);
    before = now;
  }
  CAPTURE(work, most);
  CHECK(work >= 0);
  if (stores) {
    CHECK(most > 1e-5);
    CHECK(body.elastic(before) < 1e-3 * most);  // damped
    CHECK(work > 1e-3 * most);
  }
}

CONTRACT("let go, a body in motion never gains energy", ModelCase, choice,
         model_cases([](const ModelCase& c) {
           return c.row.takes<sim::RayleighDamping>() && !exempt(c, "energy in motion");
         })) {
  const bool each_step = !exempt(choice, "energy step by step"),
             at_tool = each_step && !exempt(choice, "energy in one place");
  // So that explicit has one sub-step a period, and implicit damps little.
  const double rate = each_step ? 2000 : 20000;
  ModelBench bench(choice, {.thin = true, .rate_hz = rate, .rayleigh_mass = 0, .rayleigh_stiffness = 0});
  const Body body{bench};
  Fading fading(bench);
  std::vector<Vec3> before, now = bench.step({});
  const auto step = [&](double fraction) {
    before = std::exchange(now, bench.step(pull(bench, fraction)));
    fading.follow(before, now);
  };
  for (int i = 0; i < 0.01 * rate; ++i) step(1);
  double last = 0, first = 0, gained = 0;
  for (int i = 0; i < 0.2 * rate; ++i) {
    step(0);
    const double energy = body.kinetic(before, now, 1 / rate) + fading.energy(body) +
                          (at_tool ? body.elastic(now) : body.between(before, now));
    if (i == 1) first = last = energy;  // the force fades in the middle of the first explicit step
    if (i > 1) gained = std::max(gained, energy - (each_step ? last : first));
    last = energy;
  }
  CAPTURE(first, last, gained);
  CHECK(first > 1e-5);
  CHECK(gained <= (each_step ? 1e-10 : 1e-3) * first);
  if (choice.row.name == "tensor_mass") CHECK(last == Approx(first).epsilon(1e-9));  // which keeps it
}

CONTRACT("let go, a body without mass is back at rest at once", ModelCase, choice,
         model_cases([](const ModelCase& c) { return !c.row.takes<sim::RayleighDamping>(); })) {
  INFO("a model that has no static limit is exempt in tests/support/model_cases.h: \"static limit\"");
  ModelBench bench(choice, {.thin = true});
  const double moved = bench.largest_way(bench.step(pull(bench, 1)));
  if (!exempt(choice, "static limit")) CHECK(moved > 1e-3);
  for (int i = 0; i < 3; ++i) CHECK(bench.largest_way(bench.step({})) <= 1e-12 * moved);
}

CONTRACT("under loads that stay, a body comes to rest in the static equilibrium, to 1e-6", ModelCase, choice,
         model_cases([](const ModelCase& c) { return !exempt(c, "static limit"); })) {
  ModelBench bench(choice, {.rate_hz = 30, .rayleigh_mass = 30, .rayleigh_stiffness = 1e-3});
  const std::vector<VertexLoad> loads = pull(bench, 1);
  std::vector<Vec3> moved;
  for (int i = 0; i < 120; ++i) moved = bench.step(loads);
  const Solid solid(bench.mesh, relaxed(*bench.scene.material));
  std::vector<HeldAxes> held(bench.mesh.vertices.size(), 0);
  for (const int v : bench.fixed) held[v] = kAllAxes;
  const auto forces = [&](std::span<const Vec3>, std::span<Vec3> f) {
    for (const VertexLoad& load : loads) f[bench.surface.vertices[load.vertex]] += load.force;
  };
  const Equilibrium found = find_equilibrium(solid, {.forces = forces, .held = held}, "test");
  double off = 0;
  for (int v = 0; v < bench.size(); ++v)
    off = std::max(off, (moved[v] - found.x[bench.surface.vertices[v]]).norm());
  INFO("a model that has no static limit is exempt in tests/support/model_cases.h: \"static limit\"");
  CAPTURE(off, bench.largest_way(moved));
  CHECK(bench.largest_way(moved) > 0.002);
  CHECK(off < 1e-6 * bench.largest_way(moved));
}
