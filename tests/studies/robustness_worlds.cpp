// Rows of the robustness study: tools that turn, pivot, grasp and rub. What each is held against is another
// code path or none of the program's: a sphere in the place of a capsule, the same world turned, virtual
// work, Coulomb's cone, the first law, an equilibrium without contact.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <numbers>

#include "tests/studies/robustness.h"
#include "tests/support/solids.h"

namespace palpate::studies {
namespace {

using Eigen::AngleAxisd;
using sim::ToolInput;

constexpr double kQuarter = std::numbers::pi / 2;
const Quat kUpright(AngleAxisd(-kQuarter, Vec3::UnitX()));  // the axis of a capsule from its tip upwards

std::string capsule(double length, const std::string& more = "") {
  return tool(kToolRadius, fmt::format("shape = \"capsule\"\nlength = {}\n{}", length, more));
}

/// Flat on the block, then turned about the vertical by 60 degrees and lifted at one end by 10, as it goes.
ToolPose rolled_pose(const Direction& way, double t) {
  const double fraction = std::min(t / way.seconds(), 1.0);
  const Quat turn(AngleAxisd(fraction * std::numbers::pi / 3, Vec3::UnitY()));
  const Quat tilt(AngleAxisd(-fraction * std::numbers::pi / 18, Vec3::UnitX()));
  return {way.at(t), turn * tilt};
}

World rolled(const Setting& setting, const std::string& more) {
  const Direction way = press_and_draw(setting, Vec3(0.004, 0, -0.004));
  World world = under_tool(setting, way);
  world.file.tools = {capsule(0.012, more)};
  world.hands = [way](double t) {
    const ToolPose pose = rolled_pose(way, t);
    return std::vector<ToolInput>{at(pose.p_W, pose.q_W)};
  };
  return world;
}

Verdict capsule_on_end(const Setting& setting, const Column& column) {
  const Direction way = press_and_draw(setting, Vec3(0.004, 0, 0));
  World ball = under_tool(setting, way);
  ball.file.tools = {tool(kToolRadius, "friction = 0.3")};
  World upright = ball;
  upright.file.tools = {capsule(0.05, "friction = 0.3\n")};
  upright.hands = [way](double t) { return std::vector<ToolInput>{at(way.at(t), kUpright)}; };
  return compare(watch(upright, column), force_of, as_in(watch(ball, column), force_of), kSame,
                 "the same model under a sphere");
}

Verdict capsule_reversed(const Setting& setting, const Column& column) {
  const World world = rolled(setting, "");
  World reversed = world;
  const Tool shape{.radius = kToolRadius, .length = 0.012};
  reversed.hands = [hands = world.hands, shape](double t) {
    std::vector<ToolInput> inputs = hands(t);
    ToolPose& pose = *inputs.front().pose;
    pose = ToolPose(far_end(shape, pose), pose.q_W * Quat(AngleAxisd(2 * kQuarter, Vec3::UnitX())));
    return inputs;
  };
  const Published about_other_end = [shape](const Rendered& rendered) -> Vectors {
    const Vec3 arm = rendered.poses.front().p_W - far_end(shape, rendered.poses.front());
    return {rendered.force.front(), rendered.torque.front() + arm.cross(rendered.force.front())};
  };
  return compare(watch(reversed, column), force_and_torque_of, as_in(watch(world, column), about_other_end),
                 kSame, "the same model under the same capsule, its tip the other end");
}

/// x to y, y to z, z to x.
Mat3 cycle() {
  Mat3 cycle = Mat3::Zero();
  cycle(1, 0) = cycle(2, 1) = cycle(0, 2) = 1;
  return cycle;
}

Verdict world_turned(const Setting& setting, const Column& column) {
  const World world = rolled(setting, "friction = 0.3\n");
  World turned = world;
  const Mat3 turn = cycle();
  turned.mesh = test::mapped(world.mesh, [turn](const Vec3& x) -> Vec3 { return turn * x; });
  turned.file.fixed = fmt::format("[[fixed]]\nbox = [[-1, -1, {0}], [1, 1, {0}]]\n", -setting.thickness);
  turned.hands = [hands = world.hands, turn](double t) {
    std::vector<ToolInput> inputs = hands(t);
    ToolPose& pose = *inputs.front().pose;
    pose = ToolPose(turn * pose.p_W, Quat(turn) * pose.q_W);
    return inputs;
  };
  const Published back = [turn](const Rendered& rendered) -> Vectors {
    return {turn.transpose() * rendered.force.front(), turn.transpose() * rendered.torque.front()};
  };
  return compare(watch(turned, column), back, as_in(watch(world, column), force_and_torque_of), kSame,
                 "the same model, turned with everything in it");
}

/// Spheres so near each other that what lies between them is 0.8 % of the radius further in.
Verdict capsule_as_spheres(const Setting& setting, const Column& column) {
  const Direction way = press_and_draw(setting, Vec3(0.002, 0, 0));
  World world = under_tool(setting, way);
  constexpr int kSpheres = 8;
  const Vec3 apart(0, 0, 0.001);
  World spheres = world;
  world.file.tools = {capsule((kSpheres - 1) * apart[2])};
  spheres.file.tools = std::vector<std::string>(kSpheres, tool(kToolRadius));
  spheres.hands = [way, apart](double t) {
    std::vector<ToolInput> inputs;
    for (int i = 0; i < kSpheres; ++i) inputs.push_back(at(way.at(t) + i * apart));
    return inputs;
  };
  const Published sum = [apart](const Rendered& rendered) -> Vectors {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = 0; i < rendered.force.size(); ++i) {
      force += rendered.force[i];
      torque += (static_cast<double>(i) * apart).cross(rendered.force[i]);
    }
    return {force, torque};
  };
  // Nothing tells how much each sphere bears of an organ that goes as one; of a rigid one each bears all.
  if (!column.row->deforms()) {
    const Vec3 rendered = 800 * setting.depth * Vec3::UnitY();
    return compare(watch(world, column), force_of, at_the_end(world, {rendered}), kSame,
                   "closed form: stiffness x depth");
  }
  return compare(watch(world, column), force_and_torque_of, as_in(watch(spheres, column), sum), kBound,
                 "the same model under eight spheres in its place");
}

Verdict trocar_far(const Setting& setting, const Column& column) {
  const World ball = under_tool(setting, press_and_draw(setting, Vec3(0.004, 0, 0)));
  World trocar = ball;
  trocar.file.tools = {tool(kToolRadius, "shape = \"trocar\"\npivot = [0, 10, 0]\nshaft_radius = 0.004")};
  return compare(watch(trocar, column), force_of, as_in(watch(ball, column), force_of), kSame,
                 "the same model under a sphere");
}

const Vec3 kPivot(0.001, 0.012, 0.05);

/// The shaft lies on the block; the tip goes down, and along.
Direction lever(const Setting& setting) {
  const Vec3 above(0.001, 0.008, -0.01), in(0.001, kToolRadius - setting.depth, -0.01);
  return {{above, in, in + Vec3(0.004, 0, 0), in + Vec3(0.004, 0, 0.003)}, setting.speed};
}

Verdict trocar_lever(const Setting& setting, const Column& column) {
  const Direction way = lever(setting);
  World trocar = under_tool(setting, way);
  trocar.file.tools = {
      tool(kToolRadius, fmt::format("shape = \"trocar\"\npivot = [{}, {}, {}]\nshaft_radius = {}", kPivot[0],
                                    kPivot[1], kPivot[2], kToolRadius))};
  World lying = trocar;
  lying.file.tools = {capsule(0.035)};
  lying.hands = [way](double t) {
    const Vec3 p = way.at(t), axis = (kPivot - p).normalized();
    return std::vector<ToolInput>{
        at(p, Quat(1 + axis.z(), -axis.y(), axis.x(), 0).normalized())};  // z to axis
  };
  // By virtual work: the hand at the tip bears what the contact turns about the pivot, and what pushes along
  // the axis.
  const Published at_tip = [](const Rendered& rendered) -> Vectors {
    const Vec3 arm = rendered.poses.front().p_W - kPivot, axis = arm.normalized(), f = rendered.force.front();
    const Vec3 about_pivot = rendered.torque.front() + arm.cross(f);
    return {axis * axis.dot(f) + about_pivot.cross(axis) / arm.norm()};
  };
  return compare(watch(trocar, column), force_of, as_in(watch(lying, column), at_tip), kSame,
                 "the same model under a capsule in its place, by virtual work about the pivot");
}

}  // namespace

std::vector<Case> world_cases() {
  std::vector<Case> rows;
  const Setting thin{.name = "_thin", .what = ", 3 mm thick", .thickness = 0.003, .depth = 0.001};
  const Setting fine{.name = "_1000_Hz", .what = ", 1 kHz", .rate_hz = 1000};
  const Setting quick{.name = "_1_m_s", .what = ", at 1 m/s", .speed = 1};
  const Setting hard{.name = "_E_1e9", .what = ", E 1 GPa", .modulus = 1e9};
  add_rows(rows, "capsule_on_end", "a capsule upright, with friction", capsule_on_end, {{}}, true);
  add_rows(rows, "capsule_reversed", "a flat capsule that turns, by its other end", capsule_reversed,
           {{}, hard});
  add_rows(rows, "world_turned", "a flat capsule that turns and rubs, x to y to z", world_turned, {{}, fine},
           true);
  add_rows(rows, "capsule_as_spheres", "a flat capsule", capsule_as_spheres, {{}, thin});
  add_rows(rows, "trocar_far", "a pivot at 10 m", trocar_far, {{}});
  add_rows(rows, "trocar_lever", "a shaft on the block", trocar_lever, {{}, thin, quick}, true);
  add_grips(rows);
  add_two_tools(rows);
  add_supports(rows);
  return rows;
}

}  // namespace palpate::studies
