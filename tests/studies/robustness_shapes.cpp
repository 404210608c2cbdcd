// Rows of the robustness study: bodies of other shapes than the usual block.
#include <cmath>
#include <fmt/core.h>

#include "sim_server/mesh/shapes.h"
#include "tests/studies/robustness.h"
#include "tests/support/carved.h"
#include "tests/support/solids.h"

namespace palpate::studies {
namespace {

using Change = std::function<void(Trial&)>;
constexpr double kBall = 0.006;  // m, of the tool on sheets
constexpr const char* kTwoEdges =
    "[[fixed]]\nbox = [[-1, -1, -1], [-0.0299, 1, 1]]\n[[fixed]]\nbox = [[0.0299, -1, -1], [1, 1, 1]]\n";

/// 60 x 60 mm, held at two edges, pressed to 15 mm from 10 mm above and held.
Change sheet(double thickness, double speed) {
  return [=](Trial& trial) {
    const auto side = test::lines(-0.03, 0.03, 14);
    trial.mesh = sim::grid_block(side, test::lines(-thickness, 0, 2), side);
    trial.file.fixed = kTwoEdges;
    trial.file.tools = {tool(kBall)};
    trial.depth = 0.015;
    const Vec3 end(0.0011, kBall - trial.depth, 0.0007), from = end + Vec3(0, 0.025, 0);
    trial.paths = {stroke(from, end, speed)};
    trial.slow = {stroke(from, end, 0.03)};
    trial.phases = 4;
    trial.seconds = trial.paths[0].back().t + 1.5;
    trial.reference_seconds = 2.5;
  };
}

/// Joined where they are held. Both are pressed, the lower one less deep: at least the force of the upper one
/// alone, at most that of two.
void two_sheets(Trial& trial) {
  sheet(0.0015, 0.2)(trial);
  const auto side = test::lines(-0.03, 0.03, 14);
  const std::vector<double> layers{-0.004, -0.0025, -0.0015, 0};
  const auto joint = [](const Vec3& x) { return std::abs(x.x()) > 0.0258; };
  const auto both = [=](const Vec3& x) { return joint(x) || x.y() > -0.0015 || x.y() < -0.0025; };
  const auto upper = [=](const Vec3& x) { return joint(x) || x.y() > -0.0015; };
  trial.mesh = test::carved(side, layers, side, both);
  trial.refers_to = "the upper sheet alone; at most twice that";
  trial.refer = [=](Trial& one) { one.mesh = test::carved(side, layers, side, upper); };
  trial.most = 2;
}

/// Two blocks that share an edge and no more; the left one is held.
void hinge(Trial& trial) {
  const auto either = [](const Vec3& x) { return (x.x() < 0) == (x.y() < -0.0075); };
  trial.mesh = test::carved(test::lines(-0.015, 0.015, 6), test::lines(-0.015, 0, 4),
                            test::lines(-0.015, 0.015, 6), either);
  trial.paths = {{{0, Vec3(0.011, 0.006, 0.002)}, {1, Vec3(0.011, 0.001, 0.002)}}};
  trial.must_refuse = true;
}

/// 2 mm thick and 10 mm high along the middle of the usual block.
void fin(Trial& trial) {
  const auto on = [](const Vec3& x) { return x.y() < 0 || std::abs(x.x()) < 0.001; };
  trial.mesh =
      test::carved({-0.015, -0.01, -0.005, -0.001, 0.001, 0.005, 0.01, 0.015},
                   {-0.015, -0.01, -0.005, 0, 0.0033, 0.0067, 0.01}, test::lines(-0.015, 0.015, 6), on);
}

void push(Trial& trial, const Vec3& end, const Vec3& outward, double depth, double speed) {
  trial.depth = depth;
  trial.outward = {outward};
  const Vec3 from = end + (depth + 0.005) * outward;
  trial.paths = {stroke(from, end, speed)};
  trial.slow = {stroke(from, end, 0.01)};
  trial.phases = 4;
  trial.seconds = trial.paths[0].back().t + 1.5;
  trial.reference_seconds = 3;
}

Change fin_aside(double speed) {
  return [speed](Trial& trial) {
    fin(trial);
    const double depth = 0.004;
    push(trial, Vec3(-0.001 - 0.004 + depth, 0.0071, 0.0007), -Vec3::UnitX(), depth, speed);
  };
}
void ridge(Trial& trial) {
  fin(trial);
  const double depth = 0.003;
  push(trial, Vec3(0.0002, 0.01 + 0.004 - depth, 0.0007), Vec3::UnitY(), depth, 0.2);
  trial.other_rest = 2;  // the fin gives way to either side: as much the other way
}

/// An ear of 2 mm by 20 mm that stands off the top of the usual block.
Change flap(bool from_above, double speed) {
  return [=](Trial& trial) {
    const auto on = [](const Vec3& x) { return x.x() < 0.015 || x.y() > -0.002; };
    trial.mesh = test::carved({-0.015, -0.01, -0.005, 0, 0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.035},
                              {-0.015, -0.01, -0.005, -0.002, 0}, test::lines(-0.015, 0.015, 6), on);
    const double depth = 0.008, side = from_above ? 1 : -1;
    const double end = from_above ? 0.004 - depth : -0.002 - 0.004 + depth;
    push(trial, Vec3(0.0281, end, 0.0007), Vec3(0, side, 0), depth, speed);
  };
}

}  // namespace

std::vector<Case> shape_cases() {
  std::vector<Case> rows;
  for (const double thickness : {0.001, 0.003, 0.006}) {
    for (const double speed : {0.05, 0.23, 0.35, 0.6, 1.0, 2.0}) {
      const bool quick = speed == (thickness == 0.006 ? 0.23 : 0.35);
      rows.push_back(
          {fmt::format("sheet_{:g}_mm_{:g}", 1e3 * thickness, speed),
           fmt::format("{:g} mm thick, pressed 15 mm at {:g} m/s, four phases", 1e3 * thickness, speed),
           quick, run_trial, sheet(thickness, speed)});
    }
  }
  rows.push_back({"two_sheets", "1.5 mm thick, 1 mm apart, tool radius 6 mm, pressed 15 mm", true, run_trial,
                  two_sheets});
  rows.push_back({"hinge", "two blocks joined by one edge, the free one pressed", true, run_trial, hinge});
  rows.push_back(
      {"fin_aside", "2 mm thick, 10 mm high, pushed 4 mm at 0.05 m/s", true, run_trial, fin_aside(0.05)});
  rows.push_back({"fin_aside_fast", "the same at 0.5 m/s", false, run_trial, fin_aside(0.5)});
  rows.push_back({"ridge", "on the edge of that fin, 3 mm at 0.2 m/s", true, run_trial, ridge});
  rows.push_back({"flap_down", "an ear of 2 x 20 mm, 8 mm at 0.2 m/s", true, run_trial, flap(true, 0.2)});
  rows.push_back({"flap_up", "the same from below, at 0.5 m/s", false, run_trial, flap(false, 0.5)});
  return rows;
}

}  // namespace palpate::studies
