#include "sim_server/contact/surface_change.h"

#include <algorithm>

namespace palpate::sim {

void SurfaceChange::apply_to(std::vector<VertexLoad>& loads) const {
  for (const Split& split : splits) {
    for (std::size_t i = 0, end = loads.size(); i < end; ++i) {  // of each tool that presses there
      if (loads[i].vertex != split.vertex) continue;
      loads[i].force /= 2;
      loads.push_back({split.copy, Vec3(loads[i].force)});
    }
  }
  std::erase_if(loads, [this](const VertexLoad& load) { return !on_surface(load.vertex); });
}

std::map<int, int> SurfaceChange::origins() const {
  std::map<int, int> origins;
  for (const Split& split : splits) {
    const auto earlier = origins.find(split.vertex);  // a copy may become two itself
    origins[split.copy] = earlier == origins.end() ? split.vertex : earlier->second;
  }
  return origins;
}

}  // namespace palpate::sim
