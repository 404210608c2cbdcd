#include "sim_server/contact/tissue.h"

#include <algorithm>
#include <numeric>

namespace palpate::sim {
namespace {

double largest_move(std::span<const Vec3> from, std::span<const Vec3> to) noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    largest = std::max(largest, (to[i] - from[i]).cwiseAbs().maxCoeff());
  return largest;
}

}  // namespace

void Tissue::reserve(std::span<const int> most_loads, std::span<const double> still) {
  const auto all = static_cast<std::size_t>(std::accumulate(most_loads.begin(), most_loads.end(), 0));
  tools_.resize(most_loads.size());
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tools_[i].loads.reserve(all);
    tools_[i].free = free;
    tools_[i].still = still[i];
    if (tools_.size() > 1) tools_[i].pushed.assign(free.begin(), free.end());
  }
}

ToolTissue Tissue::met_by(std::size_t tool) {
  return {*this, tool, meet(tool)};
}

/// Takes over the loads that the other tools put on the tissue by now. Returns whether that moved what is
/// free to this tool.
bool Tissue::meet(std::size_t tool) {
  ToolLoads& mine = tools_[tool];
  const auto loaded = [&](const ToolLoads& other) { return &other != &mine && !other.own().empty(); };
  if (mine.others == 0 && std::ranges::none_of(tools_, loaded)) {
    mine.free = free;
    return false;
  }
  auto& loads = mine.loads;
  loads.erase(loads.begin(), loads.begin() + static_cast<long>(mine.others));
  const std::size_t own = loads.size();
  for (const ToolLoads& other : tools_) {
    if (!loaded(other)) continue;
    const auto theirs = other.own();
    loads.insert(loads.end(), theirs.begin(), theirs.end());
  }
  mine.others = loads.size() - own;
  std::rotate(loads.begin(), loads.begin() + static_cast<long>(own), loads.end());
  positions = model->apply(std::span(loads).first(mine.others));
  const bool moved = largest_move(mine.free, positions) > mine.still;
  if (moved || mine.free.data() != mine.pushed.data())
    std::copy(positions.begin(), positions.end(), mine.pushed.begin());
  mine.free = mine.pushed;
  if (own > 0) press(tool);
  return moved;
}

void ToolTissue::set_loads(std::span<const NodalLoad> loads) {
  auto& mine = tissue_.tools_[tool_];
  mine.loads.erase(mine.loads.begin() + static_cast<long>(mine.others), mine.loads.end());
  mine.loads.insert(mine.loads.end(), loads.begin(), loads.end());
}

void ToolTissue::release() {
  if (loads().empty()) return;
  drop_loads();
  press();
}

std::span<NodalLoad> ToolTissue::loads_on(std::span<const int> vertices) {
  auto& mine = tissue_.tools_[tool_];
  const auto same = [](const NodalLoad& load, int vertex) { return load.vertex == vertex; };
  const auto own = mine.own();
  if (!std::equal(own.begin(), own.end(), vertices.begin(), vertices.end(), same)) {
    drop_loads();
    for (const int vertex : vertices) add_load({vertex, Vec3::Zero()});
  }
  return std::span(mine.loads).subspan(mine.others);
}

}  // namespace palpate::sim
