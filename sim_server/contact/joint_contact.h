#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim_server/contact/tool_contact.h"
#include "sim_server/contact/tool_step.h"

namespace palpate::sim {

/// Contact of several tools with one tissue, as one complementarity problem on the union of the patches of
/// surface near them: the cross compliance between these patches is part of it, so that tissue that gives way
/// as a whole between two tools is solved for as directly as tissue under one. Tools that grasp are no part
/// of it: their loads are held. Only the constructor allocates; what the model throws passes through. One
/// thread.
class JointContact {
 public:
  /// Makes room for what all of `tools` touch at most, of a surface of so many vertices.
  JointContact(std::span<const ToolContact> tools, std::size_t vertices);

  /// Takes all tools with a pose in `to`, but those that hold tissue, there, together in increments as short
  /// as the shortest of any (`ToolContact::advance_to`). Contact of all of them is solved after each. Returns
  /// false where it did not converge.
  bool advance(std::span<ToolContact> tools, std::span<const std::optional<PathPoint>> to, Tissue& tissue);
  /// Solves the last increment of the same tools again, on the tissue as it is free by now.
  bool settle(std::span<ToolContact> tools, Tissue& tissue);
  /// True if the last contact of a tool in this step was solved here, with some of the surface near it.
  bool has_solved(std::size_t tool) const noexcept;
  /// Sets the tangent of a tool, of the last `solve`, with the loads of the others held. Before a tool is
  /// solved for alone.
  void differentiate(std::size_t index, ToolContact& tool, const ToolTissue& tissue) noexcept;
  /// Its solution is of a step before.
  void forget() noexcept { near_.clear(); }

  std::size_t bytes() const { return solver_.bytes() + patch_.compliance.bytes(); }

 private:
  bool go(std::span<ToolContact> tools, Tissue& tissue);
  bool solve(std::span<ToolContact> tools, Tissue& tissue);
  void gather(std::span<ToolContact> tools, Tissue& tissue);
  double lead_slip(std::span<const ToolContact> tools);
  void hold_grasps(std::span<const ToolContact> tools, Tissue& tissue);
  int node_of(int vertex, const ToolContact& tool, const ToolTissue& tissue);
  void take_compliance(const Tissue& tissue);
  bool solve_alone(std::size_t index, std::span<ToolContact> tools, Tissue& tissue);
  int place_of(std::size_t tool) const noexcept;
  void solve_patch(std::span<ToolContact> tools);
  void set_loads(std::span<ToolContact> tools, Tissue& tissue);

  std::array<bool, kMaxTools> goes_{};            // which tools are on their way
  std::array<ContactForce, kMaxTools> forces_{};  // of each tool, in the increment solved last
  std::vector<std::size_t> near_;                 // the tools that are solved for
  std::vector<TouchingTool> touching_;            // these, for the solver
  ContactPatch patch_;
  ContactSolver solver_;
  std::vector<int> vertices_, node_of_vertex_;  // of the patch nodes; -1: it is none of them
  std::vector<Vec3> free_;                      // surface vertices under the loads of grasps, m
  std::vector<Vec3> were_, are_;                // patch nodes when the increment began, and now, m
  std::span<const Vec3> base_;                  // that, or the tissue's own free shape
  std::vector<VertexLoad> loads_;
  std::vector<FeatureForce> forces_before_;  // of all tools, in the increment before
  Eigen::VectorXd displacement_, node_forces_;
};

}  // namespace palpate::sim
