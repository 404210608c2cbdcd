// How a step removes tissue: parts of Simulation.
#include <algorithm>
#include <utility>

#include "sim_server/simulation/simulation.h"
#include "sim_server/simulation/touchable.h"

namespace palpate::sim {
namespace {

constexpr double kRounding = 1e-9;  // s

bool is_hot(const ToolSettings& settings, const ToolContact& tool, const ToolInput& input) {
  return (input.buttons & settings.cut_buttons) != 0 && input.pose && tool.placed();
}

}  // namespace

void Simulation::remove_at(std::vector<Removal> removals) {
  cut_->planned = std::move(removals);
  cut_->done = 0;
}

/// `dt` of heat along the way of the tips in the step before; or what was planned for now.
std::span<const int> Simulation::remove_tissue(std::span<const ToolInput> inputs, double dt) {
  Cut& cut = *cut_;
  if (!cut.planned) {
    cut.tips.clear();
    cut.hot_at.resize(tools_.size());
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      std::optional<Vec3> from = std::exchange(cut.hot_at[i], std::nullopt);
      if (!is_hot(cut.tools[i], tools_[i], inputs[i])) continue;
      const Vec3& p = tools_[i].place();
      cut.tips.push_back({from.value_or(p), p, tools_[i].radius()});
      cut.hot_at[i] = p;
    }
    return cut.resection.advance(cut.tips, tissue_.positions, dt, surface_);
  }
  std::vector<int> due = std::exchange(cut.waiting, {});
  for (; cut.done < cut.planned->size() && (*cut.planned)[cut.done].t <= time_ + kRounding; ++cut.done) {
    due.push_back((*cut.planned)[cut.done].tetrahedron);
  }
  std::erase_if(due, [&](int tetrahedron) {
    const CutMesh& left = cut.resection.left();
    if (!left.is_left(tetrahedron)) return true;
    if (left.removable(tetrahedron) == Removable::kLater) cut.waiting.push_back(tetrahedron);
    return !left.is_removable(tetrahedron);
  });
  std::ranges::sort(due);
  due.erase(std::unique(due.begin(), due.end()), due.end());
  return cut.resection.remove(due, surface_);
}

/// Before the tissue goes on.
void Simulation::cut(std::span<const ToolInput> inputs, double dt) {
  const DeformationModel::Growth growth = tissue_.model->grow(cut_->resection.left());
  cut_->resection.grow(growth);
  if (!growth.allowed.empty()) tissue_.note_same_place();
  const std::span<const int> removed = remove_tissue(inputs, dt);
  if (removed.empty()) return;
  for (const int tetrahedron : cut_->resection.asked_for()) cut_->removed.push_back({time_, tetrahedron});
  const DeformationModel::Removed gone = tissue_.model->remove(removed, cut_->resection.left());
  ResectionTotals& totals = cut_->resection.totals();
  totals.elastic += gone.elastic;
  totals.kinetic += gone.kinetic;
  totals.momentum += gone.momentum;
  change_surface();
}

void Simulation::change_surface() {
  const CutMesh& left = cut_->resection.left();
  const auto on_surface = [&left](int vertex) { return left.on_surface(vertex); };
  tissue_.drop_loads(on_surface);
  auto touchable = touchable_by(cut_->tools, surface_, *mesh_);
  for (std::size_t i = 0; i < tools_.size(); ++i)
    tools_[i].change_surface(rest_, surface_, std::move(touchable[i]), on_surface);
}

/// What a step with a hot tip came to.
void Simulation::note_cut(std::span<const ToolInput> inputs, double dt) {
  bool touched = false;
  for (std::size_t i = 0; i < tools_.size(); ++i)
    touched = touched || (is_hot(cut_->tools[i], tools_[i], inputs[i]) && tools_[i].force().contacts > 0);
  ResectionTotals& totals = cut_->resection.totals();
  if (touched) totals.contact_time += dt;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (!is_hot(cut_->tools[i], tools_[i], inputs[i])) continue;
    cut_->log.push_back(
        {time_, i, tools_[i].place(), tools_[i].force().force, tools_[i].force().contacts > 0, totals});
  }
}

}  // namespace palpate::sim
