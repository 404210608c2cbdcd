// Rows of the robustness study: supports that move. Held against the same motion of the tool alone, the same
// world at rest (Galilei), and the same world under gravity (Einstein).
#include <cmath>
#include <fmt/core.h>
#include <numbers>

#include "tests/studies/robustness.h"

namespace palpate::studies {
namespace {

using sim::ToolInput;

/// One [[fixed.motion]].
struct Sway {
  Vec3 direction;
  double amplitude, period, phase;  // m, s, rad
};
using Sways = std::vector<Sway>;

Vec3 at_time(const Sways& sways, double t) {
  Vec3 sum = Vec3::Zero();
  for (const Sway& sway : sways)
    sum += sway.amplitude * std::sin(2 * std::numbers::pi * t / sway.period + sway.phase) *
           sway.direction.normalized();
  return sum;
}

void add_motion(World& world, const Sways& sways) {
  for (const Sway& sway : sways)
    world.file.fixed += fmt::format(
        "[[fixed.motion]]\ndirection = [{}, {}, {}]\namplitude = {}\nperiod = {}\nphase = {}\n",
        sway.direction[0], sway.direction[1], sway.direction[2], sway.amplitude, sway.period, sway.phase);
}

/// Every tool `times` as far as the supports have gone from where they began, besides.
void carry(World& world, const Sways& sways, double times, bool from_rest = false) {
  const Vec3 from = from_rest ? Vec3(Vec3::Zero()) : at_time(sways, 0);
  world.hands = [=, hands = world.hands](double t) {
    std::vector<ToolInput> inputs = hands(t);
    for (ToolInput& input : inputs) input.pose->p_W += times * (at_time(sways, t) - from);
    return inputs;
  };
}

std::optional<Verdict> inapplicable(const Column& column) {
  if (column.row->deforms()) return {};
  return Verdict{"not_applicable", "supports of an organ that does not deform do not move", {}, {}, ""};
}

/// A capsule that rubs, pressed and drawn.
World pressed(const Setting& setting, double seconds) {
  World world = under_tool(setting, press_and_draw(setting, Vec3(0.002, 0, 0)));
  world.seconds = seconds;
  world.file.tools = {
      tool(kToolRadius, fmt::format("shape = \"capsule\"\nlength = 0.008\nfriction = {}", setting.friction))};
  return world;
}

/// The organ comes up to a tool that stands still, and along under it, or the tool goes down to the organ.
Verdict organ_comes(const Setting& setting, const Column& column) {
  if (const auto verdict = inapplicable(column)) return *verdict;
  // Of tissue that moves, what its inertia does is no matter of this.
  if (column.row->moves && setting.speed > 0.05)
    return {"not_applicable", "what inertia adds to so quick a motion has no reference", {}, {}, ""};
  const double period = 2 * std::numbers::pi * 0.004 / setting.speed;
  const Sways sways{{Vec3::UnitY(), 0.002 + setting.depth, period, 0}, {Vec3::UnitX(), 0.002, period / 2, 0}};
  World still = block_of(setting);
  still.seconds = 1.5 * period;
  still.file.tools = {tool(kToolRadius, fmt::format("friction = {}", setting.friction))};
  still.hands = [](double) { return std::vector<ToolInput>{at(Vec3(0.001, kToolRadius + 0.002, 0.002))}; };
  World goes = still;
  carry(goes, sways, -1);
  add_motion(still, sways);
  return compare(watch(still, column), force_of, as_in(watch(goes, column), force_of), kBound,
                 "the same model at rest, and the tool goes instead");
}

/// Organ and tool go along together, evenly: sin(x) - sin(2 x) / 8 is straight up to the fifth power of x.
Verdict organ_carries(const Setting& setting, const Column& column) {
  if (const auto verdict = inapplicable(column)) return *verdict;
  const Vec3 along(0.6, 0.64, 0.48);
  const double period = 2 * std::numbers::pi * 0.75 / setting.speed;
  const Sways sways{{along, 1, period, 0}, {-along, 0.125, period / 2, 0}};
  Setting slow = setting;
  slow.speed = 0.02;
  World resting = pressed(slow, 0.9);
  resting.file.rayleigh_mass = 0;  // it is the resistance of what is around the organ, which rests
  resting.file.rayleigh_stiffness = 0.01;
  World carried = resting;
  carry(carried, sways, 1);
  add_motion(carried, sways);
  return compare(watch(carried, column), force_of, as_in(watch(resting, column), force_of), kBound,
                 "the same model at rest");
}

/// Up with a constant acceleration, nearly: cos(x) - cos(2 x) / 16 has that of x = 0 up to the fourth power.
/// Inertia makes 7 % of the force: 2 % is little enough to see it, and what still swings after 0.3 s is less.
Verdict organ_accelerates(const Setting& setting, const Column& column) {
  if (const auto verdict = inapplicable(column)) return *verdict;
  const double acceleration = 1, period = 2 * std::numbers::pi * std::sqrt(0.75 / acceleration);
  const double quarter = std::numbers::pi / 2;
  const Vec3 up = Vec3::UnitY();
  const Sways sways{{up, 1, period, -quarter}, {up, 1.0 / 16, period / 2, quarter}};
  Setting quick = setting;
  quick.speed = 0.05;
  quick.friction = 0;
  World resting = pressed(quick, 0.5);
  resting.file.material = "density = 20000\n";
  resting.file.rayleigh_mass = 0;
  resting.file.rayleigh_stiffness = 0.03;
  World carried = resting;
  carry(carried, sways, 1, true);
  add_motion(carried, sways);
  const Column* truth = &column;
  if (column.row->moves) resting.file.loads = fmt::format("[[load]]\ngravity = [0, {}, 0]\n", -acceleration);
  for (const Column& other : columns()) {
    if (column.row->moves && column.linear() && other.any_law() && other.linear()) truth = &other;
  }
  return compare(watch(carried, column), force_of, as_in(watch(resting, *truth), force_of, 0.3), 0.02,
                 fmt::format("{} at rest, {} gravity", truth->name, column.row->moves ? "under" : "without"));
}

/// Jaws that stand still, or go along, on an organ that goes to and fro.
Verdict organ_grasped(const Setting& setting, const Column& column, double times) {
  if (const auto verdict = inapplicable(column)) return *verdict;
  const double period = 2 * std::numbers::pi * 0.003 / setting.speed;
  const Sways sways{{Vec3(0.6, 0.64, 0.48), 0.003, period, 0}};
  World grasped = block_of(setting);
  grasped.seconds = 1.5 * period;
  grasped.file.tools = {tool(0.01, "grasp_place = [0, 0.01, 0]")};
  grasped.hands = [](double) { return std::vector<ToolInput>{at(Vec3(0, 0.01, 0))}; };
  World goes = grasped;
  carry(goes, sways, times - 1);
  carry(grasped, sways, times);
  add_motion(grasped, sways);
  return compare(watch(grasped, column), force_of, as_in(watch(goes, column), force_of), kBound,
                 "the same model at rest, and the jaws go instead");
}

Verdict organ_pulls(const Setting& setting, const Column& column) {
  if (column.row->moves && setting.speed > 0.05)
    return {"not_applicable", "what inertia adds to so quick a motion has no reference", {}, {}, ""};
  return organ_grasped(setting, column, 0);
}

/// Half as far as the organ.
Verdict organ_and_jaws(const Setting& setting, const Column& column) {
  if (column.row->moves && setting.speed > 0.05)
    return {"not_applicable", "what inertia adds to so quick a motion has no reference", {}, {}, ""};
  return organ_grasped(setting, column, 0.5);
}

}  // namespace

void add_supports(std::vector<Case>& rows) {
  const Setting slow{.speed = 0.005}, brisk{.speed = 0.1};
  const Setting fine{.name = "_1000_Hz", .what = ", 1 kHz", .rate_hz = 1000, .speed = 0.005};
  const Setting finer{.name = "_1000_Hz", .what = ", 1 kHz", .rate_hz = 1000, .speed = 0.1};
  const Setting hard{.name = "_E_1e9", .what = ", E 1 GPa", .modulus = 1e9, .speed = 0.005};
  const Setting fast{.name = "_0.5_m_s", .what = ", at 0.5 m/s", .speed = 0.5};
  add_rows(rows, "organ_comes", "an organ that comes to a tool that stands still", organ_comes,
           {slow, fine, hard});
  add_rows(rows, "organ_carries", "organ and tool go along together", organ_carries, {brisk, finer, fast},
           true);
  add_rows(rows, "organ_accelerates", "organ and tool go up with 1 m/s2", organ_accelerates, {slow});
  add_rows(rows, "organ_pulls", "an organ that goes to and fro in jaws that stand still", organ_pulls,
           {slow, hard});
  add_rows(rows, "organ_and_jaws", "the jaws go half as far as the organ", organ_and_jaws, {slow});
}

}  // namespace palpate::studies
