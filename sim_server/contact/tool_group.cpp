#include "sim_server/contact/tool_group.h"

#include <algorithm>
#include <utility>

namespace palpate::sim {
namespace {

// Sweeps over what tools hold in their jaws and what they touch, until both are in equilibrium.
constexpr std::size_t kMaxSweeps = 100;
// Tool radii about its way: beyond what it touches, or is taken back to; what it holds is loaded anyway.
constexpr double kAround = 4, kAroundHeld = 2;

bool has_tissue(const ToolContact& tool) {
  return tool.placed() && tool.holds();
}

bool touches(const ToolContact& tool) {
  return tool.force().contacts > 0;
}

/// A sphere around the way of a tool, and what it may touch from there.
Neighbourhood around_way(const ToolContact& tool, const ToolInput& input, const ToolPose& from) {
  const Vec3& to = input.pose->p_W;
  const Vec3 middle = 0.5 * (from.p_W + to);
  double furthest = std::max((to - middle).norm(), (tool.place() - middle).norm());
  for (const PathPoint& point : input.path) furthest = std::max(furthest, (point.pose.p_W - middle).norm());
  return {middle, furthest + (tool.holds() ? kAroundHeld : kAround) * tool.radius()};
}

bool searches_everywhere(const ToolContact& tool, const ToolInput& input, const InstantPath& path,
                         bool loads) {
  if (!input.pose) return loads;
  return !tool.shape().is_sphere() || !tool.placed() || !path.from() || tool.opens();
}

}  // namespace

ToolGroup::ToolGroup(std::vector<ToolContact> tools, std::size_t vertices) : tools_(std::move(tools)) {
  if (tools_.size() > 1) {
    joint_.emplace(tools_, vertices);
    grips_.emplace(tools_);
  }
  places_.reserve(tools_.size());
}

void ToolGroup::start_step(std::span<const ToolInput> inputs) noexcept {
  if (joint_) joint_->forget();
  for (std::size_t i = 0; i < tools_.size(); ++i) tools_[i].set_buttons(inputs[i].buttons);
}

void ToolGroup::restrict_contact(std::span<const ToolInput> inputs, std::span<const InstantPath> paths,
                                 std::span<const Triangle> surface, const Tissue& tissue) {
  places_.clear();
  bool everywhere = std::exchange(released_, false);
  for (std::size_t i = 0; i < tools_.size(); ++i)
    everywhere =
        searches_everywhere(tools_[i], inputs[i], paths[i], !tissue.loads_of(i).empty()) || everywhere;
  for (std::size_t i = 0; i < tools_.size() && !everywhere; ++i) {
    if (inputs[i].pose) places_.push_back(around_way(tools_[i], inputs[i], *paths[i].from()));
  }
  tissue.traits.cuttable->restrict_contact(places_, surface);
}

void ToolGroup::carry(std::span<const Vec3> motions, Tissue& tissue) {
  bool pressed = false;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tools_[i].carry(motions[i]);
    tissue.carry(i, motions[i]);
    if (!tools_[i].placed()) continue;
    tissue.apply_loads(i);
    pressed = true;
  }
  if (!pressed) tissue.press_by_none();
}

void ToolGroup::advance(std::span<const std::optional<PathPoint>> to, Tissue& tissue) {
  for (std::size_t i = 0; i < tools_.size() && joint_; ++i) tools_[i].keep(tissue.loads_of(i));
  settled_ = move(to, tissue);
  solve_contacts(tissue);
  if (!settled_) restore_touching(tissue);
}

/// Takes the tools to these poses. Returns false where several find no common equilibrium there.
bool ToolGroup::move(std::span<const std::optional<PathPoint>> to, Tissue& tissue) {
  if (!joint_) {
    if (to[0]) tools_[0].advance_to(to[0]->pose, to[0]->bend, tissue.touched_by(0));
    return true;
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (!to[i]) continue;
    if (tools_[i].opens()) tools_[i].open_grip(tissue.touched_by(i));
    if (tools_[i].holds()) tools_[i].advance_to(to[i]->pose, to[i]->bend, tissue.touched_by(i));
  }
  const bool converged = joint_->advance(tools_, to, tissue);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (to[i] && tools_[i].closes()) tools_[i].close_grip(tissue.touched_by(i));
  }
  return settle_grasps(converged, tissue);
}

/// Solves contact of all tools where they are, on the tissue as it is free by now.
bool ToolGroup::settle(Tissue& tissue) {
  if (joint_) return settle_grasps(joint_->settle(tools_, tissue), tissue);
  if (tools_[0].placed()) tools_[0].settle(tissue.touched_by(0));
  return true;
}

/// Brings what tools hold in their jaws, all of it at once, to rest with what they touch, in turns.
bool ToolGroup::settle_grasps(bool converged, Tissue& tissue) {
  bool moved = std::ranges::any_of(tools_, has_tissue);
  for (std::size_t sweep = 0; converged && moved && sweep < kMaxSweeps; ++sweep) {
    moved = false;
    grips_->settle(tools_, tissue);
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      if (!has_tissue(tools_[i])) continue;
      const ToolTissue mine = tissue.touched_by(i);
      if (!mine.moved()) continue;
      tools_[i].settle(mine);
      moved = true;
    }
    if (moved) converged = joint_->settle(tools_, tissue);
  }
  if (converged && !moved) return true;
  flag_contacts();
  return false;
}

/// Solves contact again where a linearisation about where it led says something else. Where no more contact
/// is to be found in this step, the body is still brought to balance with the last.
void ToolGroup::solve_contacts(Tissue& tissue) {
  NonlinearModel* const nonlinear = tissue.traits.nonlinear;
  if (nonlinear == nullptr) return;
  bool found = true;
  while (const auto motion = nonlinear->relinearise()) {
    tissue.set_free(*motion);
    found = found && std::ranges::none_of(tools_, &ToolContact::exhausted);
    if (found) settled_ = settle(tissue) && settled_;
  }
  if (!found || nonlinear->balance() != NonlinearModel::Balance::kBalanced) flag_contacts();
}

/// Tools that found no equilibrium on the same tissue, as there is no place left for it between them, say:
/// what they press with by now may be anything, and the next step would begin with that. They stay where they
/// were, with the forces they had there.
void ToolGroup::restore_touching(Tissue& tissue) {
  if (std::ranges::count_if(tools_, touches) < 2) return;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const bool touched = touches(tools_[i]);
    tools_[i].restore(tissue.touched_by(i));
    if (touched || touches(tools_[i])) tools_[i].flag();
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) tissue.touched_by(i).mark_solved();  // with all loads back
}

void ToolGroup::flag_contacts() noexcept {
  for (ToolContact& tool : tools_) {
    if (touches(tool)) tool.flag();
  }
}

void ToolGroup::differentiate(std::size_t tool, Tissue& tissue) {
  if (joint_ && joint_->has_solved(tool))
    return joint_->differentiate(tool, tools_[tool], tissue.known_to(tool));
  tools_[tool].differentiate(tissue.touched_by(tool));
}

void ToolGroup::release(std::size_t tool, Tissue& tissue) noexcept {
  released_ = released_ || !tissue.loads_of(tool).empty();
  try {
    if (!tissue.loads_of(tool).empty()) tissue.touched_by(tool).release();
  } catch (const std::exception&) {
    // Memory ended. Its loads are gone all the same: the next step goes on without them, or tells why not.
  }
  tissue.separate(tool);
  tools_[tool].separate();
}

bool ToolGroup::have_friction() const {
  return std::ranges::any_of(tools_, &ToolContact::has_friction);
}

void ToolGroup::restore(const State& state) {
  for (std::size_t i = 0; i < tools_.size(); ++i) tools_[i].restore_from(state.tools[i]);
  released_ = state.released;
  if (joint_) joint_->forget();
}

}  // namespace palpate::sim
