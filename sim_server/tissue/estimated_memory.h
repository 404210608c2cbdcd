#pragma once
/// Memory of a model by formula, before anything is allocated.
#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/surface.h"

namespace palpate::sim {

/// Counts of the parts of a mesh.
struct MeshCounts {
  double vertices = 0, edges = 0, faces = 0, tetrahedra = 0;
};

/// Counts the parts of `mesh`, without the nodes of `add_mid_edges`; edges by Euler's formula, as of a body
/// without handles and voids (each changes it by one). O(1).
MeshCounts count_parts(const TetMesh& mesh, const Surface& surface);

/// Vertices, and for quadratic elements the middles of edges.
double nodes_of(const MeshCounts& counts, ElementKind element);
/// Bytes that a `Solid` of these elements holds.
double solid_bytes(const MeshCounts& counts, ElementKind element);
/// Bytes that its `StiffnessMatrix` holds, nothing fixed.
double matrix_bytes(const MeshCounts& counts, ElementKind element);
/// Bytes that `ElasticTensors` take while they are built, nothing fixed.
double tensors_bytes(const MeshCounts& counts);
/// Bytes of a body and `matrices` of its stiffness, at the worst moment of their set-up. Arrays that grow are
/// copied once.
double body_bytes(const MeshCounts& counts, ElementKind element, int matrices);

}  // namespace palpate::sim
