// The reduced model against a dense solution of the same tissue: slow modes in motion, the rest at once.
#include "sim_server/models/reduced.h"

#include "common/error.h"
#include "sim_server/models/quasi_static.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/statics/linear_statics.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/stiffness.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kPeriod = 1.0 / 30;

struct Bench {
  TetMesh mesh = grid_block(lines(-0.02, 0.02, 4), lines(-0.016, 0, 3), lines(-0.02, 0.02, 3));
  Surface surface = boundary_surface(mesh);
  Scene scene =
      scene_of({.young_modulus = 8e3, .poisson_ratio = 0.4}, {Vec3(-1, -1, -1), Vec3(1, -0.0159, 1)}, 0.005);
  std::vector<int> fixed, reachable;

  explicit Bench(int modes) {
    scene.rate_hz = 1 / kPeriod;
    scene.deformation.model = "reduced";
    scene.deformation.of<ReducedSettings>().modes = modes;
    scene.deformation.of<RayleighDamping>().mass = 6;
    scene.deformation.of<RayleighDamping>().stiffness =
        2e-3;  // the quick modes are overdamped, the slow ones swing
    fixed = fixed_vertices(scene, mesh);
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) reachable.push_back(v);
  }
  ModelInputs inputs() const { return {scene, mesh, surface, fixed, reachable, kSilent}; }
};

/// All modes by a dense solver, and exact motion of each in many small steps of the trapezoidal rule.
struct Dense {
  FreeDofs dofs;
  Eigen::VectorXd squares;
  Eigen::MatrixXd modes;

  explicit Dense(const Bench& bench) : dofs(static_cast<int>(bench.mesh.vertices.size()), bench.fixed) {
    const Solid solid(bench.mesh, *bench.scene.material);
    const std::vector<double> masses = solid.masses();
    Eigen::VectorXd m(dofs.count);
    for (std::size_t i = 0; i < masses.size(); ++i) {
      if (dofs.first[i] >= 0) m.segment<3>(dofs.first[i]).setConstant(masses[i]);
    }
    const test::DenseModes dense = test::dense_modes(dense_stiffness(solid, dofs), m);
    squares = dense.squares;
    modes = dense.shapes;
  }
};

}  // namespace

TEST_CASE("reduced: modes and frequencies are those of a dense eigen-solver") {
  const Bench bench(12);
  const Dense dense(bench);
  const ModelInputs inputs = bench.inputs();  // which statics looks at again
  const LinearStatics statics(inputs);
  const VibrationModes modes = vibration_modes(statics.factor(), statics.masses(), 12, "test");
  const Eigen::VectorXd masses = statics.masses();
  for (int k = 0; k < 12; ++k) {
    CHECK(modes.frequencies[k] == Approx(std::sqrt(dense.squares[k])).epsilon(1e-8));
    for (int j = 0; j <= k; ++j) {
      const double product = modes.shapes.col(k).dot(masses.cwiseProduct(modes.shapes.col(j)));
      CHECK(std::abs(product - (j == k ? 1 : 0)) < 1e-9);
    }
  }
  CHECK_THROWS_AS(vibration_modes(statics.factor(), masses, static_cast<int>(masses.size()), "test"), Error);
}

TEST_CASE("modes of a body that was almost this one are refined to those that a dense eigen-solver finds") {
  const Bench bench(12);
  const ModelInputs inputs = bench.inputs();
  const LinearStatics statics(inputs);
  const Eigen::VectorXd masses = statics.masses();
  Eigen::VectorXd others = masses;  // heavier by up to a third on one side
  for (Eigen::Index i = 0; i < others.size(); ++i)
    others[i] *= 1 + static_cast<double>(i) / (3.0 * static_cast<double>(others.size()));
  const VibrationModes before = vibration_modes(statics.factor(), masses, 12, "test");
  const VibrationModes modes = refined_modes(statics.factor(), others, before.shapes).value();
  const Eigen::MatrixXd dense = Eigen::MatrixXd(statics.stiffness.lower()).selfadjointView<Eigen::Lower>();
  const test::DenseModes right = test::dense_modes(dense, others);
  double change = 0;
  for (int k = 0; k < 12; ++k) {
    const double frequency = std::sqrt(right.squares[k]);
    CHECK(modes.frequencies[k] == Approx(frequency).epsilon(k < 10 ? 1e-3 : 5e-3));  // the last ones lag
    change = std::max(change, std::abs(before.frequencies[k] / frequency - 1));
    for (int j = 0; j <= k; ++j) {
      const double product = modes.shapes.col(k).dot(others.cwiseProduct(modes.shapes.col(j)));
      CHECK(std::abs(product - (j == k ? 1 : 0)) < 1e-9);
    }
  }
  CHECK(change > 0.05);
  Eigen::MatrixXd without = before.shapes;
  without.col(3).setZero();  // what moved in it alone is cut away
  CHECK_FALSE(refined_modes(statics.factor(), others, without).has_value());
}

TEST_CASE("reduced: slow modes move as they do by themselves, all the rest stands where statics put it") {
  for (const int count : {5, 30}) {
    const Bench bench(count);
    const Dense dense(bench);
    Reduced model(bench.inputs());
    const int pressed = *std::ranges::find_if(
        bench.reachable, [&](int v) { return bench.mesh.vertices[bench.surface.vertices[v]][1] == 0; });
    const int node = bench.surface.vertices[pressed];
    Eigen::VectorXd q = Eigen::VectorXd::Zero(dense.squares.size()), v = q;
    double peak = 0, off = 0;
    for (int step = 0; step < 12; ++step) {
      const Vec3 force = step < 6 ? Vec3(0.02, -0.05 - 0.01 * step, 0.01) : Vec3(Vec3::Zero());
      model.free_motion(kPeriod);
      const std::span<const Vec3> moved = model.apply(std::vector<VertexLoad>{{pressed, force}});
      // Each mode for itself, in steps far shorter than it takes.
      const Eigen::VectorXd p = dense.modes.middleRows<3>(dense.dofs.first[node]).transpose() * force;
      for (Eigen::Index k = 0; k < q.size(); ++k) {
        const double w2 = dense.squares[k], d = 6 + 2e-3 * w2;
        if (k >= count) {
          q[k] = p[k] / w2;
          continue;
        }
        constexpr int kParts = 20000;
        const double h = kPeriod / kParts;
        for (int part = 0; part < kParts; ++part) {
          const double a =
              (p[k] - w2 * (q[k] + 0.5 * h * v[k]) - d * v[k]) / (1 + 0.5 * h * d + 0.25 * h * h * w2);
          q[k] += h * v[k] + 0.5 * h * h * a;
          v[k] += h * a;
        }
      }
      const Eigen::VectorXd u = dense.modes * q;
      for (std::size_t i = 0; i < moved.size(); ++i) {
        const int first = dense.dofs.first[bench.surface.vertices[i]];
        if (first < 0) continue;
        const Vec3 way = moved[i] - bench.mesh.vertices[bench.surface.vertices[i]];
        peak = std::max(peak, way.norm());
        off = std::max(off, (way - u.segment<3>(first)).norm());
      }
    }
    CAPTURE(count, peak, off);
    CHECK(peak > 1e-4);
    CHECK(off < 1e-6 * peak);
  }
}

TEST_CASE("reduced: under a load that stays it comes to rest where quasi_static is, whatever the modes") {
  const Bench bench(3);
  Reduced model(bench.inputs());
  QuasiStatic statics(bench.inputs());
  const std::vector<VertexLoad> loads{{bench.reachable[7], Vec3(0.02, -0.05, 0.01)},
                                      {bench.reachable.back(), Vec3(0, 0.03, 0)}};
  std::span<const Vec3> moved;
  for (int step = 0; step < 300; ++step) {
    model.free_motion(kPeriod);
    moved = model.apply(loads);
  }
  const std::span<const Vec3> expected = statics.apply(loads);
  for (std::size_t i = 0; i < moved.size(); ++i) CHECK((moved[i] - expected[i]).norm() < 1e-12);
}
