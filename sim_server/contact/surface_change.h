#pragma once
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// Change of the surface by cuts since the last one. First vertices became two, then others left the surface.
struct SurfaceChange {
  std::span<const Vec3> rest;           ///< surface vertices at rest, m
  const Surface& surface;               ///< as it is now
  std::function<bool(int)> on_surface;  ///< false: this vertex is on no triangle any more
  std::span<const Split> splits = {};   ///< surface vertices that became two, in order

  /// Lets loads follow: a vertex and its copy bear half each, the copies come last, and loads on vertices
  /// that left the surface go. Allocates.
  void apply_to(std::vector<VertexLoad>& loads) const;
  /// Returns the vertex that each copy was before this change.
  std::map<int, int> origins() const;
};

}  // namespace palpate::sim
