#pragma once
#include <optional>
#include <span>
#include <vector>

#include "sim_server/contact/tool_group.h"
#include "sim_server/cutting/tissue_cut.h"
#include "sim_server/simulation/tool_coupling.h"

namespace palpate::sim {

/// The organ at the end of a step, with its tools.
struct OrganAfterStep {
  Tissue& tissue;
  ToolGroup& tools;
  std::span<const Vec3> rest;  ///< surface vertices, m
  const TissueCut* cut;        ///< null: the organ cannot be cut
};

/// Outputs of a step beyond the forces, for clients that request them: linearisations of the force, the
/// motion of the surface by other tools, its shift, the published modes. A value: all that a step changes of
/// it continues byte for byte in a copy. Only `reserve` allocates; what the model throws passes through. One
/// thread.
class StepPublisher {
 public:
  StepPublisher() = default;
  /// Makes room for so many tools, with so many loads in all.
  StepPublisher(std::size_t tools, std::size_t vertices, std::size_t most_loads);
  /// Makes room for these modes; null: none are published.
  void reserve(const PublishedModes* modes, std::size_t vertices);

  /// Finds how the tools move the surface under each other, if any client requests it. Once a step, before
  /// `add_wanted`.
  void couple(std::span<const ToolInput> inputs, OrganAfterStep organ);
  /// Adds what was requested of a tool beyond its force. `modes`: those published; null: none.
  void add_wanted(std::size_t tool, const ToolInput& input, const PublishedModes* modes, bool once_a_step,
                  OrganAfterStep organ, ToolAnswer& answer);
  /// Returns the force on a tool near `p_W` (m), as `Simulation::linearise` says.
  static Linearisation linearise(std::size_t tool, const Vec3& p_W, const ToolForce* known,
                                 OrganAfterStep organ);
  std::size_t bytes() const { return coupling_ ? coupling_->bytes() : 0; }

 private:
  Linearisation linearise_coupled(std::size_t tool, const Vec3& p_W, const Vec3& there,
                                  const ToolForce* known, OrganAfterStep organ) const;
  void add_linearisations(std::size_t tool, const ToolInput& input, bool once_a_step, OrganAfterStep organ,
                          ToolAnswer& answer) const;
  void publish_modes(std::size_t tool, const PublishedModes& modes, OrganAfterStep organ, ToolAnswer& answer);
  Vec3 surface_shift(std::size_t tool, const Vec3& p_W, const PublishedModes* modes, OrganAfterStep organ);
  Vec3 residual_shift(std::size_t tool, int vertex, OrganAfterStep organ);

  std::optional<ToolCoupling> coupling_;    // of several tools
  bool coupled_ = false;                    // in this step
  ModalMotion modes_;                       // at the end of the step
  std::vector<Eigen::VectorXd> by_others_;  // of each tool: loads of the others on the published modes
  ContactPatch pair_;                       // of two vertices: how one moves the other
};

}  // namespace palpate::sim
