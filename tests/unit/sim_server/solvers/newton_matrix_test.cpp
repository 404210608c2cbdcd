// A factor that is turned with its nodes, on bodies that are carried and turned about: there it is exact.
#include "sim_server/solvers/newton_matrix.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "sim_server/solvers/dynamics.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
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

/// A bar that is held at one end, and cut half through where x is 24 mm: vertices there became two, and one
/// of the copies once more.
struct SeparatedBar {
  TetMesh entire = grid_block(test::lines(0, 0.06, 5), test::lines(0, 0.02, 2), test::lines(0, 0.02, 2));
  TetMesh separated;
  std::vector<Split> splits;
  std::vector<int> beyond;  // tetrahedra that have copies as corners

  SeparatedBar() {
    const auto vertices = static_cast<int>(entire.vertices.size());
    std::set<int> of_near, split;
    for (const Tetrahedron& corners : entire.tetrahedra) {
      if (centre_of(entire, corners).x() < 0.024) of_near.insert(corners.begin(), corners.end());
    }
    for (int v = 0; v < vertices; ++v) entire.vertices.push_back(Vec3(entire.vertices[std::size_t(v)]));
    entire.vertices.push_back(Vec3(entire.vertices.back()));
    separated = entire;
    for (std::size_t t = 0; t < separated.tetrahedra.size(); ++t) {
      if (centre_of(entire, entire.tetrahedra[t]).x() < 0.024) continue;
      bool changed = false;
      for (int& corner : separated.tetrahedra[t]) {
        if (of_near.contains(corner) && entire.vertices[std::size_t(corner)].y() > 0) {
          split.insert(corner);
          corner += vertices;
          changed = true;
        }
      }
      if (changed) beyond.push_back(static_cast<int>(t));
    }
    for (const int v : split) splits.push_back({v, v + vertices});
    // One tetrahedron alone with a copy of a copy.
    const int copy = splits.back().copy;
    splits.push_back({copy, 2 * vertices});
    entire.vertices.back() = separated.vertices.back() = Vec3(entire.vertices[std::size_t(copy)]);
    for (const int t : beyond) {
      Tetrahedron& corners = separated.tetrahedra[std::size_t(t)];
      if (std::ranges::find(corners, copy) == corners.end()) continue;
      std::ranges::replace(corners, copy, 2 * vertices);
      break;
    }
  }
  std::vector<HeldAxes> held() const {
    std::vector<HeldAxes> held;
    for (const Vec3& x : entire.vertices) held.push_back(x.x() == 0 ? kAllAxes : 0);
    return held;
  }
  FreeDofs dofs() const { return FreeDofs(held()); }
  /// On vertices that have tetrahedra.
  Eigen::VectorXd load(const FreeDofs& dofs) const {
    const Eigen::VectorXd some = some_load(dofs.count);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(dofs.count);
    for (const Tetrahedron& corners : separated.tetrahedra) {
      for (const int v : corners) {
        const int first = dofs.first[std::size_t(v)];
        if (first >= 0) load.segment<3>(first) = some.segment<3>(first);
      }
    }
    return load;
  }
  /// Of those that will be parted, of a solid at `x`; of tissue so many times as stiff.
  void note_shapes(const Solid& solid, const std::vector<Vec3>& x, NewtonMatrix& matrix,
                   double stiffer = 1) const {
    Solid::Scratch scratch(solid);
    for (const int t : beyond) {
      NewtonMatrix::Blocks blocks;
      auto* block = blocks.data();
      solid.stiffness_of(std::size_t(t), x, {}, scratch,
                         [&](int i, int j, const Mat3& k) { *block++ = stiffer * matrix.to_rest(i, j, k); });
      matrix.note_shape(t, blocks);
    }
  }
  /// A of the parted one, at `x`.
  StiffnessMatrix matrix(const FreeDofs& dofs, const std::vector<Vec3>& x) const {
    const Solid solid(separated, corotational(ElementKind::kLinear));
    StiffnessMatrix exact = solid.stiffness_matrix(dofs);
    solid.add_stiffness(x, exact);
    exact.add_to_diagonal(solid.masses(), kC * kC);
    exact.close_empty(exact.lower().diagonal().mean());
    return exact;
  }
};

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
    "Newton matrix: of a body of which vertices became two, the next one is that of the body as it is") {
  const SeparatedBar bar;
  const FreeDofs dofs = bar.dofs();
  Solid solid(bar.entire, corotational(ElementKind::kLinear));
  NewtonMatrix matrix(solid, dofs, {}, "test");
  Solid::Scratch scratch(solid);
  solid.reshape(bar.separated, bar.beyond);
  matrix.part(bar.splits);
  matrix.build(solid, solid.rest(), solid.masses(), {}, kC, scratch);
  const Eigen::VectorXd load = bar.load(dofs), moved = matrix.solve(load).col(0);
  const Eigen::VectorXd remaining = load - bar.matrix(dofs, solid.rest()).times(moved).col(0);
  CHECK(remaining.norm() < 1e-4 * load.norm());
}

TEST_CASE("Newton matrix: bordered, the one from before vertices became two solves what the body is now") {
  const SeparatedBar bar;
  const FreeDofs dofs = bar.dofs();
  // Made at rest; or where the body is, and cut before anything has turned.
  for (const auto& [turned, made_there] : {std::pair{false, false}, {true, false}, {true, true}}) {
    CAPTURE(turned, made_there);
    Solid solid(bar.entire, corotational(ElementKind::kLinear));
    NewtonMatrix matrix(solid, dofs, {}, "test");
    Solid::Scratch scratch(solid);
    const std::vector<Vec3> x = turned ? carried(solid) : solid.rest();
    matrix.build(solid, made_there ? x : solid.rest(), solid.masses(), {}, kC, scratch);
    if (!made_there) matrix.turn_to(solid, x);
    bar.note_shapes(solid, x, matrix);
    solid.reshape(bar.separated, bar.beyond);
    matrix.part(std::span(bar.splits).first(3));  // at once or by and by
    matrix.part(std::span(bar.splits).subspan(3));
    matrix.turn_to(solid, x);
    CHECK(matrix.make_border(solid, solid.masses()) == static_cast<int>(bar.splits.size()));
    CHECK(matrix.make_border(solid, solid.masses()) == 0);
    const Eigen::VectorXd load = bar.load(dofs);
    const Eigen::VectorXd remaining = load - bar.matrix(dofs, x).times(matrix.turned_solve(load)).col(0);
    CHECK(remaining.norm() < 1e-4 * load.norm());
    // As columns, too.
    const std::vector<int> first{dofs.first[static_cast<std::size_t>(bar.splits.back().copy)]};
    const Eigen::MatrixXd column = matrix.columns(first, 1e-3);
    CHECK((column.col(1) - matrix.solve(Eigen::VectorXd::Unit(dofs.count, first[0] + 1))).norm() <
          1e-4 * column.col(1).norm());
  }
}

TEST_CASE("dynamics: in the step after nodes became two the factor goes on, and it converges as any",
          "[threads]") {
  using Solver = DynamicsSettings::Solver;
  const SeparatedBar bar;
  for (const Solver solver : {Solver::kDirect, Solver::kQuasiNewton}) {
    Solid solid(bar.entire, corotational(ElementKind::kLinear));
    Dynamics dynamics(solid, bar.held(), {.solver = solver, .refresh_steps = 1000, .cut = true}, "test");
    std::vector<Vec3> pull(solid.rest().size(), Vec3::Zero());  // by 27 mm
    for (std::size_t i = 0; i < pull.size(); ++i)
      pull[i].z() = solid.rest()[i].x() > 0.059 && solid.masses()[i] > 0 ? 3e-3 : 0;
    int factors = 0;  // once no more than 1e-2 was left
    const auto step = [&] {
      dynamics.start_step(1.0 / 60);
      int iterations = dynamics.solve(pull, 50, 1e-2);
      factors = dynamics.factor().count();
      iterations += dynamics.solve(pull, 50, 1e-8);
      CHECK(dynamics.relative_residual() <= 1e-8);
      dynamics.finish_step();
      return iterations;
    };
    for (int i = 0; i < 10; ++i) step();
    const int ordinary = step(), before = dynamics.factor().count();
    dynamics.note_shapes(bar.beyond);
    for (const auto& [node, copy] : bar.splits) dynamics.copy(node, copy);
    solid.reshape(bar.separated, bar.beyond);
    std::vector<Dynamics::NodeMass> masses;
    for (int node = 0; node < solid.nodes(); ++node)
      masses.push_back({node, solid.masses()[static_cast<std::size_t>(node)]});
    dynamics.part(bar.splits, masses);
    const int after = step();
    CAPTURE(static_cast<int>(solver), ordinary, after);
    CHECK(after <= ordinary + 5);
    // The same, with a border. Of a bar another is cheap, and soon follows.
    if (solver != Solver::kDirect) CHECK(factors == before + 1);
  }
}

TEST_CASE("Newton matrix: a border that does not fit the factor still makes it positive definite") {
  const SeparatedBar bar;
  const FreeDofs dofs = bar.dofs();
  Solid solid(bar.entire, corotational(ElementKind::kLinear));
  NewtonMatrix matrix(solid, dofs, {}, "test");
  Solid::Scratch scratch(solid);
  matrix.build(solid, solid.rest(), solid.masses(), {}, kC, scratch);
  bar.note_shapes(solid, solid.rest(), matrix, 6);
  solid.reshape(bar.separated, bar.beyond);
  matrix.part(bar.splits);
  matrix.make_border(solid, solid.masses());
  const Eigen::MatrixXd inverse = matrix.solve(Eigen::MatrixXd::Identity(dofs.count, dofs.count));
  CHECK((inverse - inverse.transpose()).norm() < 1e-4 * inverse.norm());
  CHECK(test::is_definite(0.5 * (inverse + inverse.transpose())));
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
  Eigen::VectorXd stored = moved;
  dofs.hold(stored);
  CHECK((moved - stored).norm() <= 1e-6 * moved.norm());
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
    REQUIRE(!test::is_definite(a));
    Solid::Scratch scratch(solid);
    NewtonMatrix matrix(solid, dofs, {.flies = true}, "test");
    const Eigen::VectorXd load = some_load(dofs.count);
    for (int i = 0; i < 3; ++i) {
      matrix.build(solid, x, solid.masses(), {}, kC, scratch);
      CHECK(matrix.solve(load).col(0).dot(load) > 0);
    }
  }
}

TEST_CASE("background matrix: one that no inertia makes definite is not taken, and the next one is") {
  // A bar of 1 GPa, squeezed: its modes grow faster than a thousand times in a step.
  const TetMesh mesh = grid_block(test::lines(0, 0.06, 5), test::lines(0, 0.02, 2), test::lines(0, 0.02, 2));
  const Solid solid(
      mesh,
      {.young_modulus = 1e9, .poisson_ratio = 0.49, .density = 1000, .law = ElasticLaw::kStVenantKirchhoff});
  std::vector<HeldAxes> held(mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < held.size(); ++v) held[v] = mesh.vertices[v].x() == 0 ? kAllAxes : 0;
  const FreeDofs dofs(held);
  NewtonMatrix matrix(solid, dofs, {}, "test");
  const Eigen::VectorXd load = some_load(dofs.count), before = matrix.solve(load);
  BackgroundMatrix background(solid, dofs, {}, "test");
  std::vector<Vec3> squeezed = solid.rest();
  for (Vec3& p : squeezed) p.x() *= 0.2;  // far within what this law bears
  background.begin(squeezed, solid.masses(), {}, kC, {});
  CHECK_FALSE(background.exchange(matrix));
  CHECK(matrix.solve(load) == before);
  background.begin(solid.rest(), solid.masses(), {}, 200 * kC, {});
  CHECK(background.exchange(matrix));
  CHECK(matrix.solve(load).norm() < 0.9 * before.norm());  // by the inertia
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
  CHECK(dynamics.factor().count() <=
        3);  // at two c, of backward Euler's first step and of BDF2, and one more
}
