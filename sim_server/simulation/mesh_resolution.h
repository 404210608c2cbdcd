#pragma once
#include <optional>
#include <span>
#include <vector>

#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/surface.h"
#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// Resolution of the mesh where a tool presses on it, in elements to a radius of the tool: its radius over
/// the mean edge of the elements at each loaded vertex, at rest, weighted by its load. One thread.
class MeshResolution {
 public:
  /// `rest`: vertices of the surface, m; `radius` of the tool, m. O(vertices).
  MeshResolution(const Surface& surface, std::span<const Vec3> rest, double radius);
  /// Measures all edges of the tetrahedra around a vertex that is inside `mesh` at first, as `surface` has
  /// them for an organ that is cut.
  MeshResolution(const Surface& surface, std::span<const Vec3> rest, double radius, const TetMesh& mesh);

  /// Mean over what the tool loads in one step; nothing where it loads nothing. O(loads); does not allocate.
  std::optional<double> of(std::span<const VertexLoad> loads) const noexcept;
  /// Returns the finest resolution that a tool can touch; nothing where it can touch nothing. O(triangles).
  std::optional<double> finest(std::span<const Triangle> touchable) const;
  /// Adds what the tool loads in one step. O(loads); does not allocate.
  void add(std::span<const VertexLoad> loads) noexcept;
  /// Mean over all loads so far; nothing before the first.
  std::optional<double> elements_per_radius() const noexcept;
  std::size_t bytes() const noexcept { return fineness_.size() * sizeof(double); }

 private:
  void set_inside(const Surface& surface, const TetMesh& mesh, double radius);

  std::vector<double> fineness_;  // of each vertex: radius / mean edge
  struct Sums {
    double elements = 0, weight = 0;
  };
  Sums sums_of(std::span<const VertexLoad> loads) const noexcept;
  Sums all_;
};

/// Returns the error of the force (% of its root mean square) by a mesh of so many elements to a radius of
/// the tool: from a table measured on a liver under a sphere (tests/studies/RESULTS.md), interpolated in
/// logarithms, held at its ends. A guess for another shape; `sim_server study` measures that. Nothing for
/// elements that are not in the table.
std::optional<double> estimated_mesh_error(ElementKind element, double elements_per_radius) noexcept;

}  // namespace palpate::sim
