#pragma once
/// Scenes at the extremes, with every model: what a cell of `scripts/study robustness` runs, and its verdict.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::studies {

/// A deformation model, with a law where it takes several.
struct Column {
  std::string name;
  const sim::DeformationModelRow* row;
  sim::ElasticLaw elastic;
  /// A body of free vertices in motion, of any law.
  bool any_law() const { return row->materials == sim::Materials::kAny; }
  bool linear() const { return elastic == sim::ElasticLaw::kLinear; }
  /// Nothing of it gives way: force = stiffness x depth, also of what is held.
  bool is_placed() const { return !row->deforms() && !row->moves; }
  /// At rest at every instant: the force depends on the path, not on how long it took.
  bool at_rest() const { return !row->deforms() || !row->moves; }
};
/// Every row of `deformation_models`, with every law where it takes any.
const std::vector<Column>& columns();

/// How far an unflagged force of a settled hold may be from what is expected, as a share of that; more is
/// `wrong`. Rows that compare meshes or elements state a bound of their own (`Trial::bound`).
constexpr double kBound = 0.05;

/// What came of one cell.
struct Verdict {
  std::string outcome;                  ///< stable, refused, flagged, wrong, exploded, not_applicable
  std::string reason;                   ///< one sentence; of a refusal, what the program said
  std::optional<double> error_percent;  ///< against `reference`; none where that did not settle
  std::optional<double> max_newton;     ///< the largest force on any tool, N
  std::string reference;
};

/// A scene file but for its mesh, in pieces that cases change.
struct SceneFile {
  double rate_hz = 30;
  double young_modulus = 1e4, poisson_ratio = 0.45;  // Pa, -
  std::string element = "p1", material = {};         // more lines of [material], and its tables
  std::string fixed = "[[fixed]]\nbox = [[-1, -0.0151, -1], [1, -0.0149, 1]]\n", loads = {};
  double rayleigh_mass = 10, rayleigh_stiffness = 1e-4;  // 1/s, s
  int max_newton = 5;
  double tolerance = 1e-5;
  std::vector<std::string> tools{"radius = 0.004"};  // the lines of each [[tool]]

  /// Of this model, beside a mesh file of that name.
  std::string text(const Column& column, const std::string& mesh) const;
};

/// Where a tool is at `t` (s); places are joined by straight lines, the last one stays.
struct Waypoint {
  double t;
  Vec3 place;
};
using Path = std::vector<Waypoint>;

/// From the least to the most, N.
struct Range {
  double least, most;
};

/// A motion of tools on a body: what most cases are.
struct Trial {
  SceneFile file;
  sim::TetMesh mesh;
  std::vector<Path> paths;                   // of each tool
  std::vector<Path> slow;                    // to the same end, for the reference; empty: `paths`
  double seconds = 3;                        // of the paths, then as long again without tools
  double reference_seconds = 3;              // of the reference, at least
  int phases = 1;                            // of the motion against the steps, each a run
  double depth = 0.003;                      // m: how deep the first tool is in the body at rest, at the end
  std::vector<Vec3> outward{Vec3::UnitY()};  // of each tool: the force on it never points against that
  double bound = kBound;                     // of the force, see there
  bool only_implicit_refers = false;         // only a model of any law bears what acts here
  std::optional<double> rendered_by_rigid = {};  // of stiffness x depth; else 1
  std::optional<Range> rendered = {};            // closed form, of all models whose held vertices are walls
  double other_rest = 0.5;                       // of the force: a rest that is farther off is no neighbour
  bool path_matters = false;    // where it rests: a reference that was flagged on its way tells nothing
  bool no_rest_unbent = false;  // an organ that moves, but does not deform, has no place to rest: flagged
  bool must_refuse = false;     // of models that deform, nothing else is an answer

  // What is expected: the forces of the scene that `refer` makes of this one, times `times`; `most` times
  // that at most, where only a range is known.
  std::function<void(Trial&)> refer = {};
  std::string refers_to = {};  // in words
  double times = 1, most = 1;
};

/// A row of the table.
struct Case {
  std::string name, what;  ///< for people, with units
  bool quick;              ///< also in a quick study
  std::function<Verdict(const Case& row, const Column& column, bool quick)> run;
  std::function<void(Trial&)> change = {};  ///< from the usual press
};
const std::vector<Case>& cases();
/// The usual block, made of other tissue, moved otherwise, with other tools (`robustness_extremes.cpp`).
std::vector<Case> extreme_cases();
/// Bodies of other shapes: sheets, fins, flaps (`robustness_shapes.cpp`).
std::vector<Case> shape_cases();
/// Tools that rub, turn and grasp, and supports that move (`robustness_worlds.cpp`).
std::vector<Case> world_cases();

/// Runs the usual press as `row` changes it.
Verdict run_trial(const Case& row, const Column& column, bool quick);

/// The block of most cases: 30 x 15 x 30 mm, edges of 5 mm, top at y = 0.
sim::TetMesh usual_block();

/// From 2 mm above the block to `depth` below its top, within `t` s.
Path press(double radius, double depth, double t = 1);
/// From `from` to `to` at `speed` (m/s), 0.1 s after the beginning.
Path stroke(const Vec3& from, const Vec3& to, double speed);
/// The lines of a [[tool]].
std::string tool(double radius, const std::string& more = "");

/// Hands the simulation of a scene to `use`. Throws `Error` where the program refuses it, with the same words
/// every time.
void with_simulation(const SceneFile& file, const sim::TetMesh& mesh, const Column& column,
                     const std::function<void(const sim::Scene&, sim::Simulation&)>& use);

/// The motion `fraction` of a step later.
std::vector<Path> later(std::vector<Path> paths, double fraction, double rate_hz);

// Bodies without tools (`robustness_bodies.cpp`).
Verdict run_scattered(const Case& row, const Column& column, bool quick);
Verdict run_collapsed_to_point(const Case& row, const Column& column, bool quick);
Verdict run_collapsed_to_plane(const Case& row, const Column& column, bool quick);
/// Run as a press where the model refuses a body that nothing holds, or as one that flies.
Verdict run_free_body(const Case& row, const Column& column, bool quick);
Verdict run_undamped(const Case& row, const Column& column, bool quick);

// Tools on a body, watched step by step: those of a trial, and those that turn, rub and grasp on supports
// that rest or move; and what is held against that: another world of the same model, a closed form, or an
// equilibrium found without any contact.

constexpr double kRest = 1.0;  // s, after all motion

/// A scene with its mesh, and the hands that hold its tools.
struct World {
  SceneFile file = {};
  sim::TetMesh mesh = usual_block();
  std::function<std::vector<sim::ToolInput>(double t)> hands = {};  // t in s
  double seconds = 2;
  bool tells_path = true;  // where the tools were within each step
};

/// Forces on the tools in one step.
struct Rendered {
  double t;  // s
  std::vector<ToolPose> poses;
  std::vector<Vec3> force, torque;  // of each tool, N, N m
  bool flagged;
};

/// All of it, up to the first number that is not finite.
struct Watched {
  std::vector<Rendered> steps;
  std::size_t held = 0;  // steps before the first tool was taken away
  int flagged = 0;
  bool finite = true;
  double max_newton = 0;          // of all steps
  double max_trusted_newton = 0;  // of steps that were not flagged
  double wildest = 0;             // of forces that were not flagged
  double off = 0;                 // in the end, of the surface from where it began, m
  bool locks = false;             // the program warned at the start that its elements lock
};
Watched watch(const World& world, const Column& column);

/// A trial, watched.
struct Run : Watched {
  double arrived = 0;  // s: the last tool
  int phase = 0;       // of `Trial::phases`

  std::span<const Rendered> pressed() const { return std::span(steps).first(held); }
  const Rendered& last() const { return steps[held - 1]; }
  bool ends_flagged() const { return steps.back().flagged; }
};
/// Follows `paths`; then, where `separate`, as long again without tools. Throws `Error` where the program
/// refuses.
Run follow(const Trial& trial, const Column& column, const std::vector<Path>& paths, bool separate);

/// Judges the runs of a trial, one for each phase. Returns the worst verdict.
Verdict judge(const std::vector<Run>& runs, const Trial& trial, const Column& column);

/// Vectors of one step that should be those of another: forces, torques.
using Vectors = std::vector<Vec3>;
/// Returns the vectors expected at a step; nothing where none are known.
using Expected = std::function<std::optional<Vectors>(std::size_t step)>;
/// Returns the vectors of a step that are compared.
using Published = std::function<Vectors(const Rendered&)>;

/// The force on the first tool; with its torque.
Vectors force_of(const Rendered& rendered);
Vectors force_and_torque_of(const Rendered& rendered);

/// The steps of another world from `from` (s) on, but those it flagged.
Expected as_in(Watched other, Published published, double from = 0);

/// Expects `right` in the last `seconds` (s) of that world.
Expected at_the_end(const World& world, Vectors right, double seconds = 0.5 * kRest);

/// Stable, flagged or exploded: before it is held against anything.
Verdict verdict_of(const Watched& watched, const std::string& reference);

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
/// Returns the forces on tools that move these vertices while the rest of the body, of any law, is in
/// equilibrium, N.
Vectors reactions(const World& world, const Column& column, const std::vector<Gripped>& grips);

/// The work that tools do on the hands that hold them, by the trapezoidal rule in places and turns: J; and
/// of all steps by its size.
struct Work {
  double sum = 0, size = 0;
};
Work work_of(const Watched& watched);

/// Settings of a row: how extreme it is.
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
/// Returns that block under one tool that follows `way` and rests.
World under_tool(const Setting& setting, const Direction& way);
/// One tool there, or lifted.
sim::ToolInput at(const Vec3& p, const Quat& q = Quat::Identity());

/// Worlds that differ by rounding, by what Newton may leave: of the force.
constexpr double kSame = 1e-3;

/// Function that runs a row with one setting and one model.
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
