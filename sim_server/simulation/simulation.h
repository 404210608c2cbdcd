#pragma once
#include <cstdint>
#include <optional>

#include "sim_server/contact/tool_contact.h"
#include "sim_server/deformation/model_inputs.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

inline const Progress kSilent = [](std::string_view, double) {};

/// Surface vertices that any of the tools can touch, ascending: the corners of the triangles whose box meets
/// `reach`.
std::vector<int> reachable_vertices(const Surface& surface, const TetMesh& mesh,
                                    std::span<const ToolSettings> tools);

/// The organ of a scene with its tools: one step, one page. Built from a scene (throws `Error`), then stepped
/// by one thread; a step neither allocates, locks, logs nor throws, and depends on nothing but its arguments
/// and the state.
class Simulation {
 public:
  /// With the mesh file that the scene names.
  explicit Simulation(const Scene& scene, const Progress& progress = kSilent);
  /// With a mesh made elsewhere.
  Simulation(const Scene& scene, TetMesh mesh, const Progress& progress = kSilent);

  /// Advances the tissue by `dt` (s >= 0; the run begins at time 0) with the tools at `places_W`, one for
  /// each tool; where there is none, that tool is lifted. The forces, one for each tool, stay valid until the
  /// next step.
  std::span<const ToolForce> step(std::span<const std::optional<ToolPose>> places_W, double dt) noexcept;
  /// The same with tool 0 alone, the others lifted.
  ToolForce step(const ToolPose& pose, double dt) noexcept;

  /// What of its device's buttons is pressed, from the next step on: some tools grasp by it.
  void press_buttons(std::size_t tool, std::uint16_t buttons) noexcept {
    tools_[tool].press_buttons(buttons);
  }

  /// Whether the next steps tell the tangent of that tool's force; at first they do.
  void want_tangent(std::size_t tool, bool wanted) noexcept { tangents_wanted_[tool] = wanted; }

  /// How that tool's way bends in the next step.
  void bend_way(std::size_t tool, const Bend& way) noexcept { tools_[tool].bend(way); }

  /// The force on a tool at `p_W` (m), near where it stands, to first order; without effect on anything.
  struct Linearised {
    Vec3 force = Vec3::Zero();    ///< N
    Mat3 tangent = Mat3::Zero();  ///< N/m; free of contact: what it will be when it touches
    SurfacePlane plane;           ///< of contact, or the nearest; no normal: none within twice the radius
  };
  /// `felt`: what `step` gave for that place, with its tangent; null: to be found out. At most two contact
  /// solves.
  Linearised linearise(std::size_t tool, const Vec3& p_W, const ToolForce* felt) noexcept;

  /// How fast the organ's surface moves by itself where that tool touches it at `p_W` (m), or else nearest to
  /// there: m/s, world; zero where all supports rest.
  Vec3 surface_velocity(std::size_t tool, const Vec3& p_W) const noexcept;

  /// How far the surface nearest to a tool at `p_W` (m) is from its place at rest, free of that tool but
  /// under all others, m. O(vertices).
  Vec3 surface_shift(std::size_t tool, const Vec3& p_W) noexcept;

  /// Takes a tool away: the tissue goes free of it.
  void lift_tool(std::size_t tool = 0) noexcept;

  std::size_t tools() const { return tools_.size(); }
  const ToolContact& tool(std::size_t i) const { return tools_[i]; }
  /// Triangles that a tool can touch; corners: surface vertices.
  std::span<const Triangle> touchable(std::size_t tool) const { return tools_[tool].touchable(); }
  const DeformationModel& model() const { return *tissue_.model; }
  /// Surface vertices at rest, m, world.
  const std::vector<Vec3>& rest() const { return rest_; }
  const TetMesh& mesh() const { return mesh_; }
  const Surface& surface() const { return surface_; }
  std::span<const Vec3> positions() const { return tissue_.positions; }
  std::vector<MemoryPart> memory() const;

  /// FNV-1a hash of the surface positions and the last forces, bit by bit: equal runs have equal hashes.
  std::uint64_t state_hash() const noexcept;

 private:
  void move_organ(double dt) noexcept;
  void take(const FreeMotion& motion) noexcept;
  void settle() noexcept;
  void flag_contacts() noexcept;
  bool ran_away() const noexcept;

  TetMesh mesh_;
  Surface surface_;
  std::vector<Vec3> rest_;
  double farthest_ = 1e150;  // from there, m; so far: no bound but that of numbers
  Tissue tissue_;
  std::vector<ToolContact> tools_;
  std::vector<Vec3> ways_;                       // of the surface at each tool in this step, m
  std::vector<std::optional<ToolPose>> places_;  // for the step of tool 0 alone
  std::vector<ToolForce> forces_;
  std::vector<std::uint8_t> tangents_wanted_;
};

/// "contact", or "contact of tool 2" where there are several: the name of a tool's part in reports, and,
/// after "preparing ", of the stage of set-up that makes it.
std::string contact_part(std::size_t tool, std::size_t tools);

}  // namespace palpate::sim
