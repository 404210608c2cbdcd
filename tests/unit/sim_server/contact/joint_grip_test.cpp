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
  Wrench sum;
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
