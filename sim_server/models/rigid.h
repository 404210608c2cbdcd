#pragma once
#include <array>
#include <string>
#include <string_view>

#include "common/config.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/estimated_memory.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

struct RigidSettings {
  double stiffness = 800;  ///< of a contact, N/m, [1e-3, 1e6]

  static constexpr bool kOfBody = true;
  static constexpr std::array<std::string_view, 1> kKeys{"stiffness"};
  static RigidSettings read(const Config& config);
  std::string to_text() const;
};

/// No deformation: the empirical penetration force, F = k (depth) (named by Picinbono and Lombardo 1999 as
/// [3]). The compliance 1/k sits between the tool position and a tip that stays on the surface (the
/// god-object of Zilles and Salisbury 1995), so several contacts share it and the force stays continuous over
/// edges.
class Rigid final : public DeformationModel {
 public:
  explicit Rigid(const ModelInputs& inputs);
  /// Returns 0: it has no elements.
  static double estimated_bytes(const Scene&, const MeshCounts&) { return 0; }
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) noexcept override;
  ModelTraits traits() noexcept override { return {.constant_compliance = true}; }
  std::vector<MemoryPart> memory() const override;

 private:
  std::vector<Vec3> rest_;
  double stiffness_;  // N/m
};

}  // namespace palpate::sim
