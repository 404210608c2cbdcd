#pragma once
/// Refuses a scene that the memory of the machine will not hold, before anything is allocated.
#include "common/memory_budget.h"
#include "sim_server/scene/scene.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/tissue/estimated_memory.h"

namespace palpate::sim {

/// Throws `Error` naming the scene and the estimate where the elements and matrices of the scene's model, or
/// for `Purpose::kSolve` those of a solution without a tool, are more than `free` bytes. The factor of the
/// matrix, which depends on the order of elimination, and the compliance are checked where they are made.
void require_memory_for(const Scene& scene, Purpose purpose, const MeshCounts& counts,
                        double free = free_memory());

}  // namespace palpate::sim
