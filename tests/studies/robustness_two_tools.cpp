// Rows of the robustness study: two tools on the same tissue, which pinch it, hold it and press it, or hand
// it over. Held against Newton's third law, a body that is held where jaws are, and equilibria found without
// any contact.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "sim_server/mesh/shapes.h"
#include "tests/studies/robustness.h"
#include "tests/support/solids.h"

namespace palpate::studies {
namespace {

using sim::ToolInput;

constexpr double kStays = 0.5;      // s, before tools go back
constexpr double kOpposite = 0.02;  // of the larger force: how far both may be from opposite
constexpr double kNoPull = 1e-6;    // of the larger force: a pull that is rounding
constexpr double kClear = 0.002;    // m, between tool and tissue at first

Verdict rigid_is_omitted() {
  return {"not_applicable", "an organ that does not deform has no place between two tools", {}, {}, ""};
}

/// A mesh with its mirror image across the plane `plane` of `axis`, on which some of its vertices lie.
sim::TetMesh with_mirror_image(const sim::TetMesh& half, int axis, double plane) {
  sim::TetMesh both = half;
  std::vector<int> image;
  for (std::size_t v = 0; v < half.vertices.size(); ++v) {
    Vec3 x = half.vertices[v];
    const bool on_plane = std::abs(x[axis] - plane) < 1e-9;
    image.push_back(static_cast<int>(on_plane ? v : both.vertices.size()));
    x[axis] = 2 * plane - x[axis];
    if (!on_plane) both.vertices.push_back(x);
  }
  for (const sim::Tetrahedron& t : half.tetrahedra)  // a mirror turns it inside out
    both.tetrahedra.push_back({image[t[1]], image[t[0]], image[t[2]], image[t[3]]});
  return both;
}

/// A lobe 60 mm long and 40 mm wide, between two tools `apart` from each other along it, which thin it by
/// `fraction` and go back. It hangs on its end, or, between tools that are apart, on both. It is symmetric in
/// the bits of its mesh: so both tools render opposite forces, whatever holds it.
struct Pinch {
  double fraction = 0.6, apart = 0;  // -, m

  sim::TetMesh lobe(double thickness) const {
    const auto width = test::lines(-0.02, 0.02, 8), upper = test::lines(-thickness / 2, 0, 2);
    const bool hangs = apart == 0;
    const auto length = hangs ? test::lines(-0.03, 0.03, 12) : test::lines(-0.03, 0, 6);
    const sim::TetMesh part = with_mirror_image(sim::grid_block(length, upper, width), 1, -thickness / 2);
    return hangs ? part : with_mirror_image(part, 0, 0);
  }
  World world(const Setting& setting) const {
    World pinched = block_of(setting);
    pinched.mesh = lobe(setting.thickness);
    pinched.file.fixed = "[[fixed]]\nbox = [[-1, -1, -1], [-0.0299, 1, 1]]\n";
    if (apart > 0) pinched.file.fixed += "[[fixed]]\nbox = [[0.0299, -1, -1], [1, 1, 1]]\n";
    pinched.file.tools = {tool(kToolRadius), tool(kToolRadius)};
    const double in = kClear + 0.5 * fraction * setting.thickness, seconds = in / setting.speed;
    const double middle = apart > 0 ? 0 : 0.012;
    pinched.seconds = 2 * seconds + kStays + kRest;
    pinched.hands = [=, *this](double t) {
      const double back = std::max(0.0, t - seconds - kStays);
      const double y =
          kToolRadius + kClear - std::min(t * setting.speed, in) + std::min(back * setting.speed, in);
      return std::vector<ToolInput>{at(Vec3(middle - apart / 2, y, 0.0007)),
                                    at(Vec3(middle + apart / 2, -setting.thickness - y, 0.0007))};
    };
    return pinched;
  }
};

/// No tool pulls, both press alike, and nothing is left in the end.
Verdict judge_pinch(const Watched& watched) {
  Verdict verdict = verdict_of(watched, "forces that are opposite, and none when both are gone");
  if (!watched.finite) return verdict;
  double largest = 0, off = 0, pull = 0;
  for (const Rendered& rendered : watched.steps) {
    if (rendered.flagged) continue;
    const double upper = rendered.force[0].y(), lower = rendered.force[1].y();
    pull = std::max({pull, -upper, lower});
    largest = std::max({largest, std::abs(upper), std::abs(lower)});
    off = std::max(off, std::abs(upper + lower));
  }
  const auto wrong = [&](const std::string& reason) {
    verdict.outcome = "wrong";
    verdict.reason = reason;
  };
  if (largest > 0) verdict.error_percent = 100 * off / largest;
  const double remains = watched.steps.back().force[0].norm() + watched.steps.back().force[1].norm();
  if (largest == 0 && watched.flagged == 0) wrong("it never held anything");
  if (off > kOpposite * largest)
    wrong(fmt::format("{:.3g} N of {:.3g} N are not borne by the other tool", off, largest));
  if (pull > kNoPull * largest) wrong(fmt::format("a tool is pulled in by {:.3g} N", pull));
  if (remains > kNoPull * largest) wrong(fmt::format("{:.3g} N remain when both tools are gone", remains));
  return verdict;
}

Verdict pinched(const Setting& setting, const Column& column) {
  if (!column.row->deforms()) return rigid_is_omitted();
  return judge_pinch(watch(Pinch{}.world(setting), column));
}

Verdict pinched_apart(const Setting& setting, const Column& column) {
  if (!column.row->deforms()) return rigid_is_omitted();
  return judge_pinch(watch(Pinch{.fraction = 0.3, .apart = 0.008}.world(setting), column));
}

/// Jaws that hold a vertex of the top and its four neighbours where they are, and a ball that presses beside
/// them: as if the tissue were held there.
Verdict grasp_and_press(const Setting& setting, const Column& column) {
  if (!column.row->deforms()) return rigid_is_omitted();
  const Vec3 place(-0.005, 0, 0), beside(0.009, 0, 0.001);
  const Direction down{
      {beside + Vec3(0, kToolRadius + kClear, 0), beside + Vec3(0, kToolRadius - setting.depth, 0)},
      setting.speed};
  World held = under_tool(setting, down);
  held.seconds += kRest;
  World gripped = held;
  held.file.fixed +=
      "[[fixed]]\nbox = [[-0.0101, -1e-6, -1e-6], [0.0001, 1e-6, 1e-6]]\n"
      "[[fixed]]\nbox = [[-0.0051, -1e-6, -0.0051], [-0.0049, 1e-6, 0.0051]]\n";
  held.file.tools = {tool(kToolRadius)};
  gripped.file.tools = {tool(kToolRadius),
                        tool(0.005, fmt::format("grasp_place = [{}, {}, {}]", place[0], place[1], place[2]))};
  gripped.hands = [=](double t) { return std::vector<ToolInput>{at(down.at(t)), at(place)}; };
  return compare(watch(gripped, column), force_of,
                 as_in(watch(held, column), force_of, held.seconds - 0.5 * kRest), 0.01,
                 "the same body, held where the jaws are");
}

/// Two pairs of jaws 6 mm apart lift the same tissue by 5 mm: the sum of their forces.
Verdict handed_over(const Setting& setting, const Column& column) {
  if (!column.row->deforms()) return rigid_is_omitted();
  constexpr double kJaws = 0.006, kReach = 1.25 * kJaws, kApart = 0.006;
  const Vec3 places[] = {Vec3(-kApart / 2, kJaws, 0), Vec3(kApart / 2, kJaws, 0)}, up(0, 0.005, 0);
  World world = block_of(setting);
  world.file.tools = {tool(kJaws, "grasp_buttons = 1"), tool(kJaws, "grasp_buttons = 1")};
  const Direction way{{Vec3::Zero(), up}, setting.speed};
  constexpr double kClosed = 0.2;  // s
  world.seconds = kClosed + way.seconds() + 2 * kRest;
  world.hands = [=](double t) {
    std::vector<ToolInput> inputs;
    for (const Vec3& place : places) {
      inputs.push_back(at(place + way.at(std::max(0.0, t - kClosed))));
      inputs.back().buttons = 1;
    }
    return inputs;
  };
  const Published sum = [](const Rendered& rendered) {
    return Vectors{rendered.force[0] + rendered.force[1]};
  };
  const Vectors each = reactions(world, column, {{places[0], kReach, up}, {places[1], kReach, up}});
  return compare(watch(world, column), sum, at_the_end(world, {each[0] + each[1]}), 0.01,
                 "the equilibrium of the body, its gripped vertices displaced, without contact");
}

}  // namespace

void add_two_tools(std::vector<Case>& rows) {
  const Setting thick{.name = "_20_mm", .what = ", 20 mm thick, 10 mm/s", .thickness = 0.02, .speed = 0.01};
  const Setting thick_fast{
      .name = "_20_mm_fast", .what = ", 20 mm thick, 50 mm/s", .thickness = 0.02, .speed = 0.05};
  const Setting sheet{.name = "_6_mm", .what = ", 6 mm thick, 10 mm/s", .thickness = 0.006, .speed = 0.01};
  const Setting sheet_fast{
      .name = "_6_mm_fast", .what = ", 6 mm thick, 50 mm/s", .thickness = 0.006, .speed = 0.05};
  add_rows(rows, "pinch", "a lobe pinched to 60 %", pinched, {thick, thick_fast, sheet, sheet_fast}, true);
  add_rows(rows, "pinch_aside", "a lobe thinned by 30 %, the tools 8 mm from opposite", pinched_apart,
           {thick, sheet});
  add_rows(rows, "grasp_and_press", "a ball presses 10 mm beside jaws that hold", grasp_and_press,
           {{}, {.name = "_thin", .what = ", 5 mm thick", .thickness = 0.005, .depth = 0.001}}, true);
  add_rows(rows, "hand_over", "two pairs of jaws 6 mm apart lift the same tissue", handed_over,
           {{}, {.name = "_E_1e9", .what = ", E 1 GPa", .modulus = 1e9}}, true);
}

}  // namespace palpate::studies
