#pragma once
#include <optional>

#include "common/contact/contact_solver.h"
#include "haptic_client/extrapolation/extrapolator.h"
#include "haptic_client/extrapolation/modal_memory.h"

namespace palpate::client {

/// The contact of a tool with the surface near it, solved with the server's own solver: goes with the tool,
/// place by place, on the patch of triangles that it may touch next, which it takes out of the model as it
/// goes. All in the frame of the surface at rest. Haptic thread; only the constructor allocates, 15 MB: the
/// matrices of a solver without friction (3.6) and one with it (10.4), the patch's compliance (0.7).
class ContactOnPatch {
 public:
  /// Tolerances of contact: how far from a solved place the force follows its tangent, and how well a place
  /// is solved. Both are fractions of the indentation, and at most of the tool radius.
  struct Accuracy {
    double near = 0.03, most_near = 0.01, tolerance = 0.002, most_tolerance = 1e-3;
  };
  /// Multiplications that contact may take in one call: some 0.5 ms, a quarter of a tick at 500 Hz, as a tick
  /// with a new sample makes two calls beside the device. Beyond, as with a coefficient of friction above 1
  /// or a wild compliance, the call gives nothing, and so ends in time. A coefficient of 0.3 takes at most
  /// half of it (measured on a block, at up to 0.2 m/s), one of 10 all of it in one of 100 calls.
  static constexpr double kMostWork = 1e6;
  /// Multiplications a second of ticks: a quarter of the time, of a shorter tick than 2 ms, too.
  static constexpr double kWorkPerSecond = kMostWork / 2e-3;
  explicit ContactOnPatch(const Accuracy& accuracy);
  ContactOnPatch() : ContactOnPatch(Accuracy{}) {}

  /// Goes to `p` (m) and gives the force on the tool there (N); nothing where the model does not know all
  /// that may be touched on the path, the contact does not settle, or, with friction, the motion is too long
  /// for one tick: then it stands nowhere. Without friction it enters anew after such a motion. In contact it
  /// solves anew where the tool has gone 3 % of how deep it presses, at most 1 % of its radius (`Accuracy`;
  /// with friction a quarter of that), and follows the tangent in between. `memory`: of a tissue that swings,
  /// whose modes turn and bend the patch, too; the frame goes with where that stands.
  std::optional<Vec3> move_to(const Surface& surface, const Vec3& p,
                              const ModalMemory* memory = nullptr) noexcept;
  /// The force at `p`; then it stands where it stood, on a patch around that.
  std::optional<Vec3> probe(const Surface& surface, const Vec3& p,
                            const ModalMemory* memory = nullptr) noexcept;
  /// Bounds the work of the calls to come by what ticks as long as these bear: call it once a tick.
  void bear(Time tick) noexcept;
  /// Lifts the tool: it has no place until the next call of `move_to`.
  void separate() noexcept;
  /// Its frame has been moved by `motion` (m): the same place is called another, so much farther.
  void rename(const Vec3& motion) noexcept {
    state_.place += motion;
    center_ += motion;
  }
  /// Returns the work of the last call, multiplications.
  double work() const noexcept { return most_work_ - work_remaining_; }
  /// Returns the loads on the surface there, and how often contact has been solved; each solve may change the
  /// loads.
  std::span<const VertexLoad> loads() const noexcept { return loads_; }
  std::uint64_t solves() const noexcept { return solves_; }
  /// Returns how the force changed with the place around the last one, N/m.
  const Mat3& tangent() const noexcept { return state_.tangent; }

 private:
  double near(const Surface& surface) const noexcept;
  ContactSolver::Effort effort(const Surface& surface) const noexcept;
  bool increment(const Surface& surface, const Vec3& p) noexcept;
  bool take_patch(const Surface& surface, const Vec3& p) noexcept;
  bool displace_near(const Surface& surface, const Vec3& p) noexcept;
  bool take_triangles(const Surface& surface, const Vec3& p) noexcept;
  bool take_compliance(const SurfaceModel& model) noexcept;
  bool take_shapes(const SurfaceModel& model) noexcept;
  void warp(const SurfaceModel& model) noexcept;
  void find_far_creep(const SurfaceModel& model) noexcept;
  Vec3 creep_of(int node) const noexcept;
  Vec3 note_directions(std::size_t vertices) noexcept;
  bool predict_tangent(const Vec3& motion) noexcept;
  void learn_tangent(const Vec3& motion, const Vec3& force_before) noexcept;
  void note_loads(const ContactSolver& solved) noexcept;
  void enter(const Surface& surface, const Vec3& p) noexcept;
  Eigen::Ref<Eigen::VectorXd> displacement() noexcept { return u_.head(3 * (patch_.nodes() + 1)); }

  ContactSolver& solver(const Surface& surface) noexcept {
    return surface.tool.friction > 0 ? with_friction_ : without_friction_;
  }

  Accuracy accuracy_;
  ContactSolver without_friction_, with_friction_;
  ContactPatch patch_;
  std::vector<int> vertices_;                // of the model, of each patch node
  std::vector<int> slot_of_vertex_;          // and back; -1: none
  std::vector<Vec3> start_;                  // where the patch nodes were when the increment began, m
  const ModalMemory* memory_ = nullptr;      // of this call
  std::vector<ModalMemory::Shapes> shapes_;  // of the patch nodes
  /// Creep by loads beyond the patch that are not forgotten.
  struct FarCreep {
    std::vector<Vec3> creep;  // of the patch nodes, m
    int age = 0;              // in increments
  } far_;
  std::vector<VertexLoad> loads_, stored_loads_;
  std::uint64_t solves_ = 0;
  double most_work_ = kMostWork, work_remaining_ = 0;  // of a call; of this call
  /// Vertices of the model near the tool.
  struct NearVertices {
    std::vector<char> is_near;  // whether a vertex is near enough to matter
    std::vector<Vec3> moved;    // displacement, m, where it is near
    std::vector<Vec3> crept;    // in addition, relative to `memory_`, m; likewise
    std::vector<Vec3> went;     // in the last increment, m; 0 where not known
  } near_;
  Eigen::VectorXd u_;           // of the patch nodes, then of the tip
  Eigen::VectorXd u_before_;    // when the last increment began
  Vec3 motion_ = Vec3::Zero();  // the last increment; 0: not known
  std::uint64_t version_ = 0;   // of the model that the patch is of
  Vec3 center_ = Vec3::Zero();  // of the patch
  struct State {
    bool placed = false;
    int contacts = 0;
    double depth = 0;                                      // m: the largest displacement
    Vec3 place = Vec3::Zero(), tip_offset = Vec3::Zero();  // solved for; tip minus place
    Vec3 force = Vec3::Zero();                             // there
    Mat3 tangent = Mat3::Zero();
  };
  State state_;
};

}  // namespace palpate::client
