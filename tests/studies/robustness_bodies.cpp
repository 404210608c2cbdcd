// Bodies without tools: flung out of shape, and left swinging.
#include <fmt/core.h>

#include "common/error.h"
#include "sim_server/explicit/explicit_motion.h"
#include "sim_server/solvers/dynamics.h"
#include "tests/studies/robustness.h"
#include "tests/support/random.h"

namespace palpate::studies {
namespace {

using namespace palpate::sim;

constexpr double kSize = 0.03;      // m, of the block
constexpr double kNoise = 1e-6;     // of that
constexpr double kStep = 1.0 / 30;  // s
constexpr double kHome = 1e-3;      // of the size: back at rest
constexpr double kFar = 100;        // of the size: exploded

std::vector<HeldAxes> held_below(const Solid& solid) {
  std::vector<HeldAxes> held;
  for (const Vec3& x : solid.rest()) held.push_back(x[1] < -0.0149 ? kAllAxes : 0);
  return held;
}

double furthest(std::span<const Vec3> from, std::span<const Vec3> to) {
  double most = 0;
  for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, (to[i] - from[i]).norm());
  return most;
}

int inverted(const Solid& solid, std::span<const Vec3> x) {
  std::vector<Solid::State> states(solid.points());
  solid.evaluate(x, states);
  int count = 0;
  for (const Solid::State& state : states) count += state.F.determinant() > 0 ? 0 : 1;
  return count;
}

/// Lets go of a body whose free vertices `put` has put somewhere.
template <class Put>
Verdict release(const Column& column, bool quick, const Put& put) {
  if (!column.any_law())
    return {"not_applicable", "the state of this model is not free vertices", {}, {}, ""};
  const Solid solid(usual_block(), {.young_modulus = 1e4, .poisson_ratio = 0.45, .law = column.elastic});
  const std::vector<HeldAxes> held = held_below(solid);
  std::vector<Vec3> x = solid.rest();
  test::Random random(7);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (held[i] == 0) x[i] = put(x[i], random);
  }
  Dynamics dynamics(solid, held, {.rayleigh_mass = 10, .rayleigh_stiffness = 1e-4}, "study");
  dynamics.set_state(x);
  const std::vector<Vec3> none(x.size(), Vec3::Zero());
  const int steps = quick ? 150 : 300;
  double most = 0;
  for (int i = 0; i < steps; ++i) {
    dynamics.start_step(kStep);
    dynamics.solve(none, 5, 1e-5);
    dynamics.finish_step();
    most = std::max(most, furthest(solid.rest(), dynamics.position()) / kSize);
  }
  const double off = furthest(solid.rest(), dynamics.position()) / kSize;
  Verdict verdict{"stable", "", 100 * off, {}, "the shape at rest, in percent of the size"};
  if (!std::isfinite(off) || most > kFar) {
    return {
        "exploded", fmt::format("it came to {:.3g} of its size from rest", most), {}, {}, verdict.reference};
  }
  if (off > kHome) {
    const bool said = dynamics.inside_out() || dynamics.relative_residual() > 0.05;
    verdict.outcome = said ? "flagged" : "wrong";
    verdict.reason =
        fmt::format("{:.0f} s later {} elements are still inverted: this law has a second rest there",
                    steps * kStep, inverted(solid, dynamics.position()));
  }
  return verdict;
}

/// Of the conserved quantity of a leap-frog: its kinetic energy at a half step, with u K u' / 2 of the
/// displacements around it.
double energy_of(const ElasticTensors& tensors, const ExplicitMotion::State& state,
                 const std::vector<double>& before) {
  std::vector<double> force(state.u.size());
  tensors.multiply(before.data(), force.data());
  double energy = 0;
  for (std::size_t k = 0; k < force.size(); ++k)
    energy += 0.5 * (tensors.masses()[k / 3] * state.v[k] * state.v[k] + force[k] * state.u[k]);
  return energy;
}

}  // namespace

Verdict run_scattered(const Case&, const Column& column, bool quick) {
  return release(column, quick,
                 [](const Vec3& x, test::Random& random) -> Vec3 { return x + random.vector(kSize / 2); });
}

Verdict run_collapsed_to_point(const Case&, const Column& column, bool quick) {
  return release(column, quick,
                 [](const Vec3&, test::Random& random) -> Vec3 { return random.vector(kNoise * kSize); });
}

Verdict run_collapsed_to_plane(const Case&, const Column& column, bool quick) {
  return release(column, quick, [](const Vec3& x, test::Random& random) -> Vec3 {
    return Vec3(x[0], 0, x[2]) + random.vector(kNoise * kSize);
  });
}

/// A body that turns, goes and shakes: is its momentum kept?
Verdict run_free_body(const Case& row, const Column& column, bool quick) {
  if (!column.any_law() || column.linear()) return run_trial(row, column, quick);
  const Solid solid(usual_block(), {.young_modulus = 1e4, .poisson_ratio = 0.45, .law = column.elastic});
  const std::vector<Vec3> none(solid.rest().size(), Vec3::Zero());
  std::vector<Vec3> v(none.size());
  test::Random random(7);
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] = Vec3(0.1, 0.2, -0.05) + Vec3(2, 1, 3).cross(solid.rest()[i]) + random.vector(0.05);
  Dynamics dynamics(solid, std::vector<HeldAxes>(none.size(), 0), {.rayleigh_stiffness = 1e-4, .flies = true},
                    "study");
  dynamics.set_state(solid.rest(), v);
  const std::vector<double> mass = solid.masses();
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * dynamics.velocity()[i];
    return sum;
  };
  const Vec3 before = momentum();
  const int steps = quick ? 60 : 300;
  double most = 0;
  bool settled = true;
  for (int i = 0; i < steps; ++i) {
    dynamics.start_step(kStep);
    dynamics.solve(none, 20, 1e-9);
    settled = settled && dynamics.relative_residual() < 0.05 && !dynamics.inside_out();
    dynamics.finish_step();
    most = std::max(most, (momentum() - before).norm() / before.norm());
  }
  Verdict verdict{
      "stable", fmt::format("it flies for {:.0f} s", steps * kStep), 100 * most, {}, "its momentum at first"};
  if (!settled) verdict.outcome = "flagged";
  if (!(most < 1e-3)) verdict.outcome = settled ? "wrong" : "flagged";
  return verdict;
}

/// A body that was kicked everywhere: does its energy stay?
Verdict run_undamped(const Case&, const Column& column, bool quick) {
  if (column.row->materials != Materials::kPlain)
    return {"not_applicable", "only tensor_mass has sub-steps", {}, {}, ""};
  const TetMesh mesh = usual_block();
  std::vector<int> fixed;
  for (int v = 0; v < mesh.corners(); ++v) {
    if (mesh.vertices[v][1] < -0.0149) fixed.push_back(v);
  }
  const ElasticTensors tensors(mesh, {.young_modulus = 1e4, .poisson_ratio = 0.45}, fixed);
  const RayleighDamping undamped{.mass = 0, .stiffness = 0};
  ExplicitMotion motion(tensors, undamped);
  test::Random random(7);
  for (double& v : motion.state.v) v = random.between(-0.1, 0.1);
  const double h = 0.95 * longest_sub_step(highest_frequency(tensors), undamped);
  const std::vector<double> none(motion.state.u.size(), 0);
  const int polls = 1000, between = quick ? 10 : 1000;
  double first = 0, least = 0, most = 0;
  for (int i = 0; i < polls; ++i) {
    motion.run(between - 1, h, none);
    const std::vector<double> before = motion.state.u;
    motion.run(1, h, none);
    const double energy = energy_of(tensors, motion.state, before);
    if (i == 0) first = least = most = energy;
    least = std::min(least, energy);
    most = std::max(most, energy);
  }
  const double band = 100 * (most - least) / first;
  Verdict verdict{"stable",
                  fmt::format("{} sub-steps", polls * between),
                  band,
                  {},
                  "the energy of the first sub-steps, band of all"};
  if (!(band < 1)) verdict.outcome = "wrong";
  return verdict;
}

}  // namespace palpate::studies
