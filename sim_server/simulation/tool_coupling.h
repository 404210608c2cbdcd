#pragma once
#include <span>
#include <vector>

#include "common/contact/tool.h"
#include "sim_server/contact/tool_step.h"

namespace palpate::sim {

/// Motion of the surface under each tool that the other tools on one organ cause. Tool k, at velocity v_k,
/// with the surface under it going by w_k, presses the tissue with a force that changes at r_k = -K_k (v_k -
/// w_k), K_k its tangent with the loads of the others held; it is spread over the vertices it loads as its
/// force is (Saint-Venant: farther away only the sum matters). G_ik is how far that carries the surface under
/// tool i. With o all tools but i,
///   w_i = G_io r_o,   r_o = -K_o (v_o - G_oo r_o - G_oi r_i),
/// so that w_i = u_i + M_i r_i. The tangent with the places of the others held, not their loads, is
/// K_i (I - M_i K_i)^-1. Exact where each grasps one vertex of linear tissue. Tools so close that this has no
/// meaning (|M_i K_i| above 0.9) are published as if alone. Only set-up allocates. One thread.
class ToolCoupling {
 public:
  /// Makes room for so many tools, vertices of the surface, and loads of all tools at most.
  ToolCoupling(std::size_t tools, std::size_t vertices, std::size_t most_loads);

  /// After a step, with the velocities of the tips (m/s, world). The tangents are there. Three `apply` of the
  /// model for each tool that presses, and two.
  void update(Tissue& tissue, std::span<const ToolContact> tools, std::span<const Vec3> velocities);

  /// True if others move the surface under the tool; else u_i and M_i are 0.
  bool moved_by_others(std::size_t tool) const noexcept {
    return !others_[tool].compliance.isZero(0) || !others_[tool].v_W.isZero(0);
  }
  /// u_i and M_i.
  const OtherTools& others(std::size_t tool) const noexcept { return others_[tool]; }
  /// (I - M_i K_i)^-1: how far tool i goes relative to the surface under it, for each m that it goes.
  const Mat3& relative_motion(std::size_t tool) const noexcept { return relative_[tool]; }
  std::size_t bytes() const {
    return (surface_.capacity() + moved_.capacity()) * sizeof(Vec3) + loads_.capacity() * sizeof(VertexLoad);
  }

 private:
  static constexpr int kMost = 3 * static_cast<int>(kMaxTools);  // axes of all tools
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  void find_compliance(Tissue& tissue, std::span<const ToolContact> tools);
  void load(const Tissue& tissue, std::size_t tools, std::size_t pressed, const Vec3& force);
  OtherTools others_of(std::size_t tool, std::span<const ToolContact> tools,
                       std::span<const Vec3> velocities) const;

  std::vector<VertexLoad> loads_;
  std::vector<Vec3> surface_, moved_;  // vertices: where they are, m; how far one force carries them, m/N
  Matrix compliance_;                  // G (3n x 3n), zero on the diagonal
  std::vector<OtherTools> others_;
  std::vector<Mat3> relative_;
};

}  // namespace palpate::sim
