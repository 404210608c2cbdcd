#pragma once
/// What setting a scene up takes, told by formula before anything is allocated.
#include "common/memory_budget.h"
#include "sim_server/mesh/surface.h"
#include "sim_server/scene/scene.h"
#include "sim_server/scene_file/read_scene.h"

namespace palpate::sim {

/// How many there are of each in a mesh.
struct MeshCounts {
  double vertices = 0, edges = 0, faces = 0, tetrahedra = 0;
};

/// Of `mesh`, without what `add_mid_edges` put there; edges by Euler's formula, as of a body without handles
/// and voids (each changes it by one). O(1).
MeshCounts count_parts(const TetMesh& mesh, const Surface& surface);

/// Bytes that a `Solid` of these elements holds.
double solid_bytes(const MeshCounts& counts, ElementKind element);
/// Bytes that its `StiffnessMatrix` holds, nothing fixed.
double matrix_bytes(const MeshCounts& counts, ElementKind element);
/// Bytes that `ElasticTensors` take while they are built, nothing fixed.
double tensors_bytes(const MeshCounts& counts);

/// Throws `Error` naming the scene and the estimate where the elements and matrices of the scene's model, or
/// for `Purpose::kSolve` those of a solution without a tool, are more than `free` bytes. The factor of the
/// matrix, which depends on the order of elimination, and the compliance are checked where they are made.
void require_memory_for(const Scene& scene, Purpose purpose, const MeshCounts& counts,
                        double free = free_memory());

}  // namespace palpate::sim
