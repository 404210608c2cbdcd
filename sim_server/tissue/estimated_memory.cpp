#include "sim_server/tissue/estimated_memory.h"

#include <algorithm>

namespace palpate::sim {
namespace {

constexpr double kReal = sizeof(double), kInt = sizeof(int), kVec = 3 * kReal;  // bytes
constexpr double kEntry = kReal + kInt;                                         // of a sparse matrix
constexpr double kTwoRing = 4.9;  // pairs of vertices at most two edges apart, per edge: measured 4.1 to 4.8

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

double nodes_of(const MeshCounts& counts, ElementKind element) {
  return counts.vertices + (element == ElementKind::kQuadratic ? counts.edges : 0);
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
  return (9 * kEntry + kInt) * blocks + 5 * kInt * nodes;
}

double tensors_bytes(const MeshCounts& counts) {
  const double held = counts.vertices * (6 * kReal + kInt) + counts.edges * (9 * kReal + kInt);
  return held + counts.tetrahedra * 6 * 2 * kInt;
}

double body_bytes(const MeshCounts& counts, ElementKind element, int matrices) {
  const double solid = solid_bytes(counts, element);
  return std::max(2 * solid, solid + matrices * matrix_bytes(counts, element) + list_bytes(counts, element));
}

}  // namespace palpate::sim
