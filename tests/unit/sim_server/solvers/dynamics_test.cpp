// Bodies in motion against closed forms and a dense eigen-solver.
#include "sim_server/solvers/dynamics.h"

#include <numbers>

#include "sim_server/solvers/equilibrium.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kSide = 0.05;

TetMesh small_block() {
  return grid_block(lines(0, kSide, 2), lines(0, kSide, 2), lines(0, kSide, 2));
}
Material soft(ElasticLaw law = ElasticLaw::kLinear, std::vector<Relaxation> relaxations = {}) {
  return {8e3, 0.4, 1000, law, ElementKind::kLinear, {}, std::move(relaxations)};
}
std::vector<HeldAxes> held_below(const Solid& solid) {
  std::vector<HeldAxes> held;
  for (const Vec3& x : solid.rest()) held.push_back(x[1] == 0 ? kAllAxes : 0);
  return held;
}
std::vector<Vec3> pull(const Solid& solid, const Vec3& force) {
  std::vector<Vec3> f(solid.rest().size(), Vec3::Zero());
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (solid.rest()[i][1] > 0.99 * kSide) f[i] = force / 9;
  }
  return f;
}

/// The lowest frequency (rad/s) and its mode over the unknowns, by a dense generalised eigen-solver.
std::pair<double, Eigen::VectorXd> lowest_mode(const Solid& solid, const FreeDofs& dofs) {
  StiffnessMatrix k = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), k);
  const Eigen::MatrixXd dense = k.lower();
  const std::vector<double> masses = solid.masses();
  Eigen::VectorXd m = Eigen::VectorXd::Zero(dofs.count);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (dofs.first[i] >= 0) m.segment<3>(dofs.first[i]).setConstant(masses[i]);
  }
  const Eigen::MatrixXd full = dense.selfadjointView<Eigen::Lower>();
  const test::DenseModes modes = test::dense_modes(full, m);
  return {std::sqrt(modes.squares[0]), modes.shapes.col(0)};
}

}  // namespace

TEST_CASE("dynamics: steps of a mode follow its recursion: backward Euler and BDF2, with Rayleigh damping") {
  for (const bool second : {false, true}) {
    const Solid solid(small_block(), soft());
    const double alpha = 1.5, beta = 0.002, h = 0.004;
    Dynamics dynamics(solid, held_below(solid), {alpha, beta, second}, "test");
    const auto [omega, mode] = lowest_mode(solid, dynamics.dofs());
    // A force along M mode pushes nothing but the mode: q'' + (alpha + beta w^2) q' + w^2 q = 1.
    const std::vector<double> masses = solid.masses();
    std::vector<Vec3> force(masses.size(), Vec3::Zero());
    for (std::size_t i = 0; i < masses.size(); ++i) {
      if (dynamics.dofs().first[i] >= 0)
        force[i] = 1e-3 * masses[i] * mode.segment<3>(dynamics.dofs().first[i]);
    }
    double q = 0, v = 0, q_then = 0, v_then = 0;
    for (int step = 0; step < 60; ++step) {
      dynamics.start_step(h);
      dynamics.solve(force, 3, 1e-12);
      dynamics.finish_step();
      const bool two = second && step > 0;
      const double c = (two ? 1.5 : 1) / h, from = two ? (4 * q - q_then) / 3 : q,
                   from_v = two ? (4 * v - v_then) / 3 : v, damping = alpha + beta * omega * omega;
      const double next =
          (1e-3 + (c * c + damping * c) * from + c * from_v) / (c * c + damping * c + omega * omega);
      q_then = q;
      v_then = v;
      v = c * (next - from);
      q = next;
      Eigen::VectorXd u(dynamics.dofs().count);
      for (std::size_t i = 0; i < masses.size(); ++i) {
        if (dynamics.dofs().first[i] >= 0)
          u.segment<3>(dynamics.dofs().first[i]) = dynamics.position()[i] - solid.rest()[i];
      }
      REQUIRE((u - q * mode).norm() < 1e-8 * (q * mode).norm());
    }
  }
}

TEST_CASE("dynamics: BDF2 is of second order against the closed form of a damped oscillator") {
  const Solid solid(small_block(), soft());
  const auto error = [&](double h, bool second) {
    Dynamics dynamics(solid, held_below(solid), {.rayleigh_mass = 4, .second_order = second}, "test");
    const auto [omega, mode] = lowest_mode(solid, dynamics.dofs());
    const std::vector<double> masses = solid.masses();
    std::vector<Vec3> force(masses.size(), Vec3::Zero());
    std::size_t seen = 0;
    for (std::size_t i = 0; i < masses.size(); ++i) {
      if (dynamics.dofs().first[i] < 0) continue;
      force[i] = masses[i] * mode.segment<3>(dynamics.dofs().first[i]);
      seen = i;
    }
    double t = 0;
    while (t < 0.2 - h / 2) {
      dynamics.start_step(h);
      dynamics.solve(force, 3, 1e-12);
      dynamics.finish_step();
      t += h;
    }
    const double fade = 2, w = std::sqrt(omega * omega - fade * fade);
    const double q =
        (1 - std::exp(-fade * t) * (std::cos(w * t) + fade / w * std::sin(w * t))) / (omega * omega);
    const Vec3 exact = q * mode.segment<3>(dynamics.dofs().first[seen]);
    return (dynamics.position()[seen] - solid.rest()[seen] - exact).norm() / exact.norm();
  };
  CHECK(std::log2(error(0.002, true) / error(0.001, true)) > 1.7);
  CHECK(std::log2(error(0.002, false) / error(0.001, false)) == Approx(1).margin(0.4));
  CHECK(error(0.001, true) < 0.1 * error(0.001, false));
}

TEST_CASE("dynamics: with damping every law comes to rest in its static equilibrium, to 1e-6") {
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff,
                               ElasticLaw::kNeoHookean}) {
    const Solid solid(small_block(), soft(law));
    const std::vector<Vec3> force = pull(solid, Vec3(1, 0.5, 0));
    const Equilibrium rest = find_equilibrium(
        solid, {[&](auto, std::span<Vec3> f) { std::ranges::copy(force, f.begin()); }, held_below(solid)},
        "test");
    Dynamics dynamics(solid, held_below(solid), {.rayleigh_mass = 20, .rayleigh_stiffness = 0.02}, "test");
    for (int step = 0; step < 200; ++step) {
      dynamics.start_step(0.03);
      dynamics.solve(force, 30, 1e-12);
      dynamics.finish_step();
    }
    double off = 0, moved = 0;
    for (std::size_t i = 0; i < rest.x.size(); ++i) {
      off = std::max(off, (dynamics.position()[i] - rest.x[i]).norm());
      moved = std::max(moved, (rest.x[i] - solid.rest()[i]).norm());
    }
    CAPTURE(static_cast<int>(law), moved);
    CHECK(moved > 0.1 * kSide);
    CHECK(off < 1e-6 * moved);
  }
}

TEST_CASE("dynamics: a quasi-Newton step answers what it learned last, and on a quadratic soon everything") {
  const Solid solid(small_block(), soft());
  const FreeDofs dofs(held_below(solid));
  const NewtonMatrix matrix(solid, dofs, {}, "test");
  // Another matrix than the one it begins from: A + a diagonal.
  StiffnessMatrix k = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), k);
  const Eigen::VectorXd more = 10 * Eigen::VectorXd::Random(dofs.count).cwiseAbs();
  const auto times = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
    return k.lower().selfadjointView<Eigen::Lower>() * v + more.cwiseProduct(v);
  };
  QuasiNewton method;
  const Eigen::VectorXd load = Eigen::VectorXd::Random(dofs.count);
  Eigen::VectorXd place = Eigen::VectorXd::Zero(dofs.count), before = place;
  double first = 0, remaining = 0;
  for (int i = 0; i < 12; ++i) {
    const Eigen::VectorXd resistance = times(place);
    method.add_point(place, resistance);
    if (i > 0) {  // the secant equation
      const Eigen::VectorXd change = times(place - before);
      CHECK((method.direction(matrix, change) - (place - before)).norm() <
            1e-9 * (place - before).norm() + 1e-12 * place.norm());
    }
    remaining = (load - resistance).norm();
    if (i == 1) first = remaining;
    before = place;
    place += method.direction(matrix, load - resistance);
  }
  CAPTURE(first, remaining);
  CHECK(remaining < 1e-3 * first);  // the old matrix alone would take 0.3 of it off a step, at most
  method.clear();
  CHECK((method.direction(matrix, load) - matrix.solve(load)).norm() == 0);
}

TEST_CASE("dynamics: solved with a factor of the background, a step ends where a direct one does",
          "[threads]") {
  const Solid solid(small_block(), soft(ElasticLaw::kCorotational));
  using Solver = DynamicsSettings::Solver;
  std::vector<std::vector<Vec3>> ends;
  for (const Solver solver : {Solver::kDirect, Solver::kQuasiNewton}) {
    for (const bool second : {false, true}) {
      Dynamics dynamics(solid, held_below(solid), {2, 0, second, solver, 3}, "test");
      int polls = 0;
      for (int step = 0; step < 20; ++step) {  // bends far, so that a factor of before is of another place
        dynamics.start_step(0.02);
        polls += dynamics.solve(pull(solid, Vec3(0.1 * std::min(step, 10), 0, 0)), 100, 1e-10);
        dynamics.finish_step();
      }
      CAPTURE(static_cast<int>(solver), second);
      CHECK(polls < 20 * 30);
      ends.emplace_back(dynamics.position().begin(), dynamics.position().end());
    }
  }
  for (std::size_t run = 2; run < ends.size(); ++run) {
    double off = 0, moved = 0;
    for (std::size_t i = 0; i < ends[run].size(); ++i) {
      off = std::max(off, (ends[run][i] - ends[run % 2][i]).norm());
      moved = std::max(moved, (ends[run][i] - solid.rest()[i]).norm());
    }
    CAPTURE(run, off, moved);
    CHECK(moved > 0.1 * kSide);
    CHECK(off < 1e-7 * moved);
  }
}

TEST_CASE("dynamics: backward Euler never makes energy, whatever the law and the step") {
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    const Solid solid(small_block(), soft(law));
    Dynamics dynamics(solid, held_below(solid), {}, "test");
    const std::vector<Vec3> force = pull(solid, Vec3(0.8, 0.4, 0)), none(force.size(), Vec3::Zero());
    double before = 1e9;
    for (int step = 0; step < 60; ++step) {
      dynamics.start_step(0.02);
      dynamics.solve(step < 10 ? force : none, 40, 1e-10);
      dynamics.finish_step();
      if (step < 10) continue;
      const double energy = solid.energy(dynamics.position()) + dynamics.kinetic_energy();
      CHECK(energy <= before * (1 + 1e-9));
      before = energy;
    }
  }
}

TEST_CASE("dynamics: a strain that is held relaxes along its Prony series, under every law") {
  const std::vector<Relaxation> relaxations{{0.3, 0.2}, {0.25, 1.5}};
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff,
                               ElasticLaw::kNeoHookean}) {
    Material light = soft(law, relaxations);
    light.density = 1e-8;  // so that the one free node does not lag behind
    const Solid solid(small_block(), light);
    std::vector<HeldAxes> held(solid.rest().size(), kAllAxes);
    held[13] = 0;  // the one in the middle, which goes with the strain by itself
    Dynamics dynamics(solid, held, {}, "test");
    const std::vector<Vec3> none(held.size(), Vec3::Zero());
    const Mat3 stretch = (Mat3() << 1.1, 0.1, 0, 0, 0.95, 0, 0, 0.05, 1).finished();
    std::vector<Vec3> f(held.size()), at_once(held.size());
    const double h = 0.05;
    for (int step = 1; step <= 60; ++step) {
      dynamics.start_step(h);
      for (std::size_t i = 0; i < held.size(); ++i)
        dynamics.mutable_position()[i] = stretch * solid.rest()[i];
      dynamics.solve(none, 5, 1e-12);
      dynamics.finish_step();
      // The strain comes within the first step, evenly: each term has relaxed by gamma when it ends.
      double fraction = 1;
      for (const auto& [part, time] : relaxations)
        fraction += part * (std::exp(-(step - 1) * h / time) * (1 - std::exp(-h / time)) * time / h - 1);
      dynamics.internal_forces(f);
      solid.forces(dynamics.position(), at_once);
      REQUIRE((f[0] - fraction * at_once[0]).norm() < 1e-9 * at_once[0].norm());
    }
    CHECK((f[0].norm() / at_once[0].norm()) == Approx(0.45 + 0.25 * std::exp(-3 / 1.5)).epsilon(0.02));
  }
}

TEST_CASE("dynamics: rounding that no factor makes less is no reason to factor at every step") {
  // Loaded, and at rest far from the origin, where places have fewer digits than forces that are none.
  for (const bool loaded : {true, false}) {
    CAPTURE(loaded);
    TetMesh mesh = grid_block(lines(0, 0.02, 2), lines(0, 0.02, 2), lines(0, 0.02, 2));
    for (Vec3& x : mesh.vertices) x[0] += loaded ? 0 : 10;
    const Solid solid(with_nodes(std::move(mesh), ElementKind::kQuadratic),
                      {.young_modulus = 1e4,
                       .poisson_ratio = 0.45,
                       .law = ElasticLaw::kCorotational,
                       .element = ElementKind::kQuadratic});
    Dynamics dynamics(solid, held_below(solid), {.rayleigh_mass = 10}, "test");
    std::vector<Vec3> force(solid.rest().size(), Vec3::Zero());
    if (loaded) force.back() = Vec3(0, 1e-3, 1e-3);
    constexpr double kNever = 1e-17;
    int before = 0;
    for (int i = 0; i < 50; ++i) {
      if (i == 40) before = dynamics.factor().count();
      dynamics.start_step(0.05);
      const int polls = dynamics.solve(force, 60, kNever);
      if (i >= 40) CHECK(polls < 3);
      dynamics.finish_step();
    }
    CHECK(dynamics.factor().count() == before);
  }
}

TEST_CASE("dynamics: a move without a line search that led far from balance is taken back") {
  const Solid solid(grid_block(lines(0, 0.2, 16), lines(0, 0.02, 2), lines(0, 0.02, 2)),
                    {5e3, 0.45, 1060, ElasticLaw::kCorotational});
  std::vector<HeldAxes> held;
  for (const Vec3& x : solid.rest()) held.push_back(x[0] == 0 ? kAllAxes : 0);
  for (const auto solver : {DynamicsSettings::Solver::kDirect, DynamicsSettings::Solver::kQuasiNewton}) {
    Dynamics dynamics(solid, held, {.rayleigh_mass = 1, .rayleigh_stiffness = 0.01, .solver = solver},
                      "test");
    double worst = 0;
    for (int step = 0; step < 60; ++step) {  // gravity turns about, once in 0.8 s: the bar goes by its length
      const double angle = 2 * std::numbers::pi * step / 40;
      const Vec3 gravity = 5 * Vec3(std::sin(angle), 0.3 * std::sin(angle), 1 - std::cos(angle));
      std::vector<Vec3> weight;
      for (const double mass : solid.masses()) weight.emplace_back(mass * gravity);
      dynamics.start_step(0.02);
      double before = 1, remaining = dynamics.iterate(weight, 1e-5);
      for (int i = 0; i < 100 && remaining > 1e-5; ++i) {
        before = remaining;
        remaining = dynamics.iterate(weight, 1e-5);
        if (before <= 0.1) worst = std::max(worst, remaining);  // 0.1: what is trusted
      }
      CHECK(remaining <= 1e-5);
      dynamics.finish_step();
    }
    CHECK(worst < 0.5);
  }
}
