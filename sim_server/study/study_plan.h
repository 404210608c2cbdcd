#pragma once
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// Options of `sim_server study`.
struct StudyOptions {
  std::filesystem::path scene, out;
  std::vector<std::filesystem::path> meshes;        ///< of the same organ, coarser or finer
  std::optional<std::filesystem::path> trajectory;  ///< CSV (t_s, x_m, y_m, z_m); absent: pressed and slid
  std::optional<double> budget_ms;                  ///< for a step
  double latency_ms = 5;  ///< of the link, from the end of a step to the force in the client, [0, 1000]
  bool quick = false;
};

/// Case of a study: one way to compute the scene.
struct StudyCase {
  std::string axis;  ///< along which it differs from the scene: "scene", "model", "element", "mesh", ...
  Scene scene;       ///< its own mesh file; fixed regions as `surface_tag`s that refinement keeps
  double refinements = 0;  ///< of that mesh: so often `refined`, and `halved` for a half
  double edge = 0;         ///< m: then cut until edges near `near` are no longer; 0: not
  Box near{};              ///< m, at rest; away from it edges may grow

  /// "quasi_static linear p1 6342 33.3ms", for files and messages; the mesh by its number of refinements.
  std::string name() const;
};

/// Plan of a study: the scene's own setting, one axis at a time around it, and the reference for all.
struct StudyPlan {
  std::vector<StudyCase> cases;
  StudyCase reference;  ///< same law, a short step, on the finest mesh or element that is affordable
  StudyCase check;  ///< half as fine in space and time: what the two differ by bounds the reference's error
  double most_nodes = 0;  ///< of the reference
};

/// Makes the mesh of the reference as fine near `near` (m, at rest) as its nodes allow, that of the check
/// half as fine; where they allow nothing, the check has the element of the scene, or p1, and cases as fine
/// go. Throws `Error`.
void refine_references(StudyPlan& plan, const Box& near);

/// The mesh of a case. Throws `Error`.
TetMesh mesh_of(const StudyCase& one);
/// Its simulation, with progress reported. Throws `Error`.
Simulation simulation_of(const StudyCase& one, const Progress& progress = kSilent);

/// Plans the study of a scene. Throws `Error` for a scene without tissue. Set-up only; reads meshes.
StudyPlan plan_study(const Scene& scene, const StudyOptions& options);

}  // namespace palpate::sim
