#pragma once
#include <optional>

#include "common/contact/contact_solver.h"
#include "haptic_client/extrapolation/surface_model.h"

namespace palpate::client {

/// The contact of a tool with the part of the surface near it, solved with the server's own solver: goes with
/// the tool, place by place, and takes out of the model the patch that can be touched. All in the frame of
/// the surface at rest. Haptic thread; only the constructor allocates (about 12 MB).
class ContactOnPatch {
 public:
  ContactOnPatch();

  /// Goes to `p` (m) in strides, and gives the force on the tool there (N); nothing where the model does not
  /// know all that may be touched there, or the way is too long to be gone in one tick: then it has no place.
  std::optional<Vec3> go(const SurfaceModel& model, const SphereTool& tool, double tool_compliance,
                         const Vec3& p) noexcept;
  /// The force at `p`; then it stands where it stood.
  std::optional<Vec3> probe(const SurfaceModel& model, const SphereTool& tool, double tool_compliance,
                            const Vec3& p) noexcept;
  /// It stands nowhere.
  void lift() noexcept { placed_ = false; }

 private:
  bool cover(const SurfaceModel& model, const SphereTool& tool, const Vec3& p) noexcept;
  bool gather(const SurfaceModel& model, const Vec3& p, double reach) noexcept;
  bool gather_compliance(const SurfaceModel& model) noexcept;
  void enter(const SphereTool& tool, const Vec3& p) noexcept;
  Eigen::Ref<Eigen::VectorXd> displacement() noexcept { return u_.head(3 * (patch_.nodes() + 1)); }
  double largest_displacement() const noexcept;

  ContactSolver solver_;
  ContactPatch patch_;
  std::vector<int> vertices_, slot_of_vertex_;  // patch node -> vertex of the model, and back (-1: none)
  std::vector<std::pair<int, Vec3>> loads_;     // scratch: vertex, N
  std::uint32_t version_ = 0;                   // of the model that the patch was taken from
  Vec3 center_ = Vec3::Zero();                  // of the patch
  double reach_ = 0;                            // of the patch, m
  Eigen::VectorXd u_, kept_u_;                  // of the patch nodes, then of the tip
  Vec3 place_ = Vec3::Zero();
  bool placed_ = false;
};

}  // namespace palpate::client
