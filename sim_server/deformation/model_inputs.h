#pragma once
#include "common/memory_budget.h"
#include "sim_server/deformation/setup_stages.h"
#include "sim_server/mesh/surface.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// What a model is built from. `fixed`: mesh vertices that move only with their [[fixed.motion]].
/// `reachable`: surface vertices the tool can load.
struct ModelInputs {
  const Scene& scene;
  const TetMesh& mesh;
  const Surface& surface;
  const std::vector<int>& fixed;
  const std::vector<int>& reachable;
  const Progress& progress;
  double free_bytes = free_memory();  ///< that it may take
};

/// 1 / rate_hz of the scene, s, for a model whose steps all take that long. Throws `Error` where it is 0.
double step_period(const Scene& scene);

}  // namespace palpate::sim
