// Tools that grasp, and the organ on a spring.
#include <array>
#include <fmt/format.h>

#include "common/error.h"
#include "sim_server/contact/tool_contact.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/models/rigid.h"
#include "sim_server/models/spring.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/served_tools.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kDt = 0.03;
constexpr std::array kCells{10, 4, 10};
const Vec3 kPlace(0.001, 0.005, 0.0005);  // the tool touches the top, y = 0

Scene grasping_scene(const std::string& model = "quasi_static") {
  Scene scene = test::little_block_scene(model);
  scene.tools[0].grasp_place = kPlace;
  return scene;
}

const Vec3 kStiffness(40, 50, 60);
constexpr double kHardening = 0.07;

Scene spring_scene() {
  Scene scene = grasping_scene("spring");
  scene.deformation.of<SpringSettings>().stiffness = kStiffness;
  scene.deformation.of<SpringSettings>().hardening_length = kHardening;
  return scene;
}

/// The spring's formula at a stretch `x`: what the tool feels, and its slope.
Vec3 pull_of(const Vec3& x) {
  const double ratio = x.dot(kStiffness.cwiseProduct(x)) / kStiffness.mean() / (kHardening * kHardening);
  return -(1 + ratio) * kStiffness.cwiseProduct(x);
}

Mat3 slope_of(Simulation& organ, const Vec3& p) {
  constexpr double kStep = 1e-6;
  Mat3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = kStep * Vec3::Unit(axis);
    slope.col(axis) = (organ.step(p + d, kDt).force - organ.step(p - d, kDt).force) / (2 * kStep);
  }
  return slope;
}

}  // namespace

TEST_CASE("a grasped organ on a spring pulls by the spring's formula, with its exact tangent") {
  Simulation organ(spring_scene(), test::little_block(kCells));
  test::Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Vec3 x = random.vector(0.04);
    const ToolForce rendered = organ.step(kPlace + x, kDt);
    CHECK_FALSE(rendered.flagged);
    CHECK((rendered.force - pull_of(x)).norm() < 1e-6 * pull_of(x).norm());
    Mat3 right;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 d = 1e-6 * Vec3::Unit(axis);
      right.col(axis) = (pull_of(x + d) - pull_of(x - d)) / 2e-6;
    }
    CHECK((rendered.tangent - right).norm() < 1e-6 * right.norm());
    CHECK((rendered.tangent - rendered.tangent.transpose()).norm() < 1e-9 * right.norm());
  }
  CHECK(organ.step(kPlace, kDt).force.norm() < 1e-9);
}

TEST_CASE("grasped tissue: linear, both ways, with the slope of the force as tangent") {
  Simulation organ(grasping_scene(), test::little_block(kCells));
  const Vec3 x(0.002, 0.003, -0.001);  // up: away from the tissue
  const ToolForce once = organ.step(kPlace + x, kDt), twice = organ.step(kPlace + 2 * x, kDt);
  REQUIRE(once.contacts > 3);
  CHECK(once.force[1] < -0.1);  // it pulls back
  CHECK((twice.force - 2 * once.force).norm() < 1e-9 * twice.force.norm());
  CHECK((once.tangent * x - once.force).norm() < 1e-9 * once.force.norm());
  CHECK((organ.step(kPlace - x, kDt).force + once.force).norm() < 1e-9 * once.force.norm());
  CHECK((slope_of(organ, kPlace + x) - once.tangent).norm() < 1e-6 * once.tangent.norm());
  const ToolForce held = organ.step(kPlace + x, kDt);
  int moved = 0;  // what it holds came along as one
  for (std::size_t v = 0; v < organ.positions().size(); ++v) {
    const Vec3& rest = organ.mesh().vertices[organ.surface().vertices[v]];
    moved += (organ.positions()[v] - rest - x).norm() < 1e-6 ? 1 : 0;
  }
  CHECK(moved == held.contacts);
}

TEST_CASE("a grip on a wall that only answers to penetration has that stiffness") {
  Scene scene = grasping_scene("rigid");
  scene.deformation.of<RigidSettings>().stiffness = 700;
  Simulation wall(scene, test::little_block(kCells));
  const Vec3 x(0.001, 0.002, -0.003);
  CHECK((wall.step(kPlace + x, kDt).force + 700 * x).norm() < 1e-5);
}

TEST_CASE("a button closes the jaws without a jump, and opens them") {
  Scene scene = grasping_scene();
  scene.tools[0].grasp_place.reset();
  scene.tools[0].grasp_buttons = 6;
  Simulation organ(scene, test::little_block(kCells));
  const Vec3 pressed = kPlace - Vec3(0, 0.0015, 0), above = kPlace + Vec3(0, 0.002, 0);
  const ToolForce contact = organ.step(pressed, kDt);
  REQUIRE(contact.force[1] > 0.05);
  const auto step = [&](const Vec3& p, std::uint16_t buttons) {
    return test::step(organ, p, {.buttons = buttons}, kDt);
  };
  constexpr std::uint16_t kOther = 1;  // not one of them
  CHECK((step(pressed, kOther).force - contact.force).norm() < 1e-6 * contact.force.norm());
  CHECK(step(above, kOther).force == Vec3::Zero());
  step(pressed, kOther);
  const ToolForce grasped = step(pressed, 4);
  CHECK((grasped.force - contact.force).norm() < 1e-4 * contact.force.norm());
  CHECK(step(above, 4).force[1] < -0.05);
  CHECK(step(above, 0).force == Vec3::Zero());
  CHECK((step(pressed, 0).force - contact.force).norm() < 1e-4 * contact.force.norm());
  // Closed on nothing, it holds nothing.
  step(kPlace + Vec3(0, 0.01, 0), 0);
  CHECK(step(kPlace + Vec3(0, 0.01, 0), 2).force == Vec3::Zero());
  CHECK((step(pressed, 2).force - contact.force).norm() < 1e-3 * contact.force.norm());
}

TEST_CASE("served: the buttons of a tool state grasp, parts are told without effect, or allocation") {
  Scene scene = grasping_scene();
  scene.tools[0].grasp_place.reset();
  scene.tools[0].grasp_buttons = 1;
  Simulation organ(scene, test::little_block(kCells));
  ServedTools tools(organ);
  std::vector<SessionInput> inputs{{7, {.tick = 1}, true}};
  auto& state = inputs[0].state;
  using protocol::ForceSample;
  state.flags = protocol::ToolState::kRequestsTangent | protocol::ToolState::kRequestsAhead;
  state.lead_ns = 20'000'000;
  state.v_W = {0.05, 0, 0};
  state.p_W = kPlace;
  state.buttons = 1;
  tools.step(inputs, kDt);
  state.p_W = kPlace + Vec3(0, 0.003, 0);
  ForceSample sample;
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    sample = *tools.step(inputs, kDt)[0].answer;
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  CHECK((sample.flags & ForceSample::kInContact) != 0);
  CHECK(sample.f_W[1] < -0.05);
  CHECK(sample.at_tool.gap == 0);
  const Vec3 way = sample.ahead_p_W - sample.p_W;
  CHECK(way[0] == Approx(0.001));
  CHECK((sample.ahead_f_W - sample.f_W - way[0] * sample.at_tool.tangent.col(0)).norm() < 1e-9);
  CHECK((tools.step(inputs, kDt)[0].answer->f_W - sample.f_W).norm() < 1e-9);
}

TEST_CASE("a grip that cannot be is refused in one line") {
  Scene scene = grasping_scene();
  scene.tools[0].grasp_place = Vec3(0, 0.02, 0);
  scene.tools[0].grasp_where = "scene.toml:9";
  const auto set_up = [&](const Scene& wrong) {
    try {
      const Simulation organ(wrong, test::little_block(kCells));
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  CHECK(
      set_up(scene) ==
      "scene.toml:9: no vertex of the surface that the tool may touch lies within 6.25 mm of `grasp_place`");
  Scene spring = grasping_scene("spring");
  spring.deformation.where = "scene.toml:5";
  spring.deformation.of<SpringSettings>().stiffness.reset();
  CHECK(set_up(spring) == "scene.toml:5: model \"spring\" needs `spring_stiffness`, [x, y, z] in N/m");
  const test::TemporaryFolder folder;
  folder.write("organ.msh", "");
  const auto file = folder.write("scene.toml",
                                 "[mesh]\nfile = \"organ.msh\"\n[deformation]\nmodel = \"rigid\"\n[[tool]]\n"
                                 "grasp_buttons = 1\ngrasp_place = [0, 0, 0]\n");
  const std::string both =
      file.string() + ":7: a tool grasps by `grasp_buttons` or always, from `grasp_place` on; remove one";
  CHECK_THROWS_WITH(read_scene(file), both);
}

TEST_CASE("of a patch that a tool holds a cut leaves the triangles that are still there, and no others") {
  const TetMesh mesh = test::little_block(kCells);
  const Surface surface = boundary_surface(mesh);
  std::vector<Vec3> rest;
  for (const int v : surface.vertices) rest.push_back(mesh.vertices[v]);
  ToolContact tool(grasping_scene().tools[0], rest, surface, surface.triangles, {}, true);
  REQUIRE(tool.holds());
  // Of its patch where one vertex is lifted by a millimetre.
  const auto strain = [&](int vertex) {
    std::vector<Vec3> positions = rest;
    positions[vertex] += Vec3(0, 1e-3, 0);
    return tool.surface_strain(positions, rest);
  };
  const auto has = [](const Triangle& t, int vertex) { return std::ranges::find(t, vertex) != t.end(); };
  const int gone = static_cast<int>(
      std::ranges::min_element(rest, {}, [](const Vec3& x) { return (x - kPlace).norm(); }) - rest.begin());
  std::vector<int> left;  // in its patch, of no triangle that goes
  for (int v = 0; v < static_cast<int>(rest.size()); ++v) {
    const bool beside =
        std::ranges::any_of(surface.triangles, [&](const Triangle& t) { return has(t, v) && has(t, gone); });
    if (!beside && strain(v) > 0) left.push_back(v);
  }
  REQUIRE(strain(gone) > 0);
  REQUIRE(left.size() > 3);
  std::vector<double> before;
  for (const int v : left) before.push_back(strain(v));
  std::vector<Triangle> touchable = surface.triangles;
  std::erase_if(touchable, [&](const Triangle& t) { return has(t, gone); });
  const Surface cut{surface.vertices, touchable, surface.per_face};
  tool.change_surface({rest, cut, [&](int v) { return v != gone; }}, touchable);
  CHECK(tool.holds());
  CHECK(strain(gone) == 0);
  for (std::size_t i = 0; i < left.size(); ++i) CHECK(strain(left[i]) == before[i]);
}

TEST_CASE("loads follow a cut: a vertex and its copies bear what the vertex bore, in their order") {
  const Surface surface;
  const std::vector<Split> splits{{3, 10}, {5, 11}, {10, 12}};
  const SurfaceChange change{{}, surface, [](int v) { return v != 5; }, splits};
  const Vec3 force(4, -8, 12);
  std::vector<VertexLoad> loads{{5, Vec3(2, 0, 0)}, {3, force}, {7, Vec3(0, 1, 0)}};
  change.apply_to(loads);
  const std::vector<std::pair<int, Vec3>> right{
      {3, force / 2}, {7, Vec3(0, 1, 0)}, {10, force / 4}, {11, Vec3(1, 0, 0)}, {12, force / 4}};
  REQUIRE(loads.size() == right.size());
  for (std::size_t i = 0; i < right.size(); ++i) {
    CHECK(loads[i].vertex == right[i].first);
    CHECK(loads[i].force == right[i].second);
  }
  CHECK(change.origins() == std::map<int, int>{{10, 3}, {11, 5}, {12, 3}});
}

TEST_CASE("loads follow a cut: those of each tool that presses on a vertex that becomes two") {
  const Surface surface;
  const std::vector<Split> splits{{3, 10}};
  const SurfaceChange change{{}, surface, [](int) { return true; }, splits};
  std::vector<VertexLoad> loads{{3, Vec3(2, 0, 0)}, {3, Vec3(0, 6, 0)}};
  change.apply_to(loads);
  std::map<int, Vec3> sums{{3, Vec3::Zero()}, {10, Vec3::Zero()}};
  for (const VertexLoad& load : loads) sums.at(load.vertex) += load.force;
  CHECK(sums.at(3) == Vec3(1, 3, 0));
  CHECK(sums.at(10) == Vec3(1, 3, 0));
}

TEST_CASE(
    "full jaws keep what they hold where a copy leaves at once, and a copy takes the room of its vertex") {
  // A square of four vertices, of which one becomes two: vertex 4 lies where vertex 0 does.
  const std::vector<Vec3> rest{{0, 0, 0}, {1e-3, 0, 0}, {1e-3, 0, 1e-3}, {0, 0, 1e-3}, {0, 0, 0}};
  const std::vector<Triangle> triangles{{0, 2, 1}, {0, 3, 2}};
  const std::vector<Split> splits{{0, 4}};
  const Surface surface{{0, 1, 2, 3, 4}, triangles, 1};
  ToolSettings jaws;
  jaws.shape.radius = 0.005;
  jaws.grasp_place = Vec3(4e-4, 0, 4e-4);
  for (const int gone : {4, 0}) {
    CAPTURE(gone);
    Grip grip(jaws, rest, triangles, 4);
    REQUIRE(grip.vertices().size() == 4);
    grip.change_surface({rest, surface, [gone](int v) { return v != gone; }, splits}, triangles);
    std::vector<int> held(grip.vertices().begin(), grip.vertices().end());
    std::ranges::sort(held);
    CHECK(held == (gone == 4 ? std::vector<int>{0, 1, 2, 3} : std::vector<int>{1, 2, 3, 4}));
  }
}
