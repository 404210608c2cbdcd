// How far tools get: boxes, workspaces of devices, cones of trocars; and that what is left out for it costs
// nothing in force.
#include "sim_server/scene/tool_reach.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "common/error.h"
#include "common/trajectory.h"
#include "sim_server/scene/touchable.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kNearer = 0.02;  // m: tissue that deforms

Scene scene_with(const std::string& tool, const std::string& fixed = "") {
  const test::TemporaryFolder folder;
  const std::string mesh = test::source_dir() + "/configs/meshes/liver_paper.msh";
  const auto file = folder.write("scene.toml", "[mesh]\nfile = \"" + mesh +
                                                   "\"\n[deformation]\nmodel = \"quasi_static\"\n"
                                                   "[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.4\n"
                                                   "[[fixed]]\nbox = [[-1, -1, -1], [1, 1, -0.06]]\n" +
                                                   fixed + "[[tool]]\n" + tool);
  return read_scene(file);
}

Box box_of(const Scene& scene) {
  return std::get<Box>(*scene.tools[0].reach);
}

bool close(const Vec3& a, const Vec3& b) {
  return (a - b).norm() < 1e-12;
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("tool reach: a device's workspace, placed, turned and scaled, with the tool's size around it") {
  const std::string placed = "[tool.workspace]\nbox = [[-0.01, -0.02, -0.03], [0.01, 0.02, 0.04]]\n";
  SECTION("as it is") {
    const Box box = box_of(scene_with("radius = 0.005\n" + placed));
    CHECK(close(box.min, Vec3(-0.01, -0.02, -0.03) - Vec3::Constant(0.005 + kNearer)));
    CHECK(close(box.max, Vec3(0.01, 0.02, 0.04) + Vec3::Constant(0.005 + kNearer)));
  }
  SECTION("world x is the device's y, world y its -x; twice as large; elsewhere") {
    const Box box = box_of(scene_with("radius = 0.005\n" + placed +
                                      "axes = [\"y\", \"-x\", \"z\"]\nscale = 2\noffset = [1, 0, 0]\n"));
    CHECK(close(box.min, Vec3(0.96, -0.02, -0.06) - Vec3::Constant(0.025)));
    CHECK(close(box.max, Vec3(1.04, 0.02, 0.08) + Vec3::Constant(0.025)));
  }
  SECTION("a capsule lies any way around its tip; an instrument reaches to its pivot") {
    const Box lain = box_of(scene_with("radius = 0.005\nshape = \"capsule\"\nlength = 0.03\n" + placed));
    CHECK(close(lain.max, Vec3(0.01, 0.02, 0.04) + Vec3::Constant(0.055)));
    const Box turned =
        box_of(scene_with("radius = 0.005\nshape = \"trocar\"\npivot = [0, 0.3, 0]\n" + placed));
    CHECK(close(turned.max, Vec3(0.01, 0.3, 0.04) + Vec3::Constant(0.025)));
  }
  SECTION("supports that move bring the organ nearer") {
    const std::string moves =
        "[[fixed.motion]]\ndirection = [0, 1, 0]\namplitude = 0.004\nperiod = 4\n"
        "[[fixed.motion]]\ndirection = [1, 0, 0]\namplitude = 0.003\nperiod = 3\n";
    const Box box = box_of(scene_with("radius = 0.005\n" + placed, moves));
    CHECK(close(box.max, Vec3(0.01, 0.02, 0.04) + Vec3::Constant(0.025 + 0.007)));
  }
}

TEST_CASE("tool reach: a cone meets each triangle that has a place in it, and none that is far from it") {
  test::Random random(21);
  for (const double tilt : {20.0, 90.0, 140.0, 180.0}) {
    const Cone cone{Vec3(0.01, 0.02, -0.03), Vec3(1, -2, 0.5).normalized(), tilt * std::numbers::pi / 180,
                    0.1, 0.004};
    std::vector<Vec3> inside;
    while (inside.size() < 4000) {
      const Vec3 from = random.vector(cone.depth);
      if (from.norm() <= cone.depth && std::acos(cone.axis.dot(from) / from.norm()) <= cone.half_angle)
        inside.push_back(cone.apex + from);
    }
    int far = 0;
    for (int round = 0; round < 2000; ++round) {
      const Vec3 a = cone.apex + random.vector(0.15), b = a + random.vector(0.01),
                 c = a + random.vector(0.01);
      double nearest = 1;
      for (const Vec3& x : inside) nearest = std::min(nearest, (x - (a + b + c) / 3).norm());
      if (nearest < cone.around) CHECK(may_touch(cone, a, b, c));
      const double size = std::max((b - a).norm(), (c - a).norm());
      // The places are nearly 10 mm apart where they are sparse.
      const bool away = nearest > cone.around + size + 0.012;
      far += away;
      if (away) CHECK_FALSE(may_touch(cone, a, b, c));
    }
    if (tilt < 100) CHECK(far > 200);
  }
}

TEST_CASE(
    "tool reach: a cone reaches so far around itself, and no farther: beside it, beyond it, behind it") {
  const Cone cone{Vec3::Zero(), Vec3::UnitX(), std::numbers::pi / 6, 0.1, 0.004};
  const Vec3 edge(std::sqrt(0.75), 0.5, 0), out(-0.5, std::sqrt(0.75), 0);
  const auto touched = [&](const Vec3& x) { return may_touch(cone, x, x, x); };
  for (const double off : {0.0, 0.0039, 0.0041, 0.05}) {
    CAPTURE(off);
    CHECK(touched(0.05 * edge + off * out) == (off < 0.004));
    CHECK(touched((0.1 + off) * Vec3::UnitX()) == (off < 0.004));
    CHECK(touched(-off * Vec3::UnitX()) == (off < 0.004));
  }
}

TEST_CASE(
    "tool reach: a tip beyond its workspace or cone is told from one within, a plain reach is of surface") {
  const Scene placed =
      scene_with("radius = 0.005\n[tool.workspace]\nbox = [[-0.01, -0.02, -0.03], [0.01, 0.02, 0.04]]\n");
  CHECK(placed.tools[0].stays_within);
  for (const double off : {-0.001, 0.001}) {  // around what is added to the box: radius and 20 mm
    CAPTURE(off);
    CHECK(beyond(*placed.tools[0].reach, {0.035 + off, 0, 0}) == (off > 0));
    CHECK(beyond(*placed.tools[0].reach, {0, 0, -0.055 - off}) == (off > 0));
  }
  const Reach cone = Cone{Vec3::Zero(), Vec3::UnitX(), std::numbers::pi / 6, 0.1, 0.004};
  CHECK_FALSE(beyond(cone, {0.1035, 0, 0}));
  CHECK(beyond(cone, {0.1045, 0, 0}));
  CHECK(beyond(cone, {0.02, 0.03, 0}));
  CHECK_FALSE(beyond(cone, {-0.0045, 0, 0}));  // drawn out of the body
  CHECK_FALSE(scene_with("radius = 0.005\nreach = [[-1, -1, -1], [1, 1, 1]]\n").tools[0].stays_within);
}

TEST_CASE("tool reach: the scenes that ship leave much of the liver out, and lose nothing of the force") {
  for (const char* name : {"liver_falcon", "liver_trocar"}) {
    DYNAMIC_SECTION(name) {
      const Scene scene = read_scene(test::source_dir() + "/configs/scenes/" + name + ".toml");
      Scene entire = scene;
      entire.tools[0].reach.reset();
      Simulation some(scene), all(entire);
      const auto nodes = [](const Simulation& simulation, const Scene& of) {
        return reachable_vertices(simulation.surface(), simulation.mesh(), of.tools).size();
      };
      CHECK(10 * nodes(some, scene) < 8 * nodes(all, entire));
      const Trajectory motion(
          TrajectorySettings{.file = test::source_dir() + "/configs/trajectories/liver_paper.csv"});
      double most = 0, off = 0;
      for (int i = 0; i < 600; ++i) {
        const Vec3 place = motion.at(i / 30.0);
        const Vec3 a = some.step(place, 1.0 / 30).force, b = all.step(place, 1.0 / 30).force;
        most = std::max(most, b.norm());
        off = std::max(off, (a - b).norm());
      }
      CAPTURE(most, off);
      CHECK(most > 0.1);
      CHECK(off <= 1e-9 * most);
    }
  }
}

TEST_CASE("tool reach: a tool that reaches nothing has no collision tree, and the others work as before") {
  const std::string near = "radius = 0.005\n",
                    away = "[[tool]]\nradius = 0.005\nreach = [[5, 5, 5], [6, 6, 6]]\n";
  const Scene scene = scene_with(near + away);
  Simulation two(scene), one(scene_with(near));
  CHECK(two.touchable(1).empty());
  const auto memory = two.memory();
  const auto bytes = [&](const std::string& part) {
    return std::ranges::find_if(memory, [&](const MemoryPart& p) { return p.name == part; })->bytes;
  };
  CHECK(2 * bytes("contact of tool 2") < bytes("contact of tool 1"));
  for (int i = 0; i < 10; ++i) {
    const Vec3 place(-0.02, 0.11 - 0.005 * i, 0);
    const std::optional<ToolPose> places[] = {ToolPose(place), ToolPose(place + Vec3(0.001, 0, 0))};
    const auto forces = two.step(test::inputs(places), 1.0 / 30);
    CHECK(forces[0].force == one.step(place, 1.0 / 30).force);
    CHECK(forces[1].force == Vec3::Zero());
  }
  CHECK(one.tool(0).force().contacts > 0);
}

TEST_CASE("tool reach: what is wrong with it is said in one line") {
  const std::string workspace = "[tool.workspace]\n";
  const auto refused = [](const std::string& tool, const char* says) {
    const std::string said = error_of([&] { scene_with(tool); });
    CAPTURE(said, says);
    CHECK(said.find(says) != std::string::npos);
    CHECK(said.find("scene.toml:") != std::string::npos);
  };
  refused(workspace + "device = \"falkon\"\n", "falcon");
  refused(workspace + "offset = [0, 0, 0]\n", "device");
  refused(workspace + "device = \"falcon\"\nbox = [[0, 0, 0], [1, 1, 1]]\n", "remove `device`");
  refused(workspace + "device = \"falcon\"\naxes = [\"x\", \"y\", \"y\"]\n", "once each");
  refused(workspace + "device = \"falcon\"\nclutch = 1\n", "clutch");
  refused("reach = [[0, 0, 0], [1, 1, 1]]\n" + workspace + "device = \"falcon\"\n", "keep one");
  refused("[tool.cone]\naxis = [0, -1, 0]\ntilt = 30\ndepth = 0.1\n", "trocar");
  const std::string trocar = "shape = \"trocar\"\npivot = [0, 0.3, 0]\n[tool.cone]\n";
  refused(trocar + "axis = [0, 0, 0]\ntilt = 30\ndepth = 0.1\n", "no direction");
  refused(trocar + "axis = [0, -1, 0]\ntilt = 0\ndepth = 0.1\n", "tilt");
  refused(trocar + "axis = [0, -1, 0]\ntilt = 30\n", "depth");
  const Scene nowhere = scene_with("reach = [[5, 5, 5], [6, 6, 6]]\n");
  CHECK(error_of([&] { Simulation{nowhere}; }).find("within the tool's reach") != std::string::npos);
}
