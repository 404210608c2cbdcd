// Two instruments that hold the same tissue.
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

/// Force (N), and torque (N m) about a tool's place, that displace the vertices of the top within `kReach` of
/// the places of tools by `displaced` (m), by the stiffness matrix of the body; nothing of compliance, grips
/// or turns. `on`: only those near this place count.
struct Wrench {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};
Wrench displacing(const TetMesh& mesh, const Scene& scene, const std::function<Vec3(const Vec3&)>& displaced,
                  const Vec3& on, double within) {
  const FreeDofs dofs(static_cast<int>(mesh.vertices.size()), fixed_vertices(scene, mesh));
  const Eigen::MatrixXd stiffness = test::dense_stiffness(Solid(mesh, *scene.material), dofs);
  std::vector<int> held, free;
  std::vector<Vec3> places;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(dofs.count);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& x = mesh.vertices[v];
    const bool is_held = std::ranges::any_of(scene.tools, [&](const ToolSettings& tool) {
      return x.y() > -1e-9 && (x - *tool.grasp_place).norm() <= kReach;
    });
    if (dofs.first[v] < 0) continue;
    for (int axis = 0; axis < 3; ++axis) (is_held ? held : free).push_back(dofs.first[v] + axis);
    if (!is_held) continue;
    u.segment<3>(dofs.first[v]) = displaced(x);
    places.push_back(x);
  }
  const Eigen::VectorXd known = stiffness(free, held) * u(held);
  u(free) = -stiffness(free, free).llt().solve(known);
  const Eigen::VectorXd forces = stiffness * u;
  Wrench sum;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if ((places[i] - on).norm() > within) continue;
    const Vec3 force = forces.segment<3>(held[3 * i]);
    sum.force += force;
    sum.torque += (places[i] + displaced(places[i]) - on).cross(force);
  }
  return sum;
}

/// The force (N) that lifts the vertices held by all tools by `lift` (m).
Vec3 lifting_force(const TetMesh& mesh, const Scene& scene, const Vec3& lift) {
  return displacing(
             mesh, scene, [&](const Vec3&) { return lift; }, Vec3::Zero(), 1)
      .force;
}

}  // namespace

TEST_CASE("grip: two instruments that lift the same tissue share its force, as the stiffness matrix has it") {
  const auto mesh = [] { return test::soft_block(Vec3(0.05, 0.03, 0.03), {20, 8, 12}); };
  const Vec3 lift(0, 0.005, 0);
  for (const double apart : {0.006, 0.0025, 0.02}) {  // at 2.5 mm they hold some of the same vertices
    const Scene scene = held_twice("quasi_static", apart);
    Simulation block(scene, mesh());
    const Vec3 right = lifting_force(block.mesh(), scene, lift);
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
      block.mesh(), scene,
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
