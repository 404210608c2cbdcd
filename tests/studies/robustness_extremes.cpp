// Rows of the robustness study: the usual block of other tissue, moved otherwise, with other tools, of other
// sizes.
#include <cmath>
#include <fmt/core.h>

#include "sim_server/mesh/shapes.h"
#include "sim_server/scene_file/read_parts.h"
#include "tests/studies/robustness.h"
#include "tests/support/solids.h"

namespace palpate::studies {
namespace {

using Change = std::function<void(Trial&)>;

/// Forces of tissue at rest are in proportion to its modulus, and to the square of lengths where all of them
/// are in proportion: the usual block tells them.
void expect_in_proportion(Trial& trial, double modulus, double length = 1) {
  trial.times = modulus / 1e4 * length * length;
  trial.refers_to = "the usual block, in proportion to Young's modulus and to the square of lengths";
  trial.refer = [length](Trial& usual) {
    usual.file.young_modulus = 1e4;
    usual.file.fixed = SceneFile{}.fixed;
    usual.mesh = usual_block();
    usual.seconds = usual.reference_seconds;
    usual.depth /= length;
    for (std::string& tool : usual.file.tools)
      tool = studies::tool(std::stod(tool.substr(tool.find('=') + 1)) / length);
    for (Path& path : usual.paths) {
      for (Waypoint& waypoint : path) waypoint.place /= length;
    }
  };
}

Change modulus_of(double modulus) {
  return [modulus](Trial& trial) {
    trial.file.young_modulus = modulus;
    expect_in_proportion(trial, modulus);
    trial.slow = trial.paths;
    trial.reference_seconds = 2;
    if (modulus < 10) trial.seconds = 20;  // it creeps home in some 2 s
  };
}

/// 2.5 mm deep, by the bluntest tool, so that the mesh hardly shows.
Change incompressible(double nu, sim::ElementKind element) {
  return [nu, element](Trial& trial) {
    trial.file.poisson_ratio = nu;
    trial.file.element = sim::name_of(element);
    trial.file.tools = {tool(0.05)};
    trial.depth = 0.0025;
    trial.paths = {press(0.05, trial.depth, 0.6)};
    trial.seconds = trial.reference_seconds = 1.2;
    if (element == sim::ElementKind::kQuadratic) {
      trial.mesh = sim::grid_block(test::lines(-0.015, 0.015, 3), test::lines(-0.015, 0, 2),
                                   test::lines(-0.015, 0.015, 3));
      return;
    }
    trial.bound = 0.25;  // what edges of 5 mm leave to be told
    trial.refers_to = "element p2";
    trial.refer = [](Trial& quadratic) {
      quadratic.file.element = "p2";
      quadratic.file.tolerance = 1e-6;  // less is lost in rounding, so near incompressible
    };
  };
}

Change stroke_at(double speed) {
  return [speed](Trial& trial) {
    trial.depth = 0.005;
    const Vec3 end(0.001, 0.004 - trial.depth, 0.002);
    trial.paths = {stroke(end + Vec3(0, 0.03, 0), end, speed)};
    trial.slow = {press(0.004, trial.depth)};
    trial.phases = 4;
    trial.seconds = trial.paths[0].back().t + 1.2;
  };
}

/// From below, on what holds the block; `rendered`: of 2000 N/m x depth.
Change held_face(double radius, double depth, const Vec3& at, const Range& rendered) {
  return [=](Trial& trial) {
    trial.depth = depth;
    trial.outward = {-Vec3::UnitY()};
    trial.file.tools = {tool(radius)};
    const Vec3 end = at + Vec3(0, -0.015 - radius + depth, 0);
    trial.paths = {{{0, end - Vec3(0, 0.005, 0)}, {1, end}}};
    trial.seconds = 2;
    trial.rendered = Range{2000 * depth * rendered.least, 2000 * depth * rendered.most};
  };
}

Change tool_of(double radius, double depth) {
  return [=](Trial& trial) {
    trial.file.tools = {tool(radius)};
    trial.depth = depth;
    trial.paths = {press(radius, depth)};
    trial.seconds = trial.reference_seconds = 2;
  };
}

Change inside_from_the_start(double depth) {
  return [depth](Trial& trial) {
    trial.depth = depth;
    trial.slow = {press(0.004, depth)};
    trial.paths = {{{0, trial.slow[0].back().place}}};
  };
}

Change held_by(const std::string& box) {
  return [box](Trial& trial) {
    trial.file.fixed = fmt::format("[[fixed]]\nbox = {}\n", box);
    trial.must_refuse = true;
    trial.seconds = 2;
  };
}

Change size_of(double length, double modulus, double radius) {
  return [=](Trial& trial) {
    trial.mesh = test::mapped(usual_block(), [length](const Vec3& x) -> Vec3 { return length * x; });
    trial.file.young_modulus = modulus;
    trial.file.fixed = fmt::format("[[fixed]]\nbox = [[-100, {0}, -100], [100, {1}, 100]]\n",
                                   -0.0151 * length, -0.0149 * length);
    trial.depth = 0.75 * radius;
    trial.file.tools = {tool(radius)};
    const Vec3 end(0.001 * length, radius - trial.depth, 0.002 * length);
    trial.paths = {{{0, end + Vec3(0, 1.25 * radius, 0)}, {1, end}}};
    expect_in_proportion(trial, modulus, length);
  };
}

void add_gravity(Trial& trial) {
  trial.file.young_modulus = 1e6;
  trial.file.loads = "[[load]]\ngravity = [0, -9810, 0]\n";
  trial.depth = 0.004;  // the top sinks by a part of that
  trial.paths = {press(0.004, trial.depth)};
  trial.only_implicit_refers = true;
}

void add_materials(std::vector<Case>& rows) {
  rows.push_back({"soft", "E 100 Pa", true, run_trial, modulus_of(100)});
  rows.push_back({"hard", "E 1 GPa", true, run_trial, modulus_of(1e9)});
  for (const auto& [name, modulus, quick] :
       {std::tuple{"1", 1.0, false}, {"1e6", 1e6, false}, {"1e10", 1e10, false}, {"1e12", 1e12, true}})
    rows.push_back(
        {fmt::format("E_{}", name), fmt::format("E {} Pa", name), quick, run_trial, modulus_of(modulus)});
  for (const double nu : {0.0, 0.499, 0.4999, 0.49999}) {
    for (const sim::ElementKind element : sim::element_kinds())
      rows.push_back({fmt::format("nu_{}_{}", nu, sim::name_of(element)),
                      fmt::format("nu {}, element {}", nu, sim::name_of(element)), nu == 0.499, run_trial,
                      incompressible(nu, element)});
  }
}

}  // namespace

std::vector<Case> extreme_cases() {
  std::vector<Case> rows;
  add_materials(rows);
  for (const double speed : {0.05, 0.2, 0.5, 1.0, 2.0})
    rows.push_back({fmt::format("speed_{}", speed),
                    fmt::format("5 mm deep at {} m/s, four phases of the steps", speed), speed == 0.5,
                    run_trial, stroke_at(speed)});
  // One vertex bears all, where the ball is so small that the facets around it do not touch it; three bear a
  // third each. Deeper, the ball lies in a pit of several.
  rows.push_back({"held_vertex", "0.2 mm on a vertex of a [[fixed]]", true, run_trial,
                  held_face(0.0002, 0.0002, Vec3::Zero(), {1, 1})});
  rows.push_back({"held_facet", "0.2 mm on the middle of a facet of a [[fixed]]", false, run_trial,
                  held_face(0.004, 0.0002, Vec3(0.01 / 3, 0, 0.005 / 3), {3, 3})});
  rows.push_back({"held_deep", "2 mm on a [[fixed]]", false, run_trial,
                  held_face(0.004, 0.002, Vec3(0.001, 0, 0.002), {1, 3})});
  for (const auto& [name, radius, depth, quick] : {std::tuple{"0.01", 1e-5, 1e-4, false},
                                                   {"0.1", 1e-4, 5e-4, true},
                                                   {"1", 1e-3, 2e-3, false},
                                                   {"10", 0.01, 3e-3, false},
                                                   {"50", 0.05, 3e-3, true}})
    rows.push_back({fmt::format("tool_{}_mm", name),
                    fmt::format("tool radius {} mm, {} mm deep", name, 1e3 * depth), quick, run_trial,
                    tool_of(radius, depth)});
  rows.push_back(
      {"starts_inside", "from the first step 3 mm deep", true, run_trial, inside_from_the_start(0.003)});
  rows.push_back({"starts_deep", "from the first step 10.5 mm deep, its centre too", true, run_trial,
                  inside_from_the_start(0.0105)});
  rows.push_back({"held_by_vertex", "[[fixed]]: one vertex", true, run_trial,
                  held_by("[[-0.016, -0.016, -0.016], [-0.014, -0.014, -0.014]]")});
  rows.push_back({"held_by_edge", "[[fixed]]: one edge of the block", false, run_trial,
                  held_by("[[-0.016, -0.016, -1], [-0.014, -0.014, 1]]")});
  rows.push_back({"gravity_x1000", "9810 m/s2, E 1 MPa", true, run_trial, add_gravity});
  rows.push_back(
      {"organ_1_mm", "1 mm wide, tool radius 0.13 mm", true, run_trial, size_of(1.0 / 30, 1e4, 0.004 / 30)});
  rows.push_back({"organ_10_m", "10 m wide, E 1 MPa, tool radius 50 mm", true, run_trial,
                  size_of(1000.0 / 3, 1e6, 0.05)});
  return rows;
}

}  // namespace palpate::studies
