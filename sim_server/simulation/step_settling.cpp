// How several tools come to rest on one tissue, and leave it: parts of Simulation.
#include <algorithm>
#include <utility>

#include "sim_server/simulation/simulation.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kMaxSweeps =
    100;  // over tools that grasp, until they are in equilibrium with the others

}  // namespace

/// Takes the tools to these poses. One by itself; several together, as all their contacts are one problem
/// (`JointContact`), with which tools that grasp come to rest in turns.
void Simulation::advance_tools(std::span<const std::optional<PathPoint>> to) {
  if (!joint_) {
    if (to[0]) tools_[0].advance_to(to[0]->pose, to[0]->bend, tissue_.touched_by(0));
    return;
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (!to[i]) continue;
    if (tools_[i].opens()) tools_[i].open_grip(tissue_.touched_by(i));
    if (tools_[i].holds()) tools_[i].advance_to(to[i]->pose, to[i]->bend, tissue_.touched_by(i));
  }
  bool converged = joint_->advance(tools_, to, tissue_);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (to[i] && tools_[i].closes()) tools_[i].close_grip(tissue_.touched_by(i));
  }
  settle_grasps(converged);
}

/// Contact of all tools where they are, on the tissue as it is free by now.
void Simulation::settle() {
  if (joint_) return settle_grasps(joint_->settle(tools_, tissue_));
  if (tools_[0].placed()) tools_[0].settle(tissue_.touched_by(0));
}

/// Brings what tools hold in their jaws, all of it at once, to rest with what they touch, in turns.
void Simulation::settle_grasps(bool converged) {
  const auto holds = [](const ToolContact& tool) { return tool.placed() && tool.holds(); };
  bool moved = std::ranges::any_of(tools_, holds);
  for (std::size_t sweep = 0; converged && moved && sweep < kMaxSweeps; ++sweep) {
    moved = false;
    grips_->settle(tools_, tissue_);
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      if (!holds(tools_[i])) continue;
      const ToolTissue tissue = tissue_.touched_by(i);
      if (!tissue.moved()) continue;
      tools_[i].settle(tissue);
      moved = true;
    }
    if (moved) converged = joint_->settle(tools_, tissue_);
  }
  if (converged && !moved) return;
  status_.tools_settled = false;
  flag_contacts();
}

void Simulation::flag_contacts() noexcept {
  for (ToolContact& tool : tools_) {
    if (tool.force().contacts > 0) tool.flag();
  }
}

/// Tools that found no equilibrium on the same tissue, as there is no place left for it between them, say:
/// what they press with by now may be anything, and the next step would begin with that. They stay where they
/// were, with the forces they had there.
void Simulation::restore_touching() {
  const auto touches = [](const ToolContact& tool) { return tool.force().contacts > 0; };
  if (std::ranges::count_if(tools_, touches) < 2) return;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const bool touched = touches(tools_[i]);
    tools_[i].restore(tissue_.touched_by(i));
    if (touched || touches(tools_[i])) tools_[i].flag();
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) tissue_.touched_by(i).mark_solved();  // with all loads back
}

/// True if contact is to be looked for everywhere: what is longer than a ball may touch anywhere along
/// itself, what appears is put outside first, wherever that is, and tissue that is let go springs back, as
/// far as it was pulled.
bool Simulation::searches_everywhere(std::size_t tool, const ToolInput& input) const noexcept {
  if (!input.pose) return !tissue_.loads_of(tool).empty();
  const ToolContact& contact = tools_[tool];
  return !contact.shape().is_sphere() || !contact.placed() || !tracks_[tool].from || contact.opens();
}

/// A ball on its way looks around that alone.
void Simulation::restrict_contact(std::span<const ToolInput> inputs) {
  // Tool radii about its way: beyond what it touches, or is taken back to; what it holds is loaded anyway.
  constexpr double kAround = 4, kAroundHeld = 2;
  places_.clear();
  bool everywhere = std::exchange(status_.released, false);
  for (std::size_t i = 0; i < tools_.size(); ++i)
    everywhere = searches_everywhere(i, inputs[i]) || everywhere;
  for (std::size_t i = 0; i < tools_.size() && !everywhere; ++i) {
    if (!inputs[i].pose) continue;
    const Vec3& to = inputs[i].pose->p_W;
    const Vec3 middle = 0.5 * (tracks_[i].from->p_W + to);
    double furthest = (to - middle).norm();
    for (const PathPoint& point : inputs[i].path)
      furthest = std::max(furthest, (point.pose.p_W - middle).norm());
    furthest = std::max(furthest, (tools_[i].place() - middle).norm());
    const double around = tools_[i].holds() ? kAroundHeld : kAround;
    places_.push_back({middle, furthest + around * tools_[i].radius()});
  }
  tissue_.traits.cuttable->restrict_contact(places_, organ_.surface.triangles);
}

/// Takes a tool away: the tissue becomes free of it.
void Simulation::separate_tool(std::size_t tool) noexcept {
  answers_[tool] = {};
  tracks_[tool].from.reset();
  tracks_[tool].recent.clear();
  status_.released = status_.released || !tissue_.loads_of(tool).empty();
  try {
    if (!tissue_.loads_of(tool).empty()) tissue_.touched_by(tool).release();
  } catch (const std::exception&) {
    // Memory ended. Its loads are gone all the same: the next step goes on without them, or tells why not.
  }
  tissue_.separate(tool);
  tools_[tool].separate();
}

}  // namespace palpate::sim
