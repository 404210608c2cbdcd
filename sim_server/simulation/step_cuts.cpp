// How a step removes tissue: parts of Simulation.
#include <algorithm>
#include <utility>

#include "sim_server/simulation/simulation.h"
#include "sim_server/simulation/touchable.h"

namespace palpate::sim {
namespace {

constexpr double kRounding = 1e-9;   // s
constexpr double kAtRest = 6e-4;     // m/s: a blade that goes slower is felt less
constexpr double kWorkedOff = 1e-7;  // J: what a blade that was let go still owes is felt no more

bool is_hot(const ToolSettings& settings, const ToolContact& tool, const ToolInput& input) {
  return (input.buttons & settings.cut_buttons) != 0 && input.pose && tool.placed();
}

}  // namespace

void Simulation::remove_at(std::vector<Removal> removals) {
  cut_->planned = std::move(removals);
  cut_->done = 0;
}

/// `dt` of heat along the way of the tips that were hot in the step before; or what was planned for now.
std::span<const int> Simulation::remove_tissue(std::span<const ToolInput> inputs, double dt) {
  Cut& cut = *cut_;
  if (!cut.planned) {
    cut.tips.clear();
    cut.hot_at.resize(tools_.size());
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      const Vec3& p = tools_[i].place();
      const std::optional<Vec3> from = std::exchange(cut.hot_at[i], std::nullopt);
      if (from && tools_[i].placed()) cut.tips.push_back({*from, p, tools_[i].radius()});
      if (!cut.tools[i].blade && is_hot(cut.tools[i], tools_[i], inputs[i])) cut.hot_at[i] = p;
    }
    return cut.resection.advance(cut.tips, tissue_.positions, dt, surface_);
  }
  std::vector<int> due;
  for (; cut.done < cut.planned->size() && (*cut.planned)[cut.done].t <= time_ + kRounding; ++cut.done) {
    due.push_back((*cut.planned)[cut.done].tetrahedron);
  }
  std::erase_if(due, [&](int tetrahedron) {
    const CutMesh& left = cut.resection.left();
    return !left.is_left(tetrahedron) || !left.is_removable(tetrahedron);
  });
  std::ranges::sort(due);
  due.erase(std::unique(due.begin(), due.end()), due.end());
  return cut.resection.remove(due, surface_);
}

/// Before the tissue goes on.
void Simulation::cut(std::span<const ToolInput> inputs, double dt) {
  cut_->resection.begin_step();
  const std::span<const int> removed = remove_tissue(inputs, dt);
  if (!removed.empty()) {
    for (const int tetrahedron : cut_->resection.asked_for()) cut_->removed.push_back({time_, tetrahedron});
    count_gone(tissue_.model->remove(removed, cut_->resection.left()));
    tissue_.note_same_place();  // of what is shown now, too
  }
  if (!cut_->planned) part_tissue(inputs, dt);
  if (cut_->resection.version() != cut_->touchable_version) change_surface();
  tell_near(inputs);
}

/// Another surface, or none, is told from this step on.
void Simulation::tell_near(std::span<const ToolInput> inputs) {
  Cut& cut = *cut_;
  cut.told_near.clear();
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (inputs[i].wants.surface_shift && inputs[i].pose)
      cut.told_near.push_back({inputs[i].pose->p_W, inputs[i].v_W});
  }
  tissue_.model->tell_near(cut.told_near, cut.resection.left(), !hurries_);
  std::shared_ptr<const ToldSurface> told = tissue_.model->told();
  if (told == cut.told) return;
  cut.told = std::move(told);
  ++told_version_;
  make_room_for_modes();
}

void Simulation::count_gone(const DeformationModel::Removed& gone) {
  ResectionTotals& totals = cut_->resection.totals();
  totals.elastic += gone.elastic;
  totals.kinetic += gone.kinetic;
  totals.momentum += gone.momentum;
}

/// Along the way of the blades in the step before.
void Simulation::part_tissue(std::span<const ToolInput> inputs, double dt) {
  Cut& cut = *cut_;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    std::optional<Blade>& blade = cut.blades[i];
    if (!cut.tools[i].blade) continue;
    const bool cuts = is_hot(cut.tools[i], tools_[i], inputs[i]);
    if (!tools_[i].placed() || (!cuts && blade && !blade->was && blade->owed < kWorkedOff)) blade.reset();
    if (!blade && !cuts) continue;
    if (!blade) blade.emplace();
    const ToolPose& pose = tools_[i].pose();
    blade->is = {pose.p_W, pose.p_W + pose.q_W * *cut.tools[i].blade};
    if (blade->was) {
      part_by(i, dt);
      if (!cuts) blade->was.reset();  // that was the way before it was let go
    } else if (cuts) {
      blade->trail.setZero();
      blade->was = blade->is;
      blade->were.assign(tissue_.positions.begin(), tissue_.positions.end());
    }
  }
}

void Simulation::part_by(std::size_t tool, double dt) {
  Blade& blade = *cut_->blades[tool];
  Resection& resection = cut_->resection;
  std::vector<Vec3> are(tissue_.positions.begin(), tissue_.positions.end());
  std::vector<int> touched;  // by others: what one holds stays in its grip
  for (std::size_t other = 0; other < tools_.size(); ++other) {
    if (other == tool) continue;
    for (const NodalLoad& load : tissue_.loads_of(other))
      touched.push_back(surface_.vertices[static_cast<std::size_t>(load.vertex)]);
  }
  resection.keep(std::move(touched));
  const Parted& parted = resection.part({*blade.was, blade.is, blade.trail}, blade.were, are, surface_);
  if (!parted.stroke.moved) return;
  if (parted.stroke.at_end) resection.totals().time_at_end += dt;
  blade.was = blade.is;
  blade.trail = parted.stroke.trail;
  blade.were = std::move(are);
  blade.owed += cut_->toughness * parted.area;
  const CutMesh& left = resection.left();
  const auto number = [&left](int vertex) { return static_cast<std::size_t>(left.number_of(vertex)); };
  const auto stand_anew = [&](int vertex) {
    rest_[number(vertex)] = mesh_->vertices[static_cast<std::size_t>(vertex)];
  };
  for (const auto& [vertex, towards, share] : parted.stroke.slides) {
    stand_anew(vertex);
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      if (i == tool || !cut_->blades[i] || !cut_->blades[i]->was) continue;
      std::vector<Vec3>& were = cut_->blades[i]->were;
      were[number(vertex)] += share * (were[number(towards)] - were[number(vertex)]);
    }
  }
  for (const Split& split : parted.parting.splits) {
    stand_anew(split.copy);
    for (std::optional<Blade>& each : cut_->blades) {
      if (each && each->was) each->were[number(split.copy)] = each->were[number(split.vertex)];
    }
  }
  if (parted.stroke.slides.empty() && parted.stroke.faces.empty()) return;
  tissue_.model->part(parted.stroke.slides, parted.parting, left);
  tissue_.note_same_place();
  if (!resection.removed().empty()) count_gone(tissue_.model->remove(resection.removed(), left));
}

/// Against its way in this step, so that it does the work that it owes over the next `blade_size` or so.
void Simulation::resist_blade(std::size_t tool, double dt, ToolAnswer& answer) {
  if (!cut_->blades[tool]) return;
  Blade& blade = *cut_->blades[tool];
  const Vec3& p = tools_[tool].place();
  const Vec3 motion = p - blade.place.value_or(p);
  blade.place = p;
  const double far = motion.norm();
  blade.force.setZero();
  if (far > 0)
    blade.force = -blade.owed / (cut_->resection.blade_size() + far) / (far + kAtRest * dt) * motion;
  blade.owed += blade.force.dot(motion);
  answer.force += blade.force;
  answer.mean_force += blade.force;
  if (!tools_[tool].shape().trocar) answer.torque += 0.5 * (blade.is[1] - blade.is[0]).cross(blade.force);
}

bool Simulation::feels_blade(std::size_t tool) const {
  return cut_ && cut_->blades[tool] && !cut_->blades[tool]->force.isZero(0);
}

/// The tools touch the surface of now. Where this throws, the next step begins it again.
void Simulation::change_surface() {
  const CutMesh& left = cut_->resection.left();
  const auto on_surface = [&left](int vertex) { return left.on_surface(vertex); };
  tissue_.drop_loads(on_surface);
  auto touchable = touchable_by(cut_->tools, surface_, *mesh_);
  for (std::size_t i = 0; i < tools_.size(); ++i)
    tools_[i].change_surface(rest_, surface_, std::move(touchable[i]), on_surface);
  cut_->touchable_version = cut_->resection.version();
}

/// What a step with tools that cut came to.
void Simulation::note_cut(std::span<const ToolInput> inputs, double dt) {
  bool touched = false;
  for (std::size_t i = 0; i < tools_.size(); ++i)
    touched = touched || (!cut_->tools[i].blade && is_hot(cut_->tools[i], tools_[i], inputs[i]) &&
                          tools_[i].force().contacts > 0);
  ResectionTotals& totals = cut_->resection.totals();
  if (touched) totals.contact_time += dt;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    answers_[i].cutting = is_hot(cut_->tools[i], tools_[i], inputs[i]);
    if (!answers_[i].cutting) continue;
    Vec3 felt = tools_[i].force().force;
    if (cut_->blades[i]) felt += cut_->blades[i]->force;
    if (!cut_->logs) cut_->log.clear();
    cut_->log.push_back({time_, i, tools_[i].place(), felt, tools_[i].force().contacts > 0, totals});
  }
}

}  // namespace palpate::sim
