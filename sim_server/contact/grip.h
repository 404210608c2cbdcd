#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "sim_server/contact/surface_change.h"
#include "sim_server/contact/tissue.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Tissue in the jaws of a tool: vertices of the surface attached to it both ways, each at the offset from
/// the tool centre that it had when the jaws closed, which turns with the tool. With C the model's compliance
/// at these m vertices, c_t the tool's, and E = (I ... I)^T, the loads f on the tissue hold
///   free + C f = E p + offsets - c_t E E^T f
/// and the tool feels F = -J^T f, with the tangent dF/dp = -J^T (C + c_t E E^T)^-1 J, where J dp is how the
/// offsets go where the tool goes by dp. A tool whose orientation the device sets has J = E, and feels the
/// torque -sum of offset x f about its centre. A shaft that pivots turns with its tip: by the least turn of
/// its axis since the jaws closed, as the device does not say how it rolls. What turns the tissue then acts
/// at the tip as the force that does the same work (the tangent leaves out how J changes, which is of order f
/// r / L^2, with r the radius of the jaws and L from tip to pivot). Newton's method: one round where the
/// tissue is linear. Only set-up allocates; what the model throws passes through. One thread.
class Grip {
 public:
  static constexpr double kFits = 1e-10;  ///< of its reach: largest error of a held vertex
  static constexpr int kMaxRounds = 30;   ///< of Newton's method

  /// `rest`: surface vertices, m. At most `max_nodes`, and 128, are held. Throws `Error` where there is
  /// nothing at `grasp_place`.
  Grip(const ToolSettings& tool, std::span<const Vec3> rest, std::span<const std::array<int, 3>> touchable,
       int max_nodes);

  /// Holds the copies of held vertices, too, as far as there is room, and lets go of vertices that left the
  /// surface. Allocates.
  void change_surface(const SurfaceChange& change, std::span<const std::array<int, 3>> touchable);

  /// Sets which of the device's buttons are pressed.
  void set_buttons(std::uint16_t buttons) noexcept { pressed_ = (buttons & buttons_) != 0; }
  /// True if the jaws open, or close, at the next step.
  bool opens() const { return closed_ && buttons_ != 0 && !pressed_; }
  bool closes() const { return !closed_ && pressed_; }
  /// Around what is there of the surface with the tool at `pose`; perhaps nothing.
  void close(const ToolPose& pose, std::span<const Vec3> positions) noexcept;
  /// Jaws without a button stay closed.
  void open() noexcept;
  bool holds() const { return !vertices_.empty(); }
  std::span<const int> vertices() const { return vertices_; }
  /// Returns the offset of one of them from the centre of the tool at `pose`, m.
  Vec3 offset(std::size_t held, const ToolPose& pose) const;
  int max_vertices() const { return static_cast<int>(max_nodes_); }

  /// Force on the tool, N, torque about its centre, N m, and tangent, N/m; `vertices` 0: the jaws are empty.
  struct Pull {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    Mat3 tangent = Mat3::Zero();
    int vertices = 0, rounds = 0;
    bool converged = true;
  };
  /// Solves with the tool at `pose`, and replaces the loads of the tool by those on the grasped
  /// vertices.
  Pull pull(const ToolPose& pose, ToolTissue tissue);

  std::size_t bytes() const;

 private:
  void hold(int vertex, const Vec3& offset) noexcept;
  double misfit(const ToolPose& pose, const ToolTissue& tissue, std::span<const VertexLoad> own);
  bool take_compliance(const ToolTissue& tissue);
  bool factor(const ToolTissue& tissue);
  void solve(Eigen::Ref<Eigen::VectorXd> misfit) const noexcept;
  Mat3 tangent(const ToolPose& pose) noexcept;
  Vec3 axis(const ToolPose& pose) const { return (*pivot_ - pose.p_W).normalized(); }
  Quat turned(const ToolPose& pose) const;
  Mat3 turn_of_motion(const ToolPose& pose) const;
  Mat3 offset_of_motion(std::size_t held, const ToolPose& pose, const Mat3& turn) const;

  std::uint16_t buttons_;
  double reach_;  // m from the tool centre
  std::size_t max_nodes_;
  std::optional<Vec3> pivot_;          // of a shaft that turns about it, m
  bool turns_ = true;                  // some models have tissue that no tool turns
  std::optional<ToolPose> closed_at_;  // the pose when the jaws closed; of a tool not placed: none
  bool pressed_ = false, closed_ = false;
  std::vector<int> touchable_, vertices_;
  std::vector<Vec3> offsets_;  // then, m
  ContactPatch patch_;
  BoundedMatrix compliance_, factor_;  // (3m x 3m) of the vertices when last factored, m/N; and its factor
  bool factored_ = false;
  bool alone_ = false;             // each of them gives way by itself
  std::vector<Mat3> stiffness_;    // of each then, N/m
  double contact_compliance_ = 0;  // m/N, in series with each vertex
  Eigen::VectorXd misfit_;         // (3m), m
  Eigen::Matrix<double, Eigen::Dynamic, 3> spread_;
};

}  // namespace palpate::sim
