#pragma once
/// Tools that turn, rub and grasp on supports that rest or move, watched step by step; and what is held
/// against that: another world of the same model, a closed form, or an equilibrium found without any contact.
#include "tests/studies/robustness.h"

namespace palpate::studies {

constexpr double kRest = 1.0;  // s, after all motion

/// A scene with its mesh, and the hands that hold its tools.
struct World {
  SceneFile file = {};
  sim::TetMesh mesh = usual_block();
  std::function<std::vector<sim::ToolInput>(double t)> hands = {};  // t in s
  double seconds = 2;
};

/// What the tools felt in one step.
struct Rendered {
  double t;  // s
  std::vector<ToolPose> poses;
  std::vector<Vec3> force, torque;  // of each tool, N, N m
  bool flagged;
};

/// All of it.
struct Watched {
  std::vector<Rendered> steps;
  int flagged = 0;
  bool finite = true;
  double max_newton = 0;  // of steps that were not flagged
  double off = 0;         // in the end, of the surface from where it began, m
};
Watched watch(const World& world, const Column& column);

/// Vectors of one step that should be those of another: forces, torques.
using Vectors = std::vector<Vec3>;
/// What should be felt at a step, or nothing, where there is nothing to tell of it.
using Expected = std::function<std::optional<Vectors>(std::size_t step)>;
/// What of a step is told.
using Published = std::function<Vectors(const Rendered&)>;

/// The force on the first tool; with its torque.
Vectors force_of(const Rendered& rendered);
Vectors force_and_torque_of(const Rendered& rendered);

/// The steps of another world from `from` (s) on, but those it flagged.
Expected as_in(Watched other, Published published, double from = 0);

/// In the last `seconds` of that world.
Expected at_the_end(const World& world, Vectors right, double seconds = 0.5 * kRest);

/// The worst of all steps that were not flagged, each vector as a share of the largest that was expected of
/// its kind: more than `bound` is wrong.
Verdict compare(const Watched& watched, const Published& published, const Expected& expected, double bound,
                const std::string& reference);

/// Free surface vertices around a place, all moved alike.
struct Gripped {
  Vec3 place;
  double reach;  // m
  Vec3 moved;    // m
};
/// What tools feel that move these and let the rest of the body, of any law, come to equilibrium, N.
Vectors reactions(const World& world, const Column& column, const std::vector<Gripped>& grips);

/// The work that tools do on the hands that hold them, by the trapezoidal rule in places and turns: J; and
/// of all steps by its size.
struct Work {
  double sum = 0, size = 0;
};
Work work_of(const Watched& watched);

/// How extreme.
struct Setting {
  std::string name = {}, what = {};
  double modulus = 1e4, nu = 0.45, rate_hz = 30;  // Pa, -, Hz
  double thickness = 0.015, depth = 0.002;        // m, of the block and of the press
  double speed = 0.02;                            // m/s
  double friction = 0.3;                          // where there is any
};
/// The usual block so, top at y = 0, its bottom held; no hands yet.
World block_of(const Setting& setting);

/// Straight from place to place at an even speed (m/s).
struct Direction {
  std::vector<Vec3> places;
  double speed;

  double seconds() const;
  Vec3 at(double t) const;
};
constexpr double kToolRadius = 0.004;  // m, of most tools
/// Down from 2 mm above the block, then along.
Direction press_and_draw(const Setting& setting, const Vec3& along);
/// One tool there, or lifted.
sim::ToolInput at(const Vec3& p, const Quat& q = Quat::Identity());

/// Worlds that differ by rounding, by what Newton may leave: of the force.
constexpr double kSame = 1e-3;

/// What a row does with one setting and one model.
using Judge = Verdict (*)(const Setting&, const Column&);
/// Rows of these settings, the first of them also in a quick study where `quick`; their names and words are
/// added to those of the row.
void add_rows(std::vector<Case>& rows, const std::string& name, const std::string& what, Judge judge,
              const std::vector<Setting>& settings, bool quick = false);

/// Jaws, friction and work (`robustness_grips.cpp`); two tools on the same tissue
/// (`robustness_two_tools.cpp`); supports that move (`robustness_supports.cpp`).
void add_grips(std::vector<Case>& rows);
void add_two_tools(std::vector<Case>& rows);
void add_supports(std::vector<Case>& rows);

/// A row: refused where `judge` throws `Error`.
Case world_row(const std::string& name, const std::string& what, bool quick,
               std::function<Verdict(const Column& column)> judge);

}  // namespace palpate::studies
