#pragma once
#include <cstdint>
#include <memory>

#include "sim_server/contact/contact_finder.h"
#include "sim_server/deformation/deformation_models.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/scene.h"

namespace palpate::sim {

/// What the tool feels after one step.
struct ToolForce {
  Vec3 force = Vec3::Zero();    ///< N, world, on the tool at its position
  Mat3 tangent = Mat3::Zero();  ///< dF/dp, N/m, symmetric
  int contacts = 0;             ///< touching faces, edges and vertices
  int iterations = 0;           ///< contact linearisations, all sub-places together
  /// No settled answer: a wild position (then there is no force), contact that did not converge, or a way too
  /// long for one step (then the force belongs to the place the tool got to).
  bool flagged = false;
};

inline const Progress kSilent = [](std::string_view, double) {};

/// Surface vertices that the tool can touch, ascending: the corners of the triangles whose box meets `reach`.
std::vector<int> reachable_vertices(const Surface& surface, const TetMesh& mesh, const ToolSettings& tool);

/// The organ of a scene with its tool: one step, one page. Built from a scene (throws `Error`), then stepped
/// by one thread; a step neither allocates, locks, logs nor throws, and depends on nothing but its arguments
/// and the state.
class Simulation {
 public:
  /// With the mesh file that the scene names.
  explicit Simulation(const Scene& scene, const Progress& progress = kSilent);
  /// With a mesh made elsewhere.
  Simulation(const Scene& scene, TetMesh mesh, const Progress& progress = kSilent);

  /// Advances the tissue by `dt` (s) with the tool centre at `p_W` (m). The tool goes there on a straight
  /// line in strides of half its radius, so a fast tool does not jump through the surface.
  ToolForce step(const Vec3& p_W, double dt) noexcept;

  /// Takes the tool away: the tissue goes free.
  void lift_tool() noexcept;

  const TetMesh& mesh() const { return mesh_; }
  const Surface& surface() const { return surface_; }
  std::span<const Vec3> positions() const { return positions_; }
  std::vector<MemoryPart> memory() const;

  /// FNV-1a hash of the surface positions and the last force, bit by bit: equal runs have equal hashes.
  std::uint64_t state_hash() const noexcept;

 private:
  ToolForce give_up() noexcept;
  bool escaped(const Vec3& p_W) const noexcept;
  void enter(const Vec3& p_W) noexcept;
  ContactForce touch(const Vec3& p_W) noexcept;
  void release() noexcept;

  SphereTool tool_;
  TetMesh mesh_;
  Surface surface_;
  std::unique_ptr<DeformationModel> model_;
  std::unique_ptr<ContactFinder> finder_;
  std::unique_ptr<ContactSolver> solver_;
  ContactPatch patch_;
  std::span<const Vec3> free_, positions_;
  Eigen::VectorXd displacement_;  // of the patch nodes, then of the tip
  std::vector<NodalLoad> loads_;
  Vec3 place_ = Vec3::Zero();       // tool centre of the last step
  Vec3 tip_offset_ = Vec3::Zero();  // tip minus tool centre
  bool placed_ = false;
  ToolForce last_;
};

}  // namespace palpate::sim
