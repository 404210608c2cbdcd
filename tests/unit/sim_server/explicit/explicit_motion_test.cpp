// Tensors and explicit motion against dense modes and closed forms of the discrete oscillator: a mode of
// frequency w goes on by q'' = (t q' - a q), t = 1 + a - h^2 w^2, a = 1 - h (mass + stiffness w^2).
#include "sim_server/explicit/explicit_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim_server/mesh/shapes.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/dense_tissue.h"
#include "tests/support/random.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr RayleighDamping kUndamped{0, 0};

const Material kSoft{5e3, 0.45, 1060};
const std::vector<double> kNone(3 * 24, 0.0);  // forces

/// A small block of uneven tetrahedra, held at its bottom.
struct Tissue {
  TetMesh mesh = grid_block({0, 0.011, 0.02, 0.034}, {0, 0.01, 0.022}, {0, 0.012, 0.025});
  ElasticTensors tensors = make();
  test::DenseTissue dense{mesh, kSoft, tensors};

  ElasticTensors make() const {
    std::vector<int> fixed;
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
      if (mesh.vertices[v][2] == 0) fixed.push_back(v);
    }
    return {mesh, kSoft, fixed};
  }
};

Eigen::Map<const Eigen::VectorXd> as_vector(const std::vector<double>& x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

void start_in(ExplicitMotion& motion, const Eigen::VectorXd& u) {
  std::ranges::copy(u, motion.state.u.begin());
}

/// t and a of the recursion, by least squares over a run in one mode.
struct Recursion {
  double t, a, strayed;  // strayed: how much of the motion was not in the mode, of its size
};
Recursion watch(const Tissue& tissue, int mode, const RayleighDamping& damping, double h, int steps) {
  ExplicitMotion motion(tissue.tensors, damping);
  const Eigen::VectorXd shape = tissue.dense.modes.col(mode),
                        weighted = tissue.dense.mass.cwiseProduct(shape);
  start_in(motion, shape);
  std::vector<double> q{1};
  double strayed = 0;
  for (int i = 0; i < steps; ++i) {
    motion.run(1, h, kNone);
    const auto u = as_vector(motion.state.u);
    q.push_back(weighted.dot(u));
    strayed = std::max(strayed, (u - q.back() * shape).norm() / shape.norm());
  }
  Eigen::MatrixXd before(steps - 1, 2);
  Eigen::VectorXd after(steps - 1);
  for (int i = 1; i < steps; ++i) {
    before.row(i - 1) << q[i], -q[i - 1];
    after[i - 1] = q[i + 1];
  }
  const Eigen::Vector2d found = test::solve_least(before, after);
  return {found[0], found[1], strayed};
}

/// Kinetic and elastic energy, J.
double energy(const Tissue& tissue, const ExplicitMotion& motion) {
  const auto u = as_vector(motion.state.u), v = as_vector(motion.state.v);
  return 0.5 * v.dot(tissue.dense.mass.cwiseProduct(v)) + 0.5 * u.dot(tissue.dense.stiffness * u);
}

/// What symplectic Euler keeps to the last bit but rounding: 1/2 v M v + 1/2 u K (u - h v).
double stored_energy(const Tissue& tissue, const ExplicitMotion& motion, double h) {
  const auto u = as_vector(motion.state.u), v = as_vector(motion.state.v);
  return 0.5 * v.dot(tissue.dense.mass.cwiseProduct(v)) + 0.5 * u.dot(tissue.dense.stiffness * (u - h * v));
}

}  // namespace

TEST_CASE("ExplicitMotion: a force that is added to the last sub-step did what it would have done in it") {
  const Tissue tissue;
  constexpr int kPlace = 5;
  constexpr double kStep = 1e-4;  // s
  const Vec3 force(0.02, -0.05, 0.01);
  ExplicitMotion within(tissue.tensors, {3, 2e-4}), added(tissue.tensors, {3, 2e-4});
  for (ExplicitMotion* const motion : {&within, &added}) {
    start_in(*motion, tissue.dense.modes.col(2));
    for (int i = 0; i < 5; ++i) motion->run(kStep);
  }
  Eigen::Map<Vec3>(within.state.f.data() + 3 * kPlace) = force;
  within.run(kStep);
  const ExplicitMotion::State begin = added.state;
  ExplicitMotion::State before = added.state;
  added.run_free(before, kStep);
  CHECK(before.u == begin.u);
  CHECK(before.v == begin.v);
  added.add_to_last(kPlace, kStep, force);
  const auto check_same = [&] {
    for (const auto& [a, b] :
         {std::pair(&within.state.u, &added.state.u), std::pair(&within.state.v, &added.state.v),
          std::pair(&within.state.f, &added.state.f)}) {
      CHECK((as_vector(*a) - as_vector(*b)).norm() <= 1e-14 * as_vector(*a).norm());
    }
  };
  check_same();
  CHECK(as_vector(added.state.f).norm() == Approx(force.norm()));
  std::ranges::fill(within.state.f, 0.0);
  within.run(kStep);
  added.run_free(before, kStep);
  check_same();
}

TEST_CASE("tensors: the product is that of the dense stiffness, also eight at once") {
  const Tissue tissue;
  const auto n = static_cast<std::size_t>(3 * tissue.tensors.vertices());
  CHECK(tissue.tensors.bytes() == 76 * static_cast<std::size_t>(tissue.tensors.edges()) + 52 * n / 3 +
                                      sizeof(int) + sizeof(double));  // that a product reads beyond the last
  CHECK(
      (as_vector(tissue.tensors.masses()) - Eigen::VectorXd(tissue.dense.mass(Eigen::seq(0, Eigen::last, 3))))
          .norm() < 1e-15);
  constexpr std::size_t kWide = ElasticTensors::kWide;
  test::Random random(3);
  std::vector<double> wide(n * kWide), wide_force(n * kWide), x(n), force(n);
  for (double& value : wide) value = random.between(-1, 1);
  tissue.tensors.multiply_wide(wide.data(), wide_force.data());
  for (std::size_t c = 0; c < kWide; ++c) {
    for (std::size_t k = 0; k < n; ++k) x[k] = wide[k * kWide + c];
    tissue.tensors.multiply(x.data(), force.data());
    const Eigen::VectorXd expected = tissue.dense.stiffness * as_vector(x);
    CHECK((as_vector(force) - expected).norm() < 1e-14 * expected.norm());
    for (std::size_t k = 0; k < n; ++k) force[k] = wide_force[k * kWide + c];
    CHECK((as_vector(force) - expected).norm() < 1e-14 * expected.norm());
  }
}

TEST_CASE("explicit motion: the highest frequency, and the sub-step at which a mode becomes unstable") {
  const Tissue tissue;
  const double highest = tissue.dense.highest(), found = highest_frequency(tissue.tensors);
  CHECK(found <= highest * (1 + 1e-12));
  CHECK(found > highest * 0.999);
  CHECK(longest_sub_step(highest, kUndamped) == Approx(2 / highest).epsilon(1e-14));
  for (const RayleighDamping damping :
       {kUndamped, RayleighDamping{50, 0}, RayleighDamping{0, 1e-4}, RayleighDamping{200, 2e-3}}) {
    const double limit = longest_sub_step(highest, damping);
    for (const double fraction : {0.999, 1.001}) {
      ExplicitMotion motion(tissue.tensors, damping);
      start_in(motion, tissue.dense.modes.rightCols<1>());
      for (int i = 0; i < 20000; ++i) motion.run(1, fraction * limit, kNone);
      const double grown = as_vector(motion.state.u).norm() / tissue.dense.modes.rightCols<1>().norm();
      CHECK((fraction < 1 ? grown < 100 : !(grown < 1e3)));
    }
  }
}

TEST_CASE("explicit motion: unstable at 1.3 times the undamped limit") {
  const Tissue tissue;
  ExplicitMotion motion(tissue.tensors, kUndamped);
  start_in(motion, Eigen::VectorXd::Constant(tissue.dense.mass.size(), 1e-3));
  for (int i = 0; i < 100; ++i) motion.run(1, 1.3 * 2 / tissue.dense.highest(), kNone);
  CHECK_FALSE(as_vector(motion.state.u).norm() < 1e10);
}

TEST_CASE("explicit motion: frequencies of free vibration are those of the dense eigenproblem") {
  const Tissue tissue;
  const double h = 0.05 / tissue.dense.highest();
  for (const int mode : {0, 1, 2, 5, 20, 40, static_cast<int>(tissue.dense.mass.size()) - 1}) {
    const double w = std::sqrt(tissue.dense.squares[mode]);
    const Recursion found = watch(tissue, mode, kUndamped, h, 4000);
    CHECK(found.strayed < 1e-9);
    CHECK(found.a == Approx(1).epsilon(1e-12));
    CHECK(std::acos(found.t / 2) / h == Approx(w).epsilon(2e-4));                     // the tissue's
    CHECK(std::acos(found.t / 2) == Approx(2 * std::asin(h * w / 2)).epsilon(1e-7));  // the method's
  }
}

TEST_CASE("explicit motion: a mode decays by half of mass + stiffness w^2") {
  const Tissue tissue;
  const double h = 0.05 / tissue.dense.highest();
  const RayleighDamping damping{30, 2e-4};
  for (const int mode : {0, 3, 20}) {
    const double square = tissue.dense.squares[mode], expected = (30 + 2e-4 * square) / 2;
    const Recursion found = watch(tissue, mode, damping, h, 4000);
    CHECK(found.strayed < 1e-9);
    CHECK(found.a == Approx(1 - 2 * h * expected).epsilon(1e-10));
    CHECK(-std::log(found.a) / (2 * h) == Approx(expected).epsilon(0.01));
  }
}

TEST_CASE("explicit motion: energy stays without damping over 1e4 sub-steps, and falls with it") {
  const Tissue tissue;
  const double h = 0.95 * longest_sub_step(tissue.dense.highest(), kUndamped);
  ExplicitMotion motion(tissue.tensors, kUndamped);
  test::Random random(5);
  for (double& u : motion.state.u) u = random.between(-1e-3, 1e-3);
  const double stored = stored_energy(tissue, motion, h), first = energy(tissue, motion);
  double most = 0;
  for (int i = 0; i < 10000; ++i) {
    motion.run(1, h, kNone);
    most = std::max(most, energy(tissue, motion));
  }
  CHECK(stored_energy(tissue, motion, h) == Approx(stored).epsilon(1e-10));
  CHECK(most < first * (1 + 0.95) / (1 - 0.95));  // h w / 2 = 0.95 for the worst mode

  const RayleighDamping damping{20, 1e-4};
  ExplicitMotion damped(tissue.tensors, damping);
  damped.state.u = motion.state.u;
  double before = energy(tissue, damped);
  for (int i = 0; i < 20; ++i) {
    damped.run(500, 0.95 * longest_sub_step(tissue.dense.highest(), damping), kNone);
    const double now = energy(tissue, damped);
    CHECK(now < before);
    before = now;
  }
}

TEST_CASE(
    "explicit motion: a force held for a time t gives each mode f / w^2 (1 - cos w t), never less than 0") {
  const Tissue tissue;
  const double h = 0.95 * longest_sub_step(tissue.dense.highest(), kUndamped);
  for (const int steps : {1, 2, 7, 50}) {
    for (int mode = 0; mode < tissue.dense.mass.size(); ++mode) {
      ExplicitMotion motion(tissue.tensors, kUndamped);
      const Eigen::VectorXd shape = tissue.dense.modes.col(mode),
                            force = tissue.dense.mass.cwiseProduct(shape);
      motion.run(steps, h, {force.begin(), force.end()});
      const double square = tissue.dense.squares[mode];
      // With the method's own frequency the closed form is exact.
      const double phase = steps * 2 * std::asin(h * std::sqrt(square) / 2);
      CHECK(force.dot(as_vector(motion.state.u)) * square == Approx(1 - std::cos(phase)).margin(1e-9));
    }
  }
}

TEST_CASE(
    "explicit motion: one sub-step is half an acceleration, two runs are one, rest under a load is rest") {
  const Tissue tissue;
  const double h = 0.9 * longest_sub_step(tissue.dense.highest(), kUndamped);
  ExplicitMotion once(tissue.tensors, kUndamped), twice(tissue.tensors, kUndamped);
  std::vector<double> force = kNone;
  force[4] = 0.1;
  once.run(1, h, force);
  CHECK(once.state.u[4] == Approx(0.5 * h * h * 0.1 / tissue.dense.mass[4]).epsilon(1e-12));
  once.run(1, h, force);
  twice.run(2, h, force);
  CHECK((as_vector(once.state.u) - as_vector(twice.state.u)).norm() < 1e-14 * as_vector(once.state.u).norm());

  ExplicitMotion resting(tissue.tensors, {20, 1e-5});
  const Eigen::VectorXd still = test::solve_definite(tissue.dense.stiffness, as_vector(force));
  start_in(resting, still);
  resting.state.f = force;
  for (int i = 0; i < 20; ++i) resting.run(10, 0.5 * h, force);
  CHECK((as_vector(resting.state.u) - still).norm() < 1e-11 * still.norm());
}

TEST_CASE("explicit motion: sub-steps do not allocate") {
  const Tissue tissue;
  ExplicitMotion motion(tissue.tensors, {20, 1e-4}), wide(tissue.tensors, {20, 1e-4}, ElasticTensors::kWide);
  const std::vector<double> none = wide.state.f;
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    motion.run(10, 1e-5, kNone);
    wide.run(10, 1e-5, none);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}

TEST_CASE("ExplicitMotion: a large body moves the same, to the last bit, by one thread, two and four",
          "[threads]") {
  const TetMesh mesh = test::soft_block(Vec3(0.04, 0.04, 0.04), {24, 24, 24});
  const ElasticTensors tensors(mesh, kSoft, {0, 1, 2});
  REQUIRE(tensors.room_ahead().size() > 1);
  std::vector<ExplicitMotion::State> ends;
  for (const int threads : {1, 2, 4}) {
    ExplicitMotion motion(tensors, {3, 2e-4}, 1, threads);
    std::minstd_rand random(7);
    for (double& x : motion.state.u) x = 1e-3 * static_cast<double>(random()) / std::minstd_rand::max();
    ExplicitMotion::State before = motion.state;
    for (int i = 0; i < 10; ++i) {
      motion.run(1e-4);
      motion.run_free(before, 1e-4);
    }
    ends.push_back(motion.state);
  }
  for (const ExplicitMotion::State& end : ends) {
    CHECK(end.u == ends[0].u);
    CHECK(end.v == ends[0].v);
  }
  CHECK(std::ranges::count(ends[0].v, 0.0) == 0);
}

TEST_CASE("ExplicitMotion: a sub-step that begins before the last kicks ends as one that begins after them",
          "[threads]") {
  const TetMesh mesh = test::soft_block(Vec3(0.04, 0.04, 0.04), {24, 24, 24});
  const ElasticTensors tensors(mesh, kSoft, {0, 1, 2});
  REQUIRE(tensors.parts() > 1);
  constexpr double kStep = 1e-4;  // s
  const int vertices = tensors.vertices();
  // Rounds of kicks: of some vertices, of one twice, of more than there is room for, and of none.
  const auto kick_round = [&](ExplicitMotion& motion, int round) {
    const int kicks = std::array{40, 2, vertices + 20, 0}[static_cast<std::size_t>(round % 4)];
    for (int k = 0; k < kicks; ++k) {
      const int place = kicks == 2 ? vertices / 2 : (k * 37 + 11 * round) % vertices;
      motion.add_impulse(place, kStep, Vec3(0.01 * std::cos(k), 0.02, -0.01 * round));
    }
  };
  const auto moved = [&](int threads, bool begins, bool drops) {
    ExplicitMotion motion(tensors, {3, 2e-4}, 1, threads);
    motion.run(kStep);
    for (int round = 0; round < 12; ++round) {
      if (begins) motion.start_next();
      kick_round(motion, round);
      if (drops) motion.drop_next();
      round == 9 ? motion.run(kStep) : motion.run_on(kStep);
    }
    return motion.state;
  };
  const ExplicitMotion::State after = moved(1, false, false), begun = moved(1, true, false);
  const auto off = [](const std::vector<double>& a, const std::vector<double>& b) {
    return (as_vector(a) - as_vector(b)).norm() / as_vector(b).norm();
  };
  CHECK(as_vector(after.u).norm() > 0);
  CHECK(off(begun.u, after.u) < 1e-12);
  CHECK(off(begun.v, after.v) < 1e-12);
  for (const int threads : {1, 2, 4}) {
    CHECK(moved(threads, true, false).v == begun.v);
    CHECK(moved(threads, true, true).v == after.v);
  }
  for (int end = 0; end < 20; ++end) {  // while helpers are at it
    ExplicitMotion motion(tensors, {3, 2e-4}, 1, 2);
    motion.start_next();
  }
}
