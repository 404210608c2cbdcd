#pragma once
#include <optional>
#include <span>
#include <vector>

#include "sim_server/contact/instant_path.h"
#include "sim_server/contact/joint_contact.h"
#include "sim_server/contact/joint_grip.h"

namespace palpate::sim {

/// All tools on one tissue. One tool is solved for by itself; the contacts of several are one problem
/// (`JointContact`), with which what they hold in their jaws (`JointGrip`) comes to rest in turns. Only the
/// constructor allocates; what the model throws passes through. One thread.
class ToolGroup {
 public:
  /// State that a step changes, as a value.
  struct State {
    std::vector<ToolContact> tools;
    bool released;
  };

  ToolGroup() = default;
  /// Takes the tools, on a surface of so many vertices.
  ToolGroup(std::vector<ToolContact> tools, std::size_t vertices);

  std::span<ToolContact> all() { return tools_; }
  std::span<const ToolContact> all() const { return tools_; }
  std::size_t size() const { return tools_.size(); }
  ToolContact& operator[](std::size_t i) { return tools_[i]; }
  const ToolContact& operator[](std::size_t i) const { return tools_[i]; }

  /// Starts a step with these inputs.
  void start_step(std::span<const ToolInput> inputs) noexcept;
  /// Has the model of tissue that can be cut look for contact only around the way of each tool, where that is
  /// a ball on its way; else everywhere: what is longer may touch anywhere along itself, what appears is put
  /// outside first, wherever that is, and tissue that is let go springs back, as far as it was pulled.
  void restrict_contact(std::span<const ToolInput> inputs, std::span<const InstantPath> paths,
                        std::span<const Triangle> surface, const Tissue& tissue);
  /// Carries each tool by the motion (m) of the surface under it, with its loads on the tissue.
  void carry(std::span<const Vec3> motions, Tissue& tissue);
  /// Takes the tools with a pose in `to` there, and brings tissue and tools to balance. Tools that find no
  /// common equilibrium stay where they were, flagged.
  void advance(std::span<const std::optional<PathPoint>> to, Tissue& tissue);
  /// Adds the tangent to the force of a tool.
  void differentiate(std::size_t tool, Tissue& tissue);
  /// Takes a tool away: the tissue becomes free of it.
  void release(std::size_t tool, Tissue& tissue) noexcept;
  /// True unless several tools found no common equilibrium in the last `advance`.
  bool settled() const { return settled_; }
  bool have_friction() const;

  State save() const { return {tools_, released_}; }
  void restore(const State& state);

 private:
  bool move(std::span<const std::optional<PathPoint>> to, Tissue& tissue);
  bool settle(Tissue& tissue);
  bool settle_grasps(bool converged, Tissue& tissue);
  void solve_contacts(Tissue& tissue);
  void restore_touching(Tissue& tissue);
  void flag_contacts() noexcept;

  std::vector<ToolContact> tools_;
  std::optional<JointContact> joint_;  // of several tools
  std::optional<JointGrip> grips_;     // of several tools
  std::vector<Neighbourhood> places_;  // around the paths of the tools in this step
  bool released_ = false;              // some tissue was, since the last step
  bool settled_ = true;
};

}  // namespace palpate::sim
