#pragma once
#include "common/memory_budget.h"
#include "sim_server/mesh/surface.h"
#include "sim_server/scene/scene.h"
#include "sim_server/setup_cache/condensed.h"
#include "sim_server/setup_cache/setup_cache.h"
#include "sim_server/tissue/setup_stages.h"

namespace palpate::sim {

/// Inputs of the set-up of a model. `fixed`: mesh vertices that move only with their [[fixed.motion]],
/// ascending; of a mesh that can be parted also all spare ones, which are of no tetrahedron until they are
/// copies of others. `reachable`: surface vertices the tool can load.
struct ModelInputs {
  const Scene& scene;
  const TetMesh& mesh;
  const Surface& surface;
  const std::vector<int>& fixed;
  const std::vector<int>& reachable;
  const Progress& progress;
  double free_bytes = free_memory();     ///< that it may take
  const SetupCache* cache = nullptr;     ///< where it may find what another start computed, and keep it
  const Condensed* condensed = nullptr;  ///< where it finds or keeps that instead
};

/// Returns the vertices of `fixed` that are at rest now. `fixed` holds all spare vertices of a mesh that can
/// be parted; a spare that became a copy of another vertex is in motion and has a place (>= 0 in `places`).
/// Ascending where `fixed` is.
std::vector<int> fixed_now(std::span<const int> fixed, std::span<const int> places);

/// Returns the stiffness (N/m) of a vertex of a [[fixed]] under a tool, for every model: 2000, which the
/// limits of clients and devices can render (`[limits] force` at 4 mm), or ten times Young's modulus times
/// the largest tool's radius where that is more, so that what holds a tissue is harder than it. An infinitely
/// hard wall would be a kick. A force between vertices is shared by them: the wall is at most three times as
/// stiff as one.
double held_stiffness(const Scene& scene);

/// 1 / rate_hz of the scene, s, for a model whose steps all take that long. Throws `Error` where it is 0.
double step_period(const Scene& scene);

}  // namespace palpate::sim
