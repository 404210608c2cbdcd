#include "sim_server/deformation/near_tools.h"

#include <algorithm>

namespace palpate::sim {

NearTools::NearTools(const ModelInputs& inputs) : has_(inputs.surface.vertices.size(), 0) {
  constexpr double kStretched = 2;  // edges are no longer than that of their length at rest
  std::vector<double> longest(inputs.mesh.vertices.size(), 0);
  for (const Tetrahedron& t : inputs.mesh.tetrahedra) {
    for (const auto& [a, b] : kEdges) {
      const double length = (inputs.mesh.vertices[t[a]] - inputs.mesh.vertices[t[b]]).norm();
      for (const int vertex : {t[a], t[b]}) longest[vertex] = std::max(longest[vertex], length);
    }
  }
  for (const int node : inputs.surface.vertices)
    reach_.push_back(kStretched * longest[static_cast<std::size_t>(node)]);
  vertices_.reserve(has_.size());
}

void NearTools::look_in(std::span<const Neighbourhood> places, std::span<const int> all,
                        std::span<const Vec3> positions, double way) noexcept {
  for (const int vertex : vertices_) has_[static_cast<std::size_t>(vertex)] = 0;
  vertices_.clear();
  narrowed_ = !places.empty();
  if (!narrowed_) return;
  for (const int vertex : all) {
    const auto v = static_cast<std::size_t>(vertex);
    const auto is_in = [&](const Neighbourhood& place) {
      return (positions[v] - place.middle).norm() <= place.radius + reach_[v] + way;
    };
    if (std::ranges::any_of(places, is_in)) add(vertex);
  }
}

bool NearTools::add(int vertex) noexcept {
  char& has = has_[static_cast<std::size_t>(vertex)];
  if (has != 0) return false;
  has = 1;
  vertices_.push_back(vertex);
  return true;
}

}  // namespace palpate::sim
