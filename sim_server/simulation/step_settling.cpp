// How several tools come to rest on one tissue, and leave it: parts of Simulation.
#include <algorithm>
#include <utility>

#include "sim_server/simulation/simulation.h"

namespace palpate::sim {
namespace {

constexpr double kNear = 2;          // of the tool radius: where the surface is looked at for motion
constexpr double kUnsettled = 1e-3;  // of the tool radius: by how much others push the surface, as one turn
constexpr std::size_t kMaxSweeps = 100;  // over all tools, until they are in equilibrium

}  // namespace

/// Block Gauss-Seidel over the tools (for a linear tissue: on the complementarity problem of all contacts
/// together, which is convex): each in turn solves its own contact on the surface that the others have
/// pushed, until it stands still for all of them.
void Simulation::settle() {
  std::size_t unchanged = 1;  // tools in a row that need nothing; the last one has just been solved
  for (std::size_t turn = 0; unchanged < tools_.size(); ++turn) {
    const std::size_t i = turn % tools_.size();
    ToolContact& tool = tools_[i];
    ++unchanged;
    if (!tool.placed()) continue;
    const ToolTissue tissue = tissue_.touched_by(i);
    if (!tissue.moved()) continue;
    if (tool.exhausted() || turn >= kMaxSweeps * tools_.size()) {
      status_.tools_settled = false;
      flag_contacts();
      return;
    }
    tool.settle(tissue);
    unchanged = 1;
  }
}

void Simulation::flag_contacts() noexcept {
  for (ToolContact& tool : tools_) {
    if (tool.force().contacts > 0) tool.flag();
  }
}

/// Several tools that found no equilibrium, and still push the surface from under each other: what they press
/// with by now may be anything, and the next step would begin with that. They stay where they were, with what
/// they felt there.
void Simulation::restore_touching() {
  const auto touches = [](const ToolContact& tool) { return tool.force().contacts > 0; };
  const auto pushed_on = [&](std::size_t i) {
    const Vec3& p = tools_[i].place();
    return tissue_.touched_by(i).surface_motion(p, p, kNear * tools_[i].radius()) >
           kUnsettled * tools_[i].radius();
  };
  bool pushed = false;
  for (std::size_t i = 0; i < tools_.size(); ++i) pushed = (touches(tools_[i]) && pushed_on(i)) || pushed;
  if (!pushed || std::ranges::count_if(tools_, touches) < 2) return;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const bool touched = touches(tools_[i]);
    tools_[i].restore(tissue_.touched_by(i));
    if (touched || touches(tools_[i])) tools_[i].flag();
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) tissue_.touched_by(i).mark_solved();  // with all loads back
}

/// Whether contact is to be looked for everywhere: what is longer than a ball may touch anywhere along
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
  constexpr double kAround = 4, kAroundHeld = kNear;
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
