// The rows of the robustness study.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <numbers>

#include "sim_server/mesh/shapes.h"
#include "tests/studies/robustness.h"
#include "tests/support/solids.h"

namespace palpate::studies {
namespace {

constexpr double kRadius = 0.004;  // m, of the usual tool

void deep(Trial& trial, double depth) {
  trial.depth = depth;
  trial.paths = {press(kRadius, depth)};
}

void usual(Trial&) {}
void stiff_fibres(Trial& trial) {
  trial.file.material = "[material.fibres]\ndirection = [1, 0, 0]\nmodulus = 1e10\n";
}
void hard_neighbours(Trial& trial) {
  trial.file.material =
      "[[material.inclusion]]\nbox = [[-1, -0.0101, -1], [0, -0.0049, 1]]\nyoung_modulus = 1e10\n";
}
void slivers(Trial& trial) {
  const double thin = 0.005 * std::tan(0.1 / 180 * std::numbers::pi);
  trial.mesh = sim::grid_block(test::lines(-0.015, 0.015, 6), {-0.015, -0.01, -0.005, -0.005 + thin, 0},
                               test::lines(-0.015, 0.015, 6));
}
void sizes(Trial& trial) {
  const auto side = sim::graded_axis(0.09, 0.0001, 0.0001, 6);
  trial.mesh = sim::grid_block(side, {-0.06, -0.0125, -0.0025, -0.0001, 0}, side);
  trial.file.tools = {tool(0.002, "reach = [[-0.001, -0.001, -0.001], [0.001, 0, 0.001]]")};
  trial.depth = 0.001;
  trial.paths = {press(0.002, trial.depth, 0.8)};
  trial.seconds = trial.reference_seconds = 1.2;
  trial.file.fixed = "[[fixed]]\nbox = [[-1, -0.0601, -1], [1, -0.0599, 1]]\n";
}
void short_steps(Trial& trial) {
  trial.file.rate_hz = 1e4;
  trial.file.rayleigh_mass = 200;
  trial.paths = {press(kRadius, trial.depth, 0.05)};
  trial.seconds = 0.12;
}
void long_steps(Trial& trial) {
  trial.file.rate_hz = 1;
  trial.seconds = 10;
}
void fast(Trial& trial) {
  trial.slow = {press(kRadius, trial.depth)};
  const Vec3 end = trial.slow[0].back().place;
  trial.paths = {{{0, end + Vec3(0, 1, 0)}, {0.1, end}}};
}
void teleported(Trial& trial) {
  deep(trial, 0.0105);
  trial.slow = trial.paths;
  const Vec3 inside = trial.slow[0].back().place, away = inside + Vec3(0, 0.1, 0);
  trial.paths = {{{0, away}, {0.5, away}, {0.5, inside}}};
}
void most_of_the_thickness(Trial& trial) {
  deep(trial, 0.012);
}
void pinched(Trial& trial) {
  trial.file.tools = {tool(kRadius), tool(kRadius)};
  trial.depth = 0.005;
  trial.outward = {-Vec3::UnitX(), Vec3::UnitX()};
  trial.no_rest_unbent = true;
  trial.paths.clear();
  for (const double side : {-1.0, 1.0}) {
    const double from = 0.015 + kRadius + 0.002, to = 0.015 + kRadius - trial.depth;
    trial.paths.push_back({{0, Vec3(side * from, -0.005, 0.002)}, {1, Vec3(side * to, -0.005, 0.002)}});
  }
}
void heavy(Trial& trial) {
  deep(trial, 0.0115);  // the top sinks by two thirds of that
  trial.file.loads = "[[load]]\ngravity = [0, -981, 0]\n";
  trial.only_implicit_refers = true;
}
void free_body(Trial& trial) {
  trial.file.fixed = "";
}
void one_newton_step(Trial& trial) {
  trial.file.max_newton = 1;
  trial.file.tolerance = 1e-12;
}
/// Pressed, then drawn by 4 mm.
void rubbed(Trial& trial, double friction) {
  trial.file.tools = {tool(kRadius, fmt::format("friction = {}", friction))};
  trial.paths = {press(kRadius, trial.depth)};
  trial.paths[0].push_back({2, trial.paths[0].back().place + Vec3(0.004, 0, 0)});
  trial.path_matters = true;
  // In depths: one along the normal; across it what friction bears, and no more than it is drawn by.
  trial.rendered_by_rigid = std::hypot(1, std::min(friction, 0.004 / trial.depth));
}
void slippery(Trial& trial) {
  rubbed(trial, 0);
}
void rough(Trial& trial) {
  rubbed(trial, 0.5);
}
void sticky(Trial& trial) {
  rubbed(trial, 10);
}
void needle(Trial& trial) {
  constexpr double kSharp = 0.0002;
  trial.file.tools = {tool(kSharp)};
  trial.depth = 0.001;
  trial.paths = {press(kSharp, trial.depth)};
}
void blunt(Trial& trial) {
  constexpr double kBlunt = 0.03;
  trial.file.tools = {tool(kBlunt)};
  trial.paths = {press(kBlunt, trial.depth)};
}
void lost_pose(Trial& trial) {
  trial.slow = {press(kRadius, trial.depth)};
  const Vec3 end = trial.slow[0].back().place,
             no_place = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  trial.paths = trial.slow;
  trial.paths[0].insert(trial.paths[0].end(), {{1.2, end}, {1.2, no_place}, {1.4, no_place}, {1.4, end}});
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> found{
        {"usual", "E 10 kPa, nu 0.45, a tool 3 mm deep", true, run_trial, usual},
        {"neighbours_1e6", "a part 1e6 times as stiff as what is around it", false, run_trial,
         hard_neighbours},
        {"fibres_1e6", "fibres 1e6 times as stiff as the tissue", false, run_trial, stiff_fibres},
        {"slivers", "dihedral angles of 0.1 degrees", true, run_trial, slivers},
        {"sizes", "edges from 0.1 to 50 mm", false, run_trial, sizes},
        {"step_0.1_ms", "10 kHz", false, run_trial, short_steps},
        {"step_1_s", "1 Hz", true, run_trial, long_steps},
        {"tool_10_m_s", "down at 10 m/s", true, run_trial, fast},
        {"teleported", "from outside to 10.5 mm deep in one step", false, run_trial, teleported},
        {"deep", "80 % of the thickness", false, run_trial, most_of_the_thickness},
        {"pinched", "between two tools, each 5 mm deep", true, run_trial, pinched},
        {"scattered", "all free vertices at random", true, run_scattered},
        {"to_a_point", "all free vertices in one point, to 1e-6", false, run_collapsed_to_point},
        {"to_a_plane", "all free vertices in one plane, to 1e-6", true, run_collapsed_to_plane},
        {"gravity_x100", "981 m/s2", false, run_trial, heavy},
        {"undamped", "1e6 sub-steps without damping", true, run_undamped},
        {"free_body", "no [[fixed]]", true, run_free_body, free_body},
        {"one_newton_step", "max_newton 1, tolerance 1e-12", false, run_trial, one_newton_step},
        {"friction_0", "drawn by 4 mm, friction 0", false, run_trial, slippery},
        {"friction_0.5", "drawn by 4 mm, friction 0.5", false, run_trial, rough},
        {"friction_10", "drawn by 4 mm, friction 10", true, run_trial, sticky},
        {"needle", "tool radius 0.2 mm, 1 mm deep", false, run_trial, needle},
        {"blunt", "tool radius 30 mm, as wide as the block", false, run_trial, blunt},
        {"nan_pose", "the pose is NaN for 0.2 s", true, run_trial, lost_pose}};
    for (const std::vector<Case>& more : {extreme_cases(), shape_cases(), world_cases()})
      found.insert(found.end(), more.begin(), more.end());
    return found;
  }();
  return all;
}

}  // namespace palpate::studies
