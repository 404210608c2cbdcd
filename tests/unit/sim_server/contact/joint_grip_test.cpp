// Two instruments that hold the same tissue.
#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <vector>

#include "sim_server/scene/touchable.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"
#include "tests/support/stiffness.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 1.0 / 30, kRadius = 0.003, kReach = 1.25 * kRadius;

Scene held_twice(const std::string& model, double apart, double depth = 0.03) {
  Scene scene = test::soft_block_scene(depth, model, ElasticLaw::kLinear, kRadius);
  scene.tools.resize(2, scene.tools.front());
  for (const int i : {0, 1})
    scene.tools[static_cast<std::size_t>(i)].grasp_place = Vec3((i == 0 ? -0.5 : 0.5) * apart, 0, 0);
  return scene;
}

/// The stiffness matrix of a body, factored; nothing of compliance, grips or turns.
struct Body {
  Body(const TetMesh& its_mesh, const Scene& scene)
      : mesh(its_mesh),
        dofs(static_cast<int>(mesh.vertices.size()), fixed_vertices(scene, mesh)),
        factor(test::dense_stiffness(Solid(mesh, *scene.material), dofs)) {}
  TetMesh mesh;
  FreeDofs dofs;
  Eigen::LLT<Eigen::MatrixXd> factor;
};

/// Force (N), and torque (N m) about a place, with which the vertices of the top within `kReach` of the
/// places of tools are displaced by `displaced` (m). `on`: only those within `within` of this place count.
struct Wrench {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double energy = 0;  // J, of the body
};
Wrench displacing(const Body& body, const Scene& scene, const std::function<Vec3(const Vec3&)>& displaced,
                  const Vec3& on, double within) {
  std::vector<int> held;
  std::vector<Vec3> places;
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v) {
    const Vec3& x = body.mesh.vertices[v];
    const bool is_held = std::ranges::any_of(scene.tools, [&](const ToolSettings& tool) {
      return x.y() > -1e-9 && (x - *tool.grasp_place).norm() <= kReach;
    });
    if (!is_held || body.dofs.first[v] < 0) continue;
    for (int axis = 0; axis < 3; ++axis) held.push_back(body.dofs.first[v] + axis);
    places.push_back(x);
  }
  const auto size = static_cast<Eigen::Index>(held.size());
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(body.dofs.count, size);
  Eigen::VectorXd u(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    loads(held[static_cast<std::size_t>(k)], k) = 1;
    if (k % 3 == 0) u.segment<3>(k) = displaced(places[static_cast<std::size_t>(k / 3)]);
  }
  const Eigen::MatrixXd compliance = body.factor.solve(loads)(held, Eigen::all);
  const Eigen::VectorXd forces = compliance.llt().solve(u);
  Wrench sum{.energy = 0.5 * forces.dot(u)};
  for (std::size_t i = 0; i < places.size(); ++i) {
    if ((places[i] - on).norm() > within) continue;
    const Vec3 force = forces.segment<3>(3 * static_cast<Eigen::Index>(i));
    sum.force += force;
    sum.torque += (places[i] + displaced(places[i]) - on).cross(force);
  }
  return sum;
}

}  // namespace

TEST_CASE("grip: two instruments that lift the same tissue share its force, as the stiffness matrix has it") {
  const auto mesh = [] { return test::soft_block(Vec3(0.05, 0.03, 0.03), {20, 8, 12}); };
  const Vec3 lift(0, 0.005, 0);
  const Body body(mesh(), held_twice("quasi_static", 0.02));
  for (const double apart : {0.006, 0.0025, 0.02}) {  // at 2.5 mm they hold some of the same vertices
    const Scene scene = held_twice("quasi_static", apart);
    Simulation block(scene, mesh());
    const Vec3 right = displacing(
                           body, scene, [&](const Vec3&) { return lift; }, Vec3::Zero(), 1)
                           .force;
    REQUIRE(right.y() > 0.5);
    int flagged = 0;
    Vec3 first, second;
    for (int i = 0; i <= 15; ++i) {
      const Vec3 moved = std::min(1.0, i / 10.0) * lift;
      const std::vector<std::optional<ToolPose>> places{ToolPose(*scene.tools[0].grasp_place + moved),
                                                        ToolPose(*scene.tools[1].grasp_place + moved)};
      const auto answers = block.step(test::inputs(places), kDt);
      first = answers[0].force, second = answers[1].force;
      flagged += answers[0].flagged || answers[1].flagged ? 1 : 0;
    }
    CAPTURE(apart, right.transpose(), first.transpose(), second.transpose());
    CHECK(flagged == 0);
    CHECK((first + second + right).norm() < 1e-3 * right.norm());
    CHECK(first.y() == Approx(second.y()).epsilon(0.05));  // the diagonals of the mesh run one way
  }
}

TEST_CASE("grip: jaws that turn turn what they hold, and bear its torque, as the stiffness matrix has it") {
  const Quat turn(Eigen::AngleAxisd(0.1, Vec3(0.3, 1, -0.2).normalized()));
  const Quat placed(Eigen::AngleAxisd(0.7, Vec3::UnitX()));  // what jaws hold from the start turns from there
  const Scene scene = held_twice("quasi_static", 0.014, 0.015);
  Simulation block(scene, test::soft_block(Vec3(0.03, 0.015, 0.02), {12, 6, 8}));
  const Vec3 a = *scene.tools[0].grasp_place, b = *scene.tools[1].grasp_place;
  const auto at = [&](const Quat& first) {
    return std::vector<ToolInput>{{.pose = ToolPose(a, first)}, {.pose = ToolPose(b)}};
  };
  block.step(at(placed), kDt);
  const auto turned = block.step(at(turn * placed), kDt);
  const Wrench right = displacing(
      Body(block.mesh(), scene), scene,
      [&](const Vec3& x) -> Vec3 {
        return (x - a).norm() <= kReach ? Vec3(turn * (x - a) - (x - a)) : Vec3(Vec3::Zero());
      },
      a, kReach);
  REQUIRE(right.torque.norm() > 1e-4);
  CHECK_FALSE(turned[0].flagged);
  CHECK((turned[0].torque + right.torque).norm() < 1e-3 * right.torque.norm());
  CHECK((turned[0].force + right.force).norm() < 1e-3 * right.torque.norm() / kRadius);
  // A tool that turns back, and one that never turned, bear none.
  CHECK(block.step(at(placed), kDt)[0].torque.norm() < 1e-9);
}

TEST_CASE("grip: jaws on a trocar turn what they hold with the shaft, and the tip bears the work of that") {
  Scene scene = held_twice("quasi_static", 0.014, 0.015);
  scene.tools.resize(1);
  const Vec3 at = *scene.tools[0].grasp_place, pivot = at + Vec3(0.005, 0.02, -0.01);
  scene.tools[0].shape.trocar = Tool::Trocar{pivot, 0.002};
  Simulation block(scene, test::soft_block(Vec3(0.03, 0.015, 0.02), {12, 6, 8}));
  const Body body(block.mesh(), scene);
  // The least turn from one axis to the other, about their common normal.
  const auto turn = [&](const Vec3& p) {
    const Vec3 before = pivot - at, after = pivot - p, normal = before.cross(after);
    const double angle = std::atan2(normal.norm(), before.dot(after));
    return Mat3(
        Eigen::AngleAxisd(angle, normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::UnitX())));
  };
  const auto held_at = [&](const Vec3& p) {
    const Mat3 turned = turn(p);
    return displacing(
        body, scene, [&](const Vec3& x) -> Vec3 { return p + turned * (x - at) - x; }, at, kReach);
  };
  const auto force_at = [&](const Vec3& p) {
    Vec3 slope;
    constexpr double kStep = 1e-6;  // m; the energy is all but quadratic
    for (int k = 0; k < 3; ++k) {
      const Vec3 aside = kStep * Vec3::Unit(k);
      slope[k] = (held_at(p + aside).energy - held_at(p - aside).energy) / (2 * kStep);
    }
    return Vec3(-slope);
  };
  const auto step_to = [&](const Vec3& p) {
    return block.step(std::vector<ToolInput>{{.pose = ToolPose(p)}}, kDt)[0];
  };
  step_to(at);
  for (const Vec3& moved : {Vec3(0.004, 0.001, 0.003), Vec3(-0.006, 0.002, 0.004)}) {
    const Vec3 p = at + moved, right = force_at(p);
    const ToolAnswer found = step_to(p);
    CAPTURE(right.transpose(), found.force.transpose(), held_at(p).force.transpose());
    CHECK_FALSE(found.flagged);
    CHECK((found.force - right).norm() < 1e-3 * right.norm());
    CHECK((found.force + held_at(p).force).norm() > 0.01 * right.norm());  // what turns it counts
    CHECK(found.torque.isZero(0));
    constexpr double kAside = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Vec3 slope =
          (force_at(p + kAside * Vec3::Unit(k)) - force_at(p - kAside * Vec3::Unit(k))) / (2 * kAside);
      CHECK((found.tangent.col(k) - slope).norm() < 0.02 * found.tangent.norm());
    }
  }
  const ToolAnswer in_the_wall = step_to(pivot);  // no tool is there, but a client may say so
  CHECK(in_the_wall.force.allFinite());
  CHECK(in_the_wall.tangent.allFinite());
}
