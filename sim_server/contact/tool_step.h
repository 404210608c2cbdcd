#pragma once
#include <optional>
#include <span>
#include <vector>

#include "common/contact/linearisation.h"
#include "common/doubt.h"
#include "sim_server/client_model/slow_modes.h"
#include "sim_server/contact/tool_contact.h"

namespace palpate::sim {

/// Outputs of a step for one tool beyond its force. Nothing is computed that nobody asks for.
struct ToolRequest {
  bool tangent = true;   ///< dF/dp of `ToolForce`
  bool at_tool = false;  ///< the linearisation at the tool's pose; with it goes `tangent`
  /// Linearisation where the tool will be after `seconds` (>= 0) at `v_W` (m/s), relative to the moving
  /// organ, 2 mm away at most.
  struct Ahead {
    double seconds;
    Vec3 v_W;
  };
  std::optional<Ahead> ahead = {};
  bool surface_shift = false;  ///< of a tool that does not grasp
};

/// Pose of a tool at an instant within a step, and the path to it from the instant before.
struct PathPoint {
  ToolPose pose;
  Bend bend = {};  ///< used by friction alone
};

/// Input of one tool in a step.
struct ToolInput {
  std::optional<ToolPose> pose = {};  ///< of its tip now; none: the tool is lifted
  bool enters = false;        ///< it was lifted before: no contact or motion of the step before counts
  std::uint16_t buttons = 0;  ///< of its device, pressed now: some tools grasp or cut by them
  Vec3 v_W = Vec3::Zero();    ///< of its tip, m/s: how fast it pushes the organ under other tools
  Bend bend = {};             ///< of the path from its last point to `pose`; used by friction alone
  /// Poses at the instants within the step before `pose` (`Simulation::instants` - 1), evenly in time.
  /// Of another length, such as empty: the tool went straight and evenly from its pose of the step before.
  std::span<const PathPoint> path = {};
  ToolRequest request = {};
};

/// Outputs of a step for one tool: the force on it, and what was asked beyond that, if its pose was known and
/// the force is not flagged.
struct ToolAnswer : ToolForce {
  Doubt doubt = Doubt::kContact;   ///< of a flagged force: why
  bool strained = false;           ///< the tissue under it, beyond what its law is meant for (`StrainRange`)
  Vec3 mean_force = Vec3::Zero();  ///< N, over the step; equal to `force` where contact is solved once
  /// Velocity of the organ's surface by its supports where the tool touches, or else nearest to it, m/s,
  /// world. Set with `at_tool` and `ahead`; zero where all supports rest.
  Vec3 surface_v_W = Vec3::Zero();
  /// Motion of that surface by the other tools. Set with `at_tool` and `ahead`, of several tools.
  std::optional<OtherTools> others = {};
  std::optional<Linearisation> at_tool = {}, ahead = {};
  /// Displacement of the surface nearest to the tool from rest, free of that tool but under all others, m;
  /// with `modes`, only that by its supports and by the part of the other tools' loads that no published mode
  /// carries. O(vertices).
  std::optional<Vec3> surface_shift_W = {};
  /// The published modes at the end of the step; null without `surface_shift_W`, or where there are none.
  const ModalMotion* modes = nullptr;
  /// Loads, with `modes`, of the other tools on each mode, N/sqrt(kg); null: there are none.
  const Eigen::VectorXd* modal_loads = nullptr;
  bool cutting = false;  ///< its tip is hot, or its blade cuts: tissue that it touches may yield at any time
};

}  // namespace palpate::sim
