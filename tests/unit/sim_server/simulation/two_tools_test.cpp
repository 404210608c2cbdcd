#include <optional>

#include "common/contact/simplex_distance.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/stiffness.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 0.03, kRadius = 0.005;

using Places = std::vector<std::optional<ToolPose>>;

/// The tool centre that presses `depth` deep at x.
Vec3 press(double x, double depth) {
  return {x, kRadius - depth, 0.0013};
}

struct Block : Simulation {
  explicit Block(std::size_t tools, const std::string& model = "quasi_static")
      : Simulation(test::wide_block_scene(tools, kRadius, model), test::wide_block()) {}
  std::vector<ToolForce> at(const Places& places) {
    const auto forces = Simulation::step(test::inputs(places), kDt);
    return {forces.begin(), forces.end()};
  }
};

double relative(const Vec3& a, const Vec3& b) {
  return (a - b).norm() / b.norm();
}

/// Height of the top of the block at x under the loads of now, by the nearest vertex.
double top_near(const Simulation& block, double x) {
  double best = 1, height = 0;
  for (std::size_t v = 0; v < block.positions().size(); ++v) {
    const Vec3& rest = block.mesh().vertices[block.surface().vertices[v]];
    const double distance = (rest - Vec3(x, 0, 0)).norm();
    if (distance < best) best = distance, height = block.positions()[v][1];
  }
  return height;
}

/// The forces (N, 3 per vertex) that hold the surface where it is: from the stiffness of the whole body, the
/// vertices inside it free of load. Nothing of compliance or contact.
Eigen::VectorXd holding_forces(const Simulation& block) {
  const TetMesh& mesh = block.mesh();
  const Scene made = test::wide_block_scene(1, kRadius);
  const FreeDofs dofs(static_cast<int>(mesh.vertices.size()), fixed_vertices(made, mesh));
  const Eigen::MatrixXd stiffness = test::dense_stiffness(Solid(mesh, *made.material), dofs);
  std::vector<int> surface, inside;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(dofs.count);
  std::vector<char> on_surface(static_cast<std::size_t>(dofs.count), 0);
  for (std::size_t i = 0; i < block.positions().size(); ++i) {
    const int vertex = block.surface().vertices[i], first = dofs.first[vertex];
    if (first < 0) continue;
    u.segment<3>(first) = block.positions()[i] - mesh.vertices[vertex];
    for (int axis = 0; axis < 3; ++axis) on_surface[first + axis] = 1;
  }
  for (int dof = 0; dof < dofs.count; ++dof) (on_surface[dof] ? surface : inside).push_back(dof);
  const Eigen::VectorXd known = stiffness(inside, surface) * u(surface);
  u(inside) = -test::solve_definite(stiffness(inside, inside), known);
  const Eigen::VectorXd forces = stiffness * u;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (dofs.first[v] >= 0)
      all.segment<3>(3 * static_cast<Eigen::Index>(v)) = forces.segment<3>(dofs.first[v]);
  }
  return all;
}

/// How far tool centre p is from the deformed surface, m.
double distance(const Simulation& block, const Vec3& p) {
  double nearest = 1;
  for (const Triangle& t : block.surface().triangles) {
    const Vec3 &a = block.positions()[t[0]], &b = block.positions()[t[1]], &c = block.positions()[t[2]];
    const auto w = closest_point(p, a, b, c).weight;
    nearest = std::min(nearest, (p - w[0] * a - w[1] * b - w[2] * c).norm());
  }
  return nearest;
}

}  // namespace

TEST_CASE("two tools: where they come to rest, all contacts together are in equilibrium") {
  // By the stiffness matrix: the tissue is held by the forces that the tools report, near them and nowhere
  // else, both tools touch and neither is in the tissue: the conditions of the joint problem.
  const Vec3 a = press(-0.0065, 0.0025), b = press(0.0065, 0.002);
  Block two(2);
  const auto forces = two.at({a, b});
  const Eigen::VectorXd held = holding_forces(two);
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
  double remote = 0;
  for (std::size_t v = 0; v < two.mesh().vertices.size(); ++v) {
    const Vec3& x = two.mesh().vertices[v];
    const Vec3 force = held.segment<3>(3 * static_cast<Eigen::Index>(v));
    if ((x - a).norm() < 0.0125 && x[0] < -1e-6) {
      on_a += force;
    } else if ((x - b).norm() < 0.0125 && x[0] > 1e-6) {
      on_b += force;
    } else {
      remote = std::max(remote, force.norm());
    }
  }
  CHECK(relative(-on_a, forces[0].force) < 1e-6);
  CHECK(relative(-on_b, forces[1].force) < 1e-6);
  CHECK(remote < 1e-6 * forces[0].force.norm());
  // 1e-9 m/N stand in series with every contact (ContactSolver::contact_compliance).
  CHECK(distance(two, a) == Approx(kRadius).margin(2e-9));
  CHECK(distance(two, b) == Approx(kRadius).margin(2e-9));
}

TEST_CASE("two tools: one that is lifted, or only near, leaves the other as if it were alone, bit by bit") {
  Block alone(1), two(2);
  for (double depth = -0.004; depth < 0.004; depth += 0.0007) {
    const ToolForce expected = alone.at({press(0.003, depth)})[0];
    const auto first = two.at({press(0.003, depth), {}});
    CHECK(first[0].force == expected.force);
    CHECK(first[1].force == Vec3::Zero());
  }
  test::lift_tools(two);
  test::lift_tools(alone);
  const ToolForce expected = alone.at({press(-0.004, 0.002)})[0];
  const auto second = two.at({press(0.02, -0.02), press(-0.004, 0.002)});
  CHECK(second[1].force == expected.force);
  CHECK(second[0].force == Vec3::Zero());
}

TEST_CASE("two tools pressing symmetrically feel equal forces, and less than either would alone") {
  Block two(2), alone(1);
  // The mesh is not symmetric (its diagonals run one way): exchange the tools instead.
  const Vec3 a = press(-0.006, 0.002), b = press(0.006, 0.002);
  const auto forces = two.at({a, b}), swapped = Block(2).at({b, a});
  CHECK(relative(forces[0].force, swapped[1].force) < 1e-6);
  CHECK(relative(forces[1].force, swapped[0].force) < 1e-6);
  CHECK(relative(forces[0].force.cwiseProduct(Vec3(0, 1, 0)), forces[1].force.cwiseProduct(Vec3(0, 1, 0))) <
        0.1);
  const double single = alone.at({a})[0].force[1];
  CHECK(forces[0].force[1] < 0.99 * single);
  CHECK(forces[0].force[1] > 0.3 * single);
  CHECK_FALSE(forces[0].flagged);
}

TEST_CASE("two tools far apart feel almost what each feels alone") {
  Block two(2), alone(1);
  const auto forces = two.at({press(-0.033, 0.002), press(0.033, 0.002)});
  CHECK(relative(forces[0].force, alone.at({press(-0.033, 0.002)})[0].force) < 0.02);
  test::lift_tools(alone);
  CHECK(relative(forces[1].force, alone.at({press(0.033, 0.002)})[0].force) < 0.02);
}

TEST_CASE("two tools: the equilibrium does not depend on who came first or how") {
  const Vec3 a = press(-0.0055, 0.0025), b = press(0.0062, 0.0021);
  Block at_once(2), in_turn(2), by_path(2);
  const auto expected = at_once.at({a, b});
  REQUIRE(expected[0].contacts > 1);
  in_turn.at({{}, b});
  const auto later = in_turn.at({a, b});
  std::vector<ToolForce> last;
  for (int i = 0; i <= 40; ++i)
    last =
        by_path.at({a + (1 - i / 40.0) * Vec3(0.002, 0.006, 0), b + (1 - i / 40.0) * Vec3(-0.001, 0.003, 0)});
  for (std::size_t tool = 0; tool < 2; ++tool) {
    CHECK_FALSE(expected[tool].flagged);
    CHECK(relative(later[tool].force, expected[tool].force) < 1e-5);
    CHECK(relative(last[tool].force, expected[tool].force) < 1e-5);
  }
}

TEST_CASE("two tools: the forces are those of the energy that both share (reciprocity)") {
  // dF_a/dp_b = (dF_b/dp_a)^T: true of the joint equilibrium of an elastic body, of no other answer.
  const Vec3 a = press(-0.0061, 0.0021), b = press(0.0058, 0.0024);
  constexpr double kStep = 2e-6;
  Block two(2);
  const auto difference = [&](std::size_t mover, int axis) {
    const Vec3 step = kStep * Vec3::Unit(axis);
    const Vec3 of_a = mover == 0 ? step : Vec3::Zero(), of_b = mover == 1 ? step : Vec3::Zero();
    two.at({a, b});
    const auto ahead = two.at({a + of_a, b + of_b}), behind = two.at({a - of_a, b - of_b});
    return Vec3((ahead[1 - mover].force - behind[1 - mover].force) / (2 * kStep));
  };
  Mat3 a_by_b, b_by_a;
  for (int axis = 0; axis < 3; ++axis) {
    b_by_a.col(axis) = difference(0, axis);
    a_by_b.col(axis) = difference(1, axis);
  }
  CAPTURE(a_by_b, b_by_a);
  CHECK(a_by_b.norm() > 0.5);  // N/m: they do feel each other
  CHECK((a_by_b - b_by_a.transpose()).norm() < 1e-3 * a_by_b.norm());
}

TEST_CASE("two tools: one that presses moves the surface from under the other") {
  Block two(2);
  const double touching = 0.0002;
  REQUIRE(two.at({press(0.006, touching), {}})[0].contacts > 0);
  const auto forces = two.at({press(0.006, touching), press(-0.003, 0.004)});
  CHECK(top_near(two, 0.005) < -0.0003);
  CHECK(forces[0].contacts == 0);
  CHECK(forces[0].force == Vec3::Zero());
  CHECK(two.at({press(0.006, touching), {}})[0].contacts > 0);
}

TEST_CASE(
    "two tools on the very same spot share what one would feel there, 1 mm apart they feel more together") {
  // The tissue is pressed by the same sphere, so it gives the same force, whoever carries how much of it.
  for (const double depth : {0.0005, 0.002, 0.003}) {
    CAPTURE(depth);
    const Vec3 place = press(0.0013, depth);
    Block alone(1), two(2), in_turn(2);
    const Vec3 single = alone.at({place})[0].force;
    in_turn.at({{}, place});
    for (const auto& forces : {two.at({place, place}), in_turn.at({place, place})}) {
      CHECK(relative(forces[0].force + forces[1].force, single) < 1e-6);
      CHECK(forces[0].flagged == forces[1].flagged);
      for (const ToolForce& force : forces) CHECK(force.force.dot(single) >= 0);
    }
    const Vec3 beside = place + Vec3(0.001, 0, 0);
    const auto spacing = Block(2).at({place, beside});
    const double other = Block(1).at({beside})[0].force[1];
    CHECK_FALSE(spacing[0].flagged);
    CHECK_FALSE(spacing[1].flagged);
    for (const ToolForce& force : spacing) CHECK(force.force[1] >= 0);
    // Each helps the other to hold the tissue down.
    constexpr double kRounding = 1 + 1e-9;  // the first touch may be of one alone
    CHECK(spacing[0].force[1] < kRounding * single[1]);
    CHECK(spacing[1].force[1] < kRounding * other);
    CHECK(kRounding * (spacing[0].force[1] + spacing[1].force[1]) > std::max(single[1], other));
  }
}

TEST_CASE("two tools that go on as they went look for contact from where that leads, as one tool does") {
  // Newton's method takes few steps more from there than for one tool, as neither foretells what the other
  // does to the surface under it; from where the surface was it takes 1.39 and, with friction, 1.85 times as
  // many.
  const double friction = GENERATE(0.0, 0.3);
  const auto steps_of = [&](std::size_t tools) {
    Scene scene = test::wide_block_scene(tools, kRadius);
    for (ToolSettings& tool : scene.tools) tool.shape.friction = friction;
    Simulation block(scene, test::wide_block());
    int steps = 0;
    for (int i = 0; i <= 50; ++i) {
      const double slid = 0.0002 * std::max(0, i - 10), depth = 0.0002 * std::min(i, 10);
      Places places;
      for (std::size_t k = 0; k < tools; ++k)
        places.push_back(press(slid - 0.014 + 0.02 * static_cast<double>(k), depth));
      for (const ToolAnswer& answer : block.step(test::inputs(places), kDt)) {
        CHECK_FALSE(answer.flagged);
        if (i > 10) steps += answer.iterations;
      }
    }
    return static_cast<double>(steps) / static_cast<double>(tools);
  };
  const double one = steps_of(1), two = steps_of(2);
  CAPTURE(friction, one, two);
  CHECK(two < (friction > 0 ? 1.6 : 1.3) * one);
}

TEST_CASE("two tools on a rigid organ do not feel each other") {
  Block two(2, "rigid"), alone(1, "rigid");
  const auto forces = two.at({press(-0.004, 0.002), press(0.004, 0.003)});
  CHECK(forces[0].force == alone.at({press(-0.004, 0.002)})[0].force);
  test::lift_tools(alone);
  CHECK(forces[1].force == alone.at({press(0.004, 0.003)})[0].force);
}

TEST_CASE("tools of their own size and reach: compliance is kept for what either can reach") {
  const auto compliance = [](const Simulation& simulation) { return simulation.memory().front().bytes; };
  Scene left = test::wide_block_scene(1, kRadius), right = test::wide_block_scene(1, kRadius),
        both = test::wide_block_scene(2, kRadius), overlapping = test::wide_block_scene(2, kRadius);
  const Box west{Vec3(-1, -0.001, -1), Vec3(-0.021, 1, 1)}, east{Vec3(0.021, -0.001, -1), Vec3(1, 1, 1)};
  left.tools[0].reach = both.tools[0].reach = overlapping.tools[0].reach = overlapping.tools[1].reach = west;
  right.tools[0].reach = both.tools[1].reach = east;
  both.tools[1].shape.radius = 0.003;
  const auto nodes = [&](const Scene& s) {
    return std::sqrt(static_cast<double>(compliance(Simulation(s, test::wide_block()))) / 72);
  };
  CHECK(nodes(both) == nodes(left) + nodes(right));
  CHECK(nodes(overlapping) == nodes(left));
  // Each touches where it reaches, with its own radius, and nowhere else.
  Simulation simulation(both, test::wide_block());
  const Places swapped{Vec3(0.03, 0.002, 0), Vec3(-0.03, 0.002, 0)};
  for (const ToolForce& force : simulation.step(test::inputs(swapped), kDt)) CHECK(force.contacts == 0);
  test::lift_tools(simulation);
  const Places placed{Vec3(-0.03, 0.004, 0), Vec3(0.03, 0.004, 0)};
  const auto forces = simulation.step(test::inputs(placed), kDt);
  CHECK(forces[0].contacts > 0);
  CHECK(forces[1].contacts == 0);
}

TEST_CASE("two tools: a wild place takes away that tool only") {
  Block two(2), alone(1);
  const Vec3 a = press(-0.006, 0.002);
  two.at({a, press(0.006, 0.002)});
  const auto forces = two.at({a, Vec3(0, std::nan(""), 0)});
  CHECK(forces[1].flagged);
  CHECK(forces[1].force == Vec3::Zero());
  CHECK_FALSE(forces[0].flagged);
  CHECK(relative(forces[0].force, alone.at({a})[0].force) < 1e-6);
}

TEST_CASE("any paths of two tools give finite forces, in settled answers but for a few") {
  Block two(2);
  test::Random random(3);
  int flagged = 0, both = 0, most = 0;
  Vec3 a = press(-0.01, 0), b = press(0.01, 0);
  for (int i = 0; i < 400; ++i) {
    a += random.vector(0.002), b += random.vector(0.002);
    a = a.cwiseMax(Vec3(-0.03, 0.0005, -0.01)).cwiseMin(Vec3(0.03, 0.01, 0.01));
    b = b.cwiseMax(Vec3(-0.03, 0.0005, -0.01)).cwiseMin(Vec3(0.03, 0.01, 0.01));
    const auto forces = two.at({a, b});
    for (const ToolForce& force : forces) {
      REQUIRE(force.force.allFinite());
      flagged += force.flagged ? 1 : 0;
      most = std::max(most, force.iterations);
    }
    both += forces[0].contacts > 0 && forces[1].contacts > 0 ? 1 : 0;
  }
  CAPTURE(most, flagged, both);
  CHECK(both > 50);
  CHECK(flagged < 8);
  CHECK(most <= 1000);
}

TEST_CASE("steps of eight tools in contact do not allocate, and leave the tissue at rest when all go") {
  Scene made = test::wide_block_scene(8, kRadius);
  made.tools[0].shape.radius = 0.001;  // its own patch is small: the loads of the others need room with it
  Simulation eight(made, test::wide_block());
  const std::uint64_t rest = eight.state_hash();
  std::vector<ToolInput> all(8), some(8), none(8);
  for (int i = 0; i < 8; ++i) {
    all[i].pose = press(0.009 * i - 0.0315, 0.004);
    if (i % 3 == 1) some[i].pose = press(0.009 * i - 0.0305, 0.003);
  }
  all[0].pose = Vec3(-0.0315, -0.001, 0.0013);
  std::size_t allocations = 1;
  int contacts = 0;
  {
    const test::AllocationGuard guard;
    for (const ToolForce& force : eight.step(all, kDt)) contacts += force.contacts > 0 ? 1 : 0;
    eight.step(some, kDt);
    eight.step(all, kDt);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  CHECK(contacts == 8);
  eight.step(some, kDt);
  eight.step(none, kDt);
  CHECK(eight.state_hash() == rest);
}
