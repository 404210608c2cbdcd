#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/config.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/estimated_memory.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

struct SpringSettings {
  std::optional<Vec3> stiffness{};           ///< `spring_stiffness`: along x, y, z, N/m, [1e-3, 1e6]
  std::optional<double> hardening_length{};  ///< m, [1e-4, 10]; absent: linear

  static constexpr bool kOfBody = true;
  static constexpr std::array<std::string_view, 2> kKeys{"spring_stiffness", "hardening_length"};
  static SpringSettings read(const Config& config);
  std::string to_text() const;
};

/// No deformation: the organ hangs as one piece on a spring that is stiffer along some axes and hardens with
/// the stretch s; it does not turn. With K diagonal, k its mean, d the hardening length,
///   F = g K x,   g = 1 + s^2 / d^2,   s^2 = x . K x / k,
/// the gradient of k (s^2 / 2 + s^4 / (4 d^2)): conservative, with the tangent T = g K + 2 / (k d^2) K x (K
/// x)^T. Backwards, g is the root of g^3 - g^2 = F . K^-1 F / (k d^2). Where a tool grasps it, it stands for
/// an organ whose force changes over a known length: no mesh, no contact set. Vertices of a [[fixed]] stay,
/// but for what gives way under a tool itself (`held_stiffness`).
class Spring final : public DeformationModel, public StatefulModel {
 public:
  /// Throws `Error` without a `spring_stiffness`.
  explicit Spring(const ModelInputs& inputs);
  /// Returns 0: it has no elements.
  static double estimated_bytes(const Scene&, const MeshCounts&) { return 0; }
  FreeMotion free_motion(double dt) noexcept override;
  /// T^-1 for every pair of free vertices, under the loads of now.
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) noexcept override;
  ModelTraits traits() noexcept override {
    return {.constant_compliance = per_length2_ == 0, .turns = false, .state = this};
  }
  std::vector<MemoryPart> memory() const override;
  std::any save() override { return state_; }
  FreeMotion restore(const std::any& state) override;

 private:
  double stretch_ratio() const noexcept;  // s^2 / d^2

  struct State {
    std::vector<Vec3> positions;  // m
    Vec3 moved = Vec3::Zero();    // x, m
  };
  std::vector<Vec3> rest_;
  std::vector<char> held_;  // per surface vertex: whether it is fixed
  double held_compliance_;  // m/N, of a fixed vertex under the tool itself
  Vec3 stiffness_;          // K, N/m
  double per_length2_ = 0;  // 1 / d^2, 1/m^2; 0: linear
  State state_;
};

}  // namespace palpate::sim
