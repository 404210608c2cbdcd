// How tissues follow supports that move, without a tool: against closed forms and dense solutions.
#include "sim_server/statics/moving_supports.h"

#include <algorithm>
#include <array>
#include <complex>
#include <numbers>

#include "common/error.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/implicit.h"
#include "sim_server/models/reduced.h"
#include "sim_server/scene/loads.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/solvers/equilibrium.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/dense_tissue.h"
#include "tests/support/one_free_vertex.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

using Complex = std::complex<double>;

constexpr double kTau = 2 * std::numbers::pi;
constexpr std::array kCells{6, 3, 6};

double way_of(const SupportMotion& motion, double t) {
  return motion.amplitude * std::sin(kTau * t / motion.period + motion.phase);
}

/// Of these, the models that this build has.
std::vector<std::string_view> built(std::initializer_list<std::string_view> names) {
  std::vector<std::string_view> all;
  for (const DeformationModelRow& row : models_without_cutting()) {
    if (std::ranges::find(names, row.name) != names.end()) all.push_back(row.name);
  }
  return all;
}

/// A model without a simulation, its tools able to reach everything.
struct Bench {
  TetMesh mesh;
  Surface surface = boundary_surface(mesh);
  std::vector<int> fixed, reachable;
  std::unique_ptr<DeformationModel> model;

  Bench(const Scene& scene, TetMesh of)
      : mesh(with_nodes(std::move(of), scene.material->element)), fixed(fixed_vertices(scene, mesh)) {
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) reachable.push_back(v);
    for (const DeformationModelRow& row : models_without_cutting()) {
      if (row.name == scene.deformation.model)
        model = row.make({scene, mesh, surface, fixed, reachable, kSilent});
    }
  }
  const Vec3& at(std::size_t v) const { return mesh.vertices[surface.vertices[v]]; }
};

/// That vertex shaken along its softest direction, on a base that moves.
struct Oscillator : OneFreeVertex {
  explicit Oscillator(std::string_view model) {
    scene.deformation.model = model;
    scene.deformation.of<RayleighDamping>().mass = 0.2 * frequency;
    scene.deformation.of<RayleighDamping>().stiffness = 0.3 / frequency;
    scene.deformation.of<ReducedSettings>().modes = 1;
  }
  /// All that is fixed, at `ratio` of the frequency.
  const SupportMotion& shake(double ratio) {
    for (FixedRegion& region : scene.fixed)
      region.motions = {{direction, 0.002, kTau / (ratio * frequency), 0.4}};
    return scene.fixed[0].motions[0];
  }
  /// Where the steady oscillation of the vertex is, and how fast, along the direction: per amplitude
  ///   w0^2 (1 + i w beta) / (w0^2 - w^2 + i w (alpha + beta w0^2)).
  std::pair<double, double> exact(double t) const {
    const SupportMotion& motion = scene.fixed[0].motions[0];
    const double w = kTau / motion.period, w0 = frequency,
                 alpha = scene.deformation.of<RayleighDamping>().mass,
                 beta = scene.deformation.of<RayleighDamping>().stiffness;
    const Complex answer =
        w0 * w0 * Complex(1, w * beta) / Complex(w0 * w0 - w * w, w * (alpha + beta * w0 * w0));
    const Complex turned = motion.amplitude * answer * std::polar(1.0, w * t + motion.phase);
    return {turned.imag(), w * turned.real()};
  }
};

}  // namespace

TEST_CASE("moving supports: one free vertex swings as a damped oscillator on a shaken base, to rounding") {
  for (const std::string_view model : built({"tensor_mass", "reduced"})) {
    for (const double ratio : {0.01, 0.5, 1.0, 1.7}) {
      Oscillator one(model);
      const SupportMotion& motion = one.shake(ratio);
      one.scene.rate_hz = 7.3 / motion.period;
      const Bench bench(one.scene, one.mesh);
      for (int step = 0; step < 25; ++step) {
        const FreeMotion moved = bench.model->free_motion(step == 0 ? 0 : 1 / one.scene.rate_hz);
        const auto [way, speed] = one.exact(step / one.scene.rate_hz);
        for (std::size_t v = 0; v < moved.positions.size(); ++v) {
          if (bench.surface.vertices[v] != one.vertex) continue;
          CAPTURE(model, ratio, step);
          REQUIRE((moved.positions[v] - bench.at(v) - way * one.direction).norm() < 1e-12);
          REQUIRE((moved.velocities[v] - speed * one.direction).norm() <
                  1e-9 * motion.amplitude * kTau / motion.period);
        }
      }
    }
  }
}

TEST_CASE("moving supports: implicit steps come to the oscillator, of first order and, by BDF2, of second") {
  const auto error = [](double ratio, int per_period, bool second) {
    Oscillator one("implicit");
    one.scene.rate_hz = per_period / one.shake(ratio).period;
    one.scene.deformation.of<ImplicitSettings>().second_order = second;
    const Bench bench(one.scene, one.mesh);
    double most = 0;
    for (int step = 1; step <= 13 * per_period; ++step) {
      const FreeMotion moved = bench.model->free_motion(1 / one.scene.rate_hz);
      if (step <= 12 * per_period) continue;  // what swung in at the start has faded
      for (std::size_t v = 0; v < moved.positions.size(); ++v) {
        if (bench.surface.vertices[v] != one.vertex) continue;
        const double way = one.exact(step / one.scene.rate_hz).first;
        most = std::max(most, (moved.positions[v] - bench.at(v) - way * one.direction).norm());
      }
    }
    return most / 0.002;
  };
  for (const double ratio : {0.6, 1.0}) {
    CAPTURE(ratio);
    CHECK(error(ratio, 400, false) / error(ratio, 800, false) == Approx(2).margin(0.1));
    CHECK(error(ratio, 200, true) / error(ratio, 400, true) == Approx(4).margin(0.3));
    CHECK(error(ratio, 400, true) < 1e-3);
  }
}

TEST_CASE("moving supports: a whole block swings as a dense complex solution says") {
  for (const std::string_view model : built({"tensor_mass", "reduced"})) {
    Scene scene = shallow_block_scene(model);
    scene.deformation.of<RayleighDamping>().mass = 5;
    scene.deformation.of<RayleighDamping>().stiffness = 3e-4;
    const ElasticTensors tensors(shallow_block(kCells), *scene.material,
                                 fixed_vertices(scene, shallow_block(kCells)));
    const DenseTissue dense(shallow_block(kCells), *scene.material, tensors);
    const double slowest = std::sqrt(dense.squares[0]);
    for (const double ratio : {0.1, 1.0, 2.3}) {
      const SupportMotion motion{Vec3(0.6, 0, 0.8), 0.001, kTau / (ratio * slowest), 1.1};
      scene.fixed[0].motions = {motion};
      const double w = ratio * slowest;
      // A rigid displacement meets no force: -K_fd e = K e over the free ones.
      const Eigen::MatrixXcd matrix =
          dense.stiffness.cast<Complex>() * Complex(1, w * 3e-4) +
          Eigen::MatrixXcd((Complex(-w * w, w * 5) * dense.mass.cast<Complex>()).asDiagonal());
      const Eigen::VectorXd e = motion.direction.replicate(tensors.vertices(), 1);
      const Eigen::VectorXcd answer =
          test::solve_any(matrix, Complex(1, w * 3e-4) * (dense.stiffness * e).cast<Complex>());
      const Bench bench(scene, shallow_block(kCells));
      for (int step = 1; step < 4; ++step) {
        const FreeMotion moved = bench.model->free_motion(1.0 / 30);
        const Eigen::VectorXd u =
            (motion.amplitude * std::polar(1.0, w * step / 30 + motion.phase) * answer).imag();
        double most = 0;
        for (std::size_t v = 0; v < moved.positions.size(); ++v) {
          const int place = tensors.places()[bench.surface.vertices[v]];
          const Vec3 expected = place < 0 ? Vec3(way_of(motion, step / 30.0) * motion.direction)
                                          : Vec3(u.segment<3>(3 * place));
          most = std::max(most, (moved.positions[v] - bench.at(v) - expected).norm());
        }
        CAPTURE(model, ratio, step, most, u.lpNorm<Eigen::Infinity>());
        CHECK(most < 1e-9 * motion.amplitude);
      }
    }
  }
}

TEST_CASE("moving supports: slow motion leads all models where statics stand, stretched or as one") {
  for (const bool as_one : {false, true}) {
    const auto scene_with = [&](std::string_view model) {
      Scene scene = shallow_block_scene(model);
      scene.fixed[0].motions = {{Vec3(0.6, 0.8, 0), 0.003, 20, 0.5}};
      if (!as_one) scene.fixed.push_back({{Box{Vec3(0.0199, -0.015, -1), Vec3(1, 1, 1)}, "", "test"}});
      return scene;
    };
    const SupportMotion motion = scene_with("quasi_static").fixed[0].motions[0];
    for (const std::string_view model : built({"tensor_mass", "implicit", "reduced"})) {
      const Bench moving(scene_with(model), shallow_block(kCells)),
          still(scene_with("quasi_static"), shallow_block(kCells));
      for (int step = 0; step < 300; ++step) {
        const double dt = step == 0 ? 0 : 1.0 / 30;
        const FreeMotion a = moving.model->free_motion(dt), b = still.model->free_motion(dt);
        double off = 0, fast = 0, turned = 0;
        for (std::size_t v = 0; v < a.positions.size(); ++v) {
          off = std::max(off, (a.positions[v] - b.positions[v]).norm());
          fast = std::max(fast, (a.velocities[v] - b.velocities[v]).norm());
          turned = std::max(
              turned,
              (a.positions[v] - moving.at(v) - way_of(motion, step / 30.0) * motion.direction).norm());
        }
        CAPTURE(model, as_one, step, off, turned);
        REQUIRE(off < 0.005 * motion.amplitude);
        REQUIRE(fast < 0.005 * motion.amplitude * kTau / motion.period);
        if (as_one) REQUIRE(turned < 0.005 * motion.amplitude);
      }
    }
  }
}

TEST_CASE("moving supports: a soft bar of any law and element is drawn out as statics say") {
  for (const ElasticLaw law : {ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    const ElementKind element =
        law == ElasticLaw::kNeoHookean ? ElementKind::kQuadratic : ElementKind::kLinear;
    const TetMesh mesh = grid_block(lines(0, 0.04, 4), lines(0, 0.01, 1), lines(0, 0.01, 1));
    Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.3, .law = law, .element = element},
                           {Vec3(-1, -1, -1), Vec3(0, 1, 1)}, 0.005);
    scene.fixed.push_back({{Box{Vec3(0.04, -1, -1), Vec3(1, 1, 1)}, "", "test"}});
    scene.fixed[1].motions = {{Vec3(0.8, 0.6, 0), 0.015, 20}};
    scene.deformation.model = "implicit";
    const Bench bench(scene, mesh);
    FreeMotion moved;
    for (int step = 0; step < 120; ++step) {
      moved = bench.model->free_motion(1.0 / 30);
      if (NonlinearModel* const nonlinear = bench.model->traits().nonlinear) {
        while (const auto again = nonlinear->relinearise()) moved = *again;
      }
    }
    const Solid solid(bench.mesh, *scene.material);
    std::vector<HeldAxes> held(solid.rest().size(), 0);
    std::vector<Vec3> displaced(held.size(), Vec3::Zero());
    for (std::size_t i = 0; i < held.size(); ++i) {
      const double x = solid.rest()[i][0];
      if (x == 0 || x == 0.04) held[i] = kAllAxes;
      if (x == 0.04) displaced[i] = way_of(scene.fixed[1].motions[0], 4) * Vec3(0.8, 0.6, 0);
    }
    const Equilibrium found = find_equilibrium(solid, {.held = held, .moved = displaced}, "test");
    for (std::size_t v = 0; v < moved.positions.size(); ++v) {
      CAPTURE(static_cast<int>(law), v);
      CHECK((moved.positions[v] - found.x[bench.surface.vertices[v]]).norm() < 0.005 * 0.015);
    }
  }
}

TEST_CASE("moving supports: what is held stands where displacement and motion add up, along its axes") {
  const TetMesh mesh = with_nodes(grid_block({0, 0.01, 0.02}, {0, 0.01}, {0, 0.01}), ElementKind::kQuadratic);
  Scene scene = scene_of({.young_modulus = 1e4, .poisson_ratio = 0.3, .element = ElementKind::kQuadratic},
                         {Vec3(-1, -1, -1), Vec3(0.01, 1, 1)}, 0.005);
  scene.fixed[0].axes = 3;  // x and y
  scene.fixed[0].motions = {{Vec3(0.6, 0, 0.8), 0.002, 3, 0.2}};
  scene.fixed.push_back({{Box{Vec3(0.01, -1, -1), Vec3(1, 1, 1)}, "", "test"}});
  scene.fixed[1].motions = {{Vec3::UnitY(), 0.001, 2}, {Vec3::UnitZ(), 0.004, 5}};
  scene.loads.push_back({.kind = Load::Kind::kDisplacement,
                         .region = {Box{Vec3(0.02, -1, -1), Vec3(1, 1, 1)}, "", "test"},
                         .vector = Vec3(0.003, 0, 0)});
  const Solid solid(mesh, *scene.material);
  const Loads loads(scene, mesh, boundary_surface(mesh), solid);
  const double t = 0.7;
  const Vec3 left = Vec3(0.6 * way_of(scene.fixed[0].motions[0], t), 0, 0),
             right(0.003, way_of(scene.fixed[1].motions[0], t), way_of(scene.fixed[1].motions[1], t));
  std::vector<Vec3> x = solid.rest();
  loads.put_held(t, x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double at = solid.rest()[i][0];
    // Vertices at 0.01 are of both, and go with the first; between the two, half of each where both hold.
    const Vec3 expected = at < 0.0101 ? left : at > 0.0199 ? right : Vec3(0.5 * (left + right));
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_held = (loads.held()[i] >> axis & 1) != 0;
      CAPTURE(i, axis, at);
      CHECK(x[i][axis] - solid.rest()[i][axis] == Approx(is_held ? expected[axis] : 0).margin(1e-15));
      CHECK(loads.moved(t)[i][axis] * is_held == Approx(x[i][axis] - solid.rest()[i][axis]).margin(1e-15));
    }
  }
}

TEST_CASE("moving supports: what would swing beyond all measure is refused in one line") {
  for (const std::string_view model : {"tensor_mass", "implicit"}) {
    Oscillator one(model);
    one.scene.deformation.of<RayleighDamping>().mass = one.scene.deformation.of<RayleighDamping>().stiffness =
        0;
    one.shake(1);
    one.scene.fixed[0].where = "bottom";
    std::string said = "none";
    try {
      const Bench bench(one.scene, one.mesh);
    } catch (const Error& e) {
      said = e.what();
    }
    CHECK(said.starts_with("bottom: [[fixed.motion]]: at a period of 0.0"));
    CHECK(said.ends_with("s the tissue swings beyond all measure; give it damping, or another period"));
  }
}
