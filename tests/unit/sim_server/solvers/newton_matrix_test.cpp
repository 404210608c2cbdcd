// A factor that is turned with its nodes, on bodies that are carried and turned about: there it is exact.
#include "sim_server/solvers/newton_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sim_server/solvers/dynamics.h"
#include "tests/support/catch.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kC = 60;  // 1/s: of a step of 17 ms

const Mat3 kTurn = Eigen::AngleAxisd(2.2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
const Vec3 kShift(0.3, -0.2, 0.1);

Material corotational(ElementKind element) {
  return {.young_modulus = 5e3,
          .poisson_ratio = 0.4,
          .density = 1000,
          .law = ElasticLaw::kCorotational,
          .element = element};
}

Solid bar(ElementKind element) {
  const TetMesh mesh = grid_block(test::lines(0, 0.06, 5), test::lines(0, 0.02, 2), test::lines(0, 0.02, 2));
  const Material material = corotational(element);
  return {with_nodes(mesh, material.element), material};
}

std::vector<Vec3> carried(const Solid& solid) {
  std::vector<Vec3> x;
  for (const Vec3& p : solid.rest()) x.push_back(kTurn * p + kShift);
  return x;
}

/// Without an order.
Eigen::VectorXd some_load(Eigen::Index n) {
  return Eigen::VectorXd::NullaryExpr(
      n, [](Eigen::Index i) { return std::sin(1.0 + 2.3 * double(i * i % 97)); });
}

}  // namespace

TEST_CASE("node rotations of a body that is turned and carried are that turn, stretched or not") {
  for (const ElementKind element :
       {ElementKind::kLinear, ElementKind::kQuadratic, ElementKind::kNodalPressure}) {
    const Solid solid = bar(element);
    std::vector<Mat3> found(solid.rest().size());
    std::vector<Vec3> x;
    for (const Vec3& p : solid.rest()) x.push_back(kTurn * Vec3(1.3 * p[0], 0.8 * p[1], 1.1 * p[2]) + kShift);
    solid.node_rotations(x, found);
    for (const Mat3& rotation : found) CHECK((rotation - kTurn).norm() < 1e-12);
  }
}

TEST_CASE(
    "Newton matrix: a factor made at rest, turned with its nodes, is that of the body turned and carried") {
  for (const ElementKind element :
       {ElementKind::kLinear, ElementKind::kQuadratic, ElementKind::kNodalPressure}) {
    const Solid solid = bar(element);
    const FreeDofs dofs(std::vector<HeldAxes>(solid.rest().size(), 0));
    const DynamicsSettings settings{.flies = true};
    const std::vector<double> masses = solid.masses();
    const std::vector<Vec3> x = carried(solid);
    Solid::Scratch scratch(solid);
    NewtonMatrix stale(solid, dofs, settings, "test"), fresh(solid, dofs, settings, "test");
    stale.build(solid, solid.rest(), masses, {}, kC, scratch);
    fresh.build(solid, x, masses, {}, kC, scratch);
    const Eigen::VectorXd load = some_load(dofs.count), right = fresh.solve(load).col(0);
    stale.turn_to(solid, x);
    const double rounding = 1e-4;  // factors are in single precision
    CHECK((stale.turned_solve(load) - right).norm() < rounding * right.norm());
    CHECK((stale.solve(load).col(0) - right).norm() > 0.3 * right.norm());
  }
}

TEST_CASE("Newton matrix: one that was built elsewhere is turned by the difference alone") {
  const Solid solid = bar(ElementKind::kLinear);
  const FreeDofs dofs(std::vector<HeldAxes>(solid.rest().size(), 0));
  const std::vector<double> masses = solid.masses();
  Solid::Scratch scratch(solid);
  NewtonMatrix matrix(solid, dofs, {.flies = true}, "test");
  const std::vector<Vec3> x = carried(solid);
  matrix.build(solid, x, masses, {}, kC, scratch);
  matrix.turn_to(solid, x);
  const Eigen::VectorXd load = some_load(dofs.count), right = matrix.solve(load).col(0);
  CHECK((matrix.turned_solve(load) - right).norm() < 1e-5 * right.norm());
}

TEST_CASE(
    "Newton matrix: of a body of which vertices became two, or came back to one, it is that of the body as "
    "it is") {
  TetMesh mesh = grid_block(test::lines(0, 0.06, 5), test::lines(0, 0.02, 2), test::lines(0, 0.02, 2));
  const auto vertices = static_cast<int>(mesh.vertices.size());
  for (int v = 0; v < vertices; ++v)
    mesh.vertices.push_back(Vec3(mesh.vertices[static_cast<std::size_t>(v)]));
  const TetMesh whole = mesh;
  Solid solid(mesh, corotational(ElementKind::kLinear));
  std::vector<HeldAxes> held(mesh.vertices.size(), 0);
  for (int v = 0; v < vertices; ++v)
    held[static_cast<std::size_t>(v)] = mesh.vertices[static_cast<std::size_t>(v)].x() == 0 ? kAllAxes : 0;
  const FreeDofs dofs(held);
  NewtonMatrix matrix(solid, dofs, {}, "test");
  std::vector<int> beyond;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (centre_of(mesh, mesh.tetrahedra[t]).x() < 0.03) continue;
    for (int& corner : mesh.tetrahedra[t]) corner += vertices;
    beyond.push_back(static_cast<int>(t));
  }
  Solid::Scratch scratch(solid);
  const Eigen::VectorXd load = some_load(dofs.count);
  for (const TetMesh& now : {mesh, whole}) {
    solid.reshape(now, beyond);
    matrix.parted();
    CHECK(matrix.c() == 0);
    matrix.build(solid, solid.rest(), solid.masses(), {}, kC, scratch);
    const Solid other(now, corotational(ElementKind::kLinear));
    StiffnessMatrix exact = other.stiffness_matrix(dofs);
    other.add_stiffness(other.rest(), exact);
    exact.add_to_diagonal(other.masses(), kC * kC);
    const Eigen::VectorXd moved = matrix.solve(load).col(0);
    Eigen::VectorXd left = load - exact.times(moved).col(0);
    for (Eigen::Index i = 0; i < left.size(); ++i) left[i] = exact.lower().coeff(i, i) > 0 ? left[i] : 0;
    CHECK(left.norm() < 1e-4 * load.norm());
  }
}

TEST_CASE("Newton matrix: what is held along an axis stays held") {
  const Solid solid = bar(ElementKind::kLinear);
  std::vector<HeldAxes> held(solid.rest().size(), 0);
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (solid.rest()[i][0] == 0) held[i] = i % 2 == 0 ? kAllAxes : HeldAxes{1};
  }
  const FreeDofs dofs(held);
  NewtonMatrix matrix(solid, dofs, {}, "test");
  matrix.turn_to(solid, carried(solid));
  Eigen::VectorXd load = some_load(dofs.count);
  dofs.hold(load);
  const Eigen::VectorXd moved = matrix.turned_solve(load);
  Eigen::VectorXd kept = moved;
  dofs.hold(kept);
  CHECK((moved - kept).norm() <= 1e-6 * moved.norm());
}

TEST_CASE("Newton matrix: of a body about to buckle, with more inertia it still leads downhill, each time") {
  for (const ElementKind element :
       {ElementKind::kLinear, ElementKind::kQuadratic, ElementKind::kNodalPressure}) {
    const Solid solid = bar(element);
    const FreeDofs dofs(std::vector<HeldAxes>(solid.rest().size(), 0));
    std::vector<Vec3> x;
    for (const Vec3& p : solid.rest()) x.push_back(Vec3(0.4 * p[0], p[1], p[2]));
    StiffnessMatrix exact = solid.stiffness_matrix(dofs);
    solid.add_stiffness(x, exact);
    exact.add_to_diagonal(solid.masses(), kC * kC);
    const Eigen::MatrixXd a = Eigen::MatrixXd(exact.lower()).selfadjointView<Eigen::Lower>();
    REQUIRE(Eigen::LLT<Eigen::MatrixXd>(a).info() != Eigen::Success);
    Solid::Scratch scratch(solid);
    NewtonMatrix matrix(solid, dofs, {.flies = true}, "test");
    const Eigen::VectorXd load = some_load(dofs.count);
    for (int i = 0; i < 3; ++i) {
      matrix.build(solid, x, solid.masses(), {}, kC, scratch);
      CHECK(matrix.solve(load).col(0).dot(load) > 0);
    }
  }
}

TEST_CASE("dynamics: a body that spins freely by three turns makes at most three factors") {
  const Solid solid = bar(ElementKind::kLinear);
  DynamicsSettings settings{.second_order = true, .flies = true};
  Dynamics dynamics(solid, std::vector<HeldAxes>(solid.rest().size(), 0), settings, "test");
  const Vec3 spin(0, 0, 2 * 3.14159265358979), centre(0.03, 0.01, 0.01);  // rad/s: one turn a second
  std::vector<Vec3> v;
  for (const Vec3& p : solid.rest()) v.push_back(spin.cross(p - centre));
  dynamics.set_state(solid.rest(), v);
  const double begin = dynamics.kinetic_energy();
  const std::vector<Vec3> none(solid.rest().size(), Vec3::Zero());
  const int steps = 300;
  for (int i = 0; i < steps; ++i) {
    dynamics.start_step(0.01);
    dynamics.solve(none, 30, 1e-6);
    CHECK(dynamics.relative_residual() <= 1e-6);
    dynamics.finish_step();
  }
  CHECK(dynamics.kinetic_energy() > 0.9 * begin);
  CHECK(dynamics.factors() <= 3);  // at two c, of backward Euler's first step and of BDF2, and one more
}
