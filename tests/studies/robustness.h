#pragma once
/// Scenes at the extremes, with every model: what a cell of `scripts/study robustness` runs, and its verdict.
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/contact/tool.h"
#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::studies {

/// A deformation model, with a law where it takes several.
struct Column {
  std::string_view name, model, law;
  sim::ElasticLaw elastic;
  bool implicit() const { return model == "implicit"; }
  bool linear() const { return law == "linear"; }
};
const std::vector<Column>& columns();

/// What came of one cell.
struct Verdict {
  std::string outcome;                  ///< stable, refused, flagged, exploded, not_applicable
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

/// A motion of tools on a block: what most cases are.
struct Trial {
  SceneFile file;
  sim::TetMesh mesh;
  std::vector<Path> paths;                   // of each tool
  std::vector<Path> slow;                    // to the same end, for the reference; empty: `paths`
  double seconds = 3;                        // of the paths, then as long again without tools
  double reference_seconds = 3;              // of the reference, at least
  double depth = 0.003;                      // m: how deep the first tool is in the block at rest, at the end
  bool only_implicit_refers = false;         // only `implicit` bears what acts here
  std::optional<double> felt_by_rigid = {};  // of stiffness x depth; else 1
};

/// A row of the table.
struct Case {
  std::string_view name, what;  ///< for people, with units
  bool quick;                   ///< also in a quick study
  Verdict (*run)(const Case& row, const Column& column, bool quick);
  void (*change)(Trial& trial) = nullptr;  ///< from the usual press
};
const std::vector<Case>& cases();

/// Runs the usual press as `row` changes it.
Verdict run_trial(const Case& row, const Column& column, bool quick);

/// The block of most cases: 30 x 15 x 30 mm, edges of 5 mm, top at y = 0.
sim::TetMesh usual_block();

// Bodies without tools (`robustness_bodies.cpp`).
Verdict run_scattered(const Case& row, const Column& column, bool quick);
Verdict run_collapsed_to_point(const Case& row, const Column& column, bool quick);
Verdict run_collapsed_to_plane(const Case& row, const Column& column, bool quick);
/// Run as a press where the model refuses a body that nothing holds, or as one that flies.
Verdict run_free_body(const Case& row, const Column& column, bool quick);
Verdict run_undamped(const Case& row, const Column& column, bool quick);

}  // namespace palpate::studies
