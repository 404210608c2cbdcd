// A piece of linear tissue that nothing holds turns as a body, by explicit sub-steps: against the
// conservation laws, and against an equivalent body in which nothing turns.
#include "sim_server/elasticity/floating_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <numeric>

#include "sim_server/elasticity/solid.h"
#include "sim_server/explicit/cuttable_body.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

const Material kFloating{1e4, 0.4, 1060};

TetMesh floating_bar() {
  return grid_block({0, 0.01, 0.02, 0.03, 0.04}, {0, 0.01, 0.02}, {0, 0.008, 0.02});
}

/// The bar, in motion by itself.
struct FloatingBar {
  TetMesh mesh = floating_bar();
  ElasticTensors tensors{mesh, kFloating, {}};
  double step = 0.5 * longest_sub_step(highest_frequency(tensors), {0, 1e-4});
  ExplicitMotion motion{tensors, {0, 1e-4}};
  Vec3 centre = Vec3::Zero();  // of mass, m
  double mass = 0;             // kg

  FloatingBar() {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      centre += mass_of(v) * mesh.vertices[v];
      mass += mass_of(v);
    }
    centre /= mass;
  }
  std::size_t first(std::size_t v) const { return 3 * static_cast<std::size_t>(tensors.places()[v]); }
  double mass_of(std::size_t v) const { return tensors.masses()[first(v) / 3]; }
  Vec3 place(std::size_t v) const {
    return mesh.vertices[v] + Eigen::Map<const Vec3>(motion.state.u.data() + first(v));
  }
  Eigen::Map<Vec3> velocity(std::size_t v) { return Eigen::Map<Vec3>(motion.state.v.data() + first(v)); }
  void release() {
    std::vector<FloatingPieces::Node> nodes;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      nodes.push_back({tensors.places()[v], mass_of(v), mesh.vertices[v]});
    motion.release({{nodes}, mesh.vertices.size()});
  }
  Vec3 momentum() {
    Vec3 sum = Vec3::Zero();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) sum += mass_of(v) * velocity(v);
    return sum;
  }
  Vec3 angular_momentum() {
    Vec3 sum = Vec3::Zero();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) sum += mass_of(v) * place(v).cross(velocity(v));
    return sum;
  }
  double volume() const {
    double sum = 0;
    for (const Tetrahedron& t : mesh.tetrahedra)
      sum += (place(static_cast<std::size_t>(t[1])) - place(static_cast<std::size_t>(t[0])))
                 .cross(place(static_cast<std::size_t>(t[2])) - place(static_cast<std::size_t>(t[0])))
                 .dot(place(static_cast<std::size_t>(t[3])) - place(static_cast<std::size_t>(t[0]))) /
             6;
    return sum;
  }
};

}  // namespace

TEST_CASE("a floating piece keeps volume, momentum and angular momentum through any turn") {
  FloatingBar bar;
  bar.release();
  const double volume = bar.volume();
  const Vec3 spin(1, 2, 5), drift(0.03, -0.1, 0.02);  // rad/s, m/s
  Random random(3);
  for (std::size_t v = 0; v < bar.mesh.vertices.size(); ++v)
    bar.velocity(v) = drift + spin.cross(bar.mesh.vertices[v] - bar.centre) + random.vector(0.01);
  const Vec3 momentum = bar.momentum(), angular = bar.angular_momentum();
  double smallest = 1, largest = 1;
  const int steps = static_cast<int>(2 * 2 * std::numbers::pi / spin.norm() / bar.step);  // two turns
  for (int i = 0; i < steps; ++i) {
    i == 0 ? bar.motion.run(bar.step) : bar.motion.run_on(bar.step);
    smallest = std::min(smallest, bar.volume() / volume);
    largest = std::max(largest, bar.volume() / volume);
  }
  CHECK(smallest > 0.99);
  CHECK(largest < 1.01);
  CHECK((bar.momentum() - momentum).norm() < 1e-10 * momentum.norm());
  CHECK((bar.angular_momentum() - angular).norm() < 1e-8 * angular.norm());
}

TEST_CASE("a floating piece of which some is condensed keeps its mass, momentum and angular momentum, too") {
  const TetMesh mesh = soft_block(Vec3(0.04, 0.02, 0.02), {8, 3, 4});
  const Surface surface = boundary_surface(mesh);
  Scene scene = soft_block_scene(0.02, "hybrid");
  scene.fixed.clear();
  *scene.material = kFloating;
  scene.deformation.of<RayleighDamping>() = {0, 1e-4};
  const std::vector<int> none, reachable = [&] {
    std::vector<int> all(surface.vertices.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }();
  const ModelInputs inputs{scene, mesh, surface, none, reachable, kSilent};
  std::vector<char> moves;
  for (const Vec3& x : mesh.vertices) moves.push_back(x.x() < 0.001 ? 1 : 0);
  CuttableBody body(inputs, {}, &moves, {.most = 6});
  REQUIRE(body.rest->modes() > 0);
  std::vector<std::vector<int>> pieces(1, std::vector<int>(mesh.tetrahedra.size()));
  std::iota(pieces[0].begin(), pieces[0].end(), 0);
  body.release(pieces, mesh);

  const std::vector<double>& masses = body.tensors.masses();
  const auto at = [](std::vector<double>& all, std::size_t i) { return Eigen::Map<Vec3>(&all[3 * i]); };
  std::vector<Vec3> rest(masses.size());
  Vec3 centre = Vec3::Zero();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (moves[v] == 0) continue;
    const auto i = static_cast<std::size_t>(body.tensors.places()[v]);
    rest[i] = mesh.vertices[v];
    centre += masses[i] * rest[i];
  }
  const double mass = std::accumulate(masses.begin(), masses.end(), 0.0);
  CHECK(mass == Approx(kFloating.density * 0.04 * 0.02 * 0.02).epsilon(1e-9));
  centre /= mass;
  const Vec3 spin(1, 2, 5), drift(0.03, -0.1, 0.02);  // rad/s, m/s
  Random random(3);
  ExplicitMotion::State& state = body.motion.state;
  for (std::size_t i = 0; i < rest.size(); ++i)
    at(state.v, i) = drift + spin.cross(rest[i] - centre) + random.vector(0.01);
  const auto momenta = [&] {
    Eigen::Matrix<double, 3, 2> sum = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t i = 0; i < rest.size(); ++i) {
      sum.col(0) += masses[i] * at(state.v, i);
      sum.col(1) += masses[i] * (rest[i] + at(state.u, i)).cross(at(state.v, i));
    }
    return sum;
  };
  // A box of four corners of the condensed end: its volume is that of a brick, whatever way it lies.
  const auto volume = [&] {
    std::array<Vec3, 4> x;
    for (const int v : reachable) {
      const Vec3& p = mesh.vertices[static_cast<std::size_t>(surface.vertices[static_cast<std::size_t>(v)])];
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 corner(k == 1 ? 0.01 : 0.02, k == 2 ? -0.02 : 0, k == 3 ? -0.01 : 0.01);
        if ((p - corner).norm() < 1e-9) x[k] = p + body.rest->carried(v);
      }
    }
    return std::abs((x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0])) / (0.01 * 0.02 * 0.02);
  };
  const auto before = momenta();
  const double step =
      0.5 * longest_sub_step(highest_frequency(body.tensors), scene.deformation.of<RayleighDamping>());
  double smallest = 1, largest = 1;
  const int steps = static_cast<int>(2 * 2 * std::numbers::pi / spin.norm() / step);  // two turns
  for (int i = 0; i < steps; ++i) {
    body.pull_border(i == 0, state.f);
    i == 0 ? body.motion.run(step) : body.motion.run_on(step);
    body.place_rest();
    smallest = std::min(smallest, volume());
    largest = std::max(largest, volume());
  }
  CHECK(smallest > 0.98);
  CHECK(largest < 1.02);
  CHECK((momenta() - before).col(0).norm() < 1e-10 * before.col(0).norm());
  CHECK((momenta() - before).col(1).norm() < 1e-8 * before.col(1).norm());
}

TEST_CASE("a large floating piece has the same bytes by one thread and by two") {
  const TetMesh mesh = soft_block(Vec3(0.04, 0.02, 0.04), {20, 18, 20});
  const ElasticTensors tensors(mesh, kFloating, {});
  REQUIRE(tensors.parts() > 1);
  const double step = 0.5 * longest_sub_step(highest_frequency(tensors), {0, 1e-4});
  std::vector<FloatingPieces::Node> nodes;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const int place = tensors.places()[v];
    nodes.push_back({place, tensors.masses()[static_cast<std::size_t>(place)], mesh.vertices[v]});
  }
  std::vector<std::vector<double>> ends;
  for (const int threads : {1, 2}) {
    ExplicitMotion motion(tensors, {0, 1e-4}, 1, threads);
    motion.release({{nodes}, mesh.vertices.size()});
    for (const FloatingPieces::Node& node : nodes)
      Eigen::Map<Vec3>(motion.state.v.data() + std::ptrdiff_t{3} * node.number) =
          Vec3(1, 20, 50).cross(node.rest);
    motion.run(step);
    for (int i = 0; i < 20; ++i) {
      motion.start_next();
      motion.add_impulse(17, step, Vec3(0.01, 0, 0.02));
      motion.run_on(step);
    }
    ends.push_back(motion.state.u);
  }
  CHECK(ends[0] == ends[1]);
}

TEST_CASE("a kick on one vertex of a floating piece becomes its momentum and its angular momentum") {
  FloatingBar bar;
  bar.release();
  bar.motion.run(bar.step);
  const Vec3 speed(0.1, 2, 0.3);  // m/s
  const std::size_t corner = 7;
  const Vec3 at = bar.place(corner);
  bar.motion.add_impulse(bar.tensors.places()[corner], bar.step, speed);
  const Vec3 given = bar.mass_of(corner) * speed, turned = at.cross(given);
  for (int i = 0; i < 3000; ++i) bar.motion.run_on(bar.step);
  CHECK((bar.momentum() - given).norm() < 1e-10 * given.norm());
  CHECK((bar.angular_momentum() - turned).norm() < 1e-8 * turned.norm());
}

TEST_CASE("the forces of a floating piece are the gradient of its energy, and turn with it") {
  const TetMesh mesh = floating_bar();
  Solid solid(mesh, kFloating);
  std::vector<int> all(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<int>(t);
  const std::vector<std::vector<int>> parts{all};
  solid.release(parts);
  Random random(4);
  std::vector<Vec3> x = mesh.vertices, f(x.size()), turned_f(x.size());
  for (Vec3& place : x) place += random.vector(1e-3);
  solid.forces(x, f);
  double largest = 0;
  for (const Vec3& force : f) largest = std::max(largest, force.norm());
  for (std::size_t k = 0; k < 3 * x.size(); k += 7) {
    constexpr double kApart = 1e-7;  // m
    std::vector<Vec3> there = x, here = x;
    there[k / 3][static_cast<Eigen::Index>(k % 3)] += kApart;
    here[k / 3][static_cast<Eigen::Index>(k % 3)] -= kApart;
    const double slope = (solid.energy(there) - solid.energy(here)) / (2 * kApart);
    CHECK(std::abs(f[k / 3][static_cast<Eigen::Index>(k % 3)] - slope) < 1e-5 * largest);
  }
  const Mat3 R = Eigen::AngleAxisd(2.5, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  std::vector<Vec3> turned = x;
  for (Vec3& place : turned) place = R * place + Vec3(0.2, -3, 1);
  solid.forces(turned, turned_f);
  for (std::size_t i = 0; i < x.size(); ++i) CHECK((turned_f[i] - R * f[i]).norm() < 1e-9 * largest);
  CHECK(solid.energy(turned) == Approx(solid.energy(x)).epsilon(1e-10));
}
