#pragma once
/// Scenes at the extremes, with every model: what a cell of `scripts/study robustness` runs, and its verdict.
#include <functional>
#include <optional>
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

/// What a run showed.
struct Run {
  /// The forces on the tools at a step while they are there, N.
  struct Held {
    double t;  // s
    std::vector<Vec3> force;
    bool flagged;
  };
  std::vector<Held> held;  // from the first step until all are taken away
  double arrived = 0;      // s: the last tool
  std::vector<Vec3> last;  // the force on each tool while it was there, N
  double max_newton = 0;   // of all steps
  double wildest = 0;      // of those that were not flagged
  int steps = 0, flagged = 0;
  int phase = 0;                 // of `Trial::phases`
  bool pressed_flagged = false;  // when `last` was felt
  bool finite = true, ends_flagged = false;
  bool locks = false;  // the program warned at the start that its elements lock
  double off = 0;      // from where the surface began, when the tools have been away, m
};

/// Hands the simulation of a scene to `use`. Throws `Error` where the program refuses it, with the same words
/// every time.
void with_simulation(const SceneFile& file, const sim::TetMesh& mesh, const Column& column,
                     const std::function<void(const sim::Scene&, sim::Simulation&)>& use);

/// The motion `fraction` of a step later.
std::vector<Path> later(std::vector<Path> paths, double fraction, double rate_hz);

/// Follows `paths`; then, where `separate`, as long again without tools. Throws `Error` where the program
/// refuses.
Run follow(const Trial& trial, const Column& column, const std::vector<Path>& paths, bool separate);

/// What is held against the runs of a trial, one for each phase: the worst of them.
Verdict judge(const std::vector<Run>& runs, const Trial& trial, const Column& column);

// Bodies without tools (`robustness_bodies.cpp`).
Verdict run_scattered(const Case& row, const Column& column, bool quick);
Verdict run_collapsed_to_point(const Case& row, const Column& column, bool quick);
Verdict run_collapsed_to_plane(const Case& row, const Column& column, bool quick);
/// Run as a press where the model refuses a body that nothing holds, or as one that flies.
Verdict run_free_body(const Case& row, const Column& column, bool quick);
Verdict run_undamped(const Case& row, const Column& column, bool quick);

}  // namespace palpate::studies
