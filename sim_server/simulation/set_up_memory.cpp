#include "sim_server/simulation/set_up_memory.h"

#include <algorithm>
#include <fmt/core.h>

#include "sim_server/scene/held_motion.h"

namespace palpate::sim {
namespace {

constexpr double kReal = sizeof(double), kInt = sizeof(int), kVec = 3 * kReal;
constexpr double kEntry = kReal + kInt;  // of a sparse matrix
constexpr double kTwoRing = 4.9;  // pairs of vertices at most two edges apart, per edge: measured 4.1 to 4.8

double nodes_of(const MeshCounts& counts, ElementKind element) {
  return counts.vertices + (element == ElementKind::kQuadratic ? counts.edges : 0);
}

/// Pairs of different nodes whose forces depend on each other.
double pairs_of(const MeshCounts& counts, ElementKind element) {
  if (element == ElementKind::kLinear) return counts.edges;
  if (element == ElementKind::kNodalPressure) return kTwoRing * counts.edges;
  // Two vertices share an edge, a vertex and a middle an edge or a face, two middles a face or a tetrahedron.
  return counts.edges + (2 * counts.edges + 3 * counts.faces) + (3 * counts.faces + 3 * counts.tetrahedra);
}

/// Lists of neighbours that a matrix is made from.
double list_bytes(const MeshCounts& counts, ElementKind element) {
  switch (element) {
    case ElementKind::kQuadratic:
      return 330 * counts.tetrahedra;  // all three measured
    case ElementKind::kNodalPressure:
      return 140 * counts.tetrahedra;
    default:
      return 54 * counts.tetrahedra;
  }
}

/// Of a body and `matrices` of its stiffness, at the worst moment. Arrays that grow are copied once.
double body_bytes(const MeshCounts& counts, ElementKind element, int matrices) {
  const double solid = solid_bytes(counts, element);
  return std::max(2 * solid, solid + matrices * matrix_bytes(counts, element) + list_bytes(counts, element));
}

}  // namespace

MeshCounts count_parts(const TetMesh& mesh, const Surface& surface) {
  MeshCounts counts;
  counts.vertices = mesh.corners();
  counts.tetrahedra = static_cast<double>(mesh.tetrahedra.size());
  counts.faces =
      2 * counts.tetrahedra + 0.5 * static_cast<double>(surface.triangles.size()) / surface.per_face;
  counts.edges = counts.vertices + counts.faces - counts.tetrahedra - 1;
  return counts;
}

double solid_bytes(const MeshCounts& counts, ElementKind element) {
  const bool quadratic = element == ElementKind::kQuadratic;
  const double corners = quadratic ? 10 : 4, points = quadratic ? 4 : 1;
  double bytes = nodes_of(counts, element) * kVec +
                 counts.tetrahedra * (corners * kInt + points * (kReal + corners * kVec));
  if (element == ElementKind::kNodalPressure)
    bytes += counts.tetrahedra * (4 * kInt + kReal) + counts.vertices * (kInt + 2 * kReal);
  return bytes;
}

double matrix_bytes(const MeshCounts& counts, ElementKind element) {
  const double nodes = nodes_of(counts, element), blocks = nodes + pairs_of(counts, element);
  return 9 * kEntry * blocks + 4 * kInt * nodes;
}

double tensors_bytes(const MeshCounts& counts) {
  const double held = counts.vertices * (6 * kReal + kInt) + counts.edges * (9 * kReal + kInt);
  return held + counts.tetrahedra * 6 * 2 * kInt;
}

void require_memory_for(const Scene& scene, Purpose purpose, const MeshCounts& counts, double free) {
  if (!scene.material) return;  // the model asks for one, where it needs it
  const ElementKind element = scene.material->element;
  const std::string& model = scene.deformation.model;
  double bytes = 0;
  if (purpose == Purpose::kSolve) {
    bytes = body_bytes(counts, element, 2);  // of now, and at rest
  } else if (model == "implicit") {
    // To find the shape under loads or on supports that move, of now and at rest besides.
    const bool loaded = !scene.loads.empty() || supports_move(scene);
    bytes = body_bytes(counts, element, loaded ? 3 : 1);
    if (scene.deformation.solver != DynamicsSettings::Solver::kDirect)  // another of each in the background
      bytes += solid_bytes(counts, element) + matrix_bytes(counts, element);
  } else if (model == "quasi_static" || model == "reduced") {
    bytes = body_bytes(counts, element, 1);
    // Vectors that modes are found among, and what is kept of them.
    if (model == "reduced")
      bytes += 3 * nodes_of(counts, element) * kReal * (3.0 * scene.deformation.modes + 20);
  } else if (model == "tensor_mass") {
    bytes = tensors_bytes(counts) + (supports_move(scene) ? body_bytes(counts, element, 1) : 0);
  }
  if (!scene.inclusions.empty()) bytes += 2 * counts.tetrahedra * kReal;  // in the mesh and in its solid
  require_memory(bytes, free, scene.source,
                 fmt::format("the stiffness of {:.0f} tetrahedra", counts.tetrahedra),
                 element == ElementKind::kQuadratic ? "take a coarser mesh, or another `element`"
                                                    : "take a coarser mesh");
}

}  // namespace palpate::sim
