#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/contact/contact_solver.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

class CutMesh;
struct Parting;
struct SlowModes;
struct ToldSurface;

/// A force on one vertex of the surface.
struct NodalLoad {
  int vertex;  ///< surface vertex
  Vec3 force;  ///< N, world
  bool operator==(const NodalLoad&) const = default;
};

/// The share of each of these loads in their sum, along it: they add up to 1. Where there is none, 0.
inline double share_of(const NodalLoad& load, const Vec3& sum) {
  const double size = sum.squaredNorm();
  return size > 0 ? load.force.dot(sum) / size : 0;
}
inline Vec3 sum_of(std::span<const NodalLoad> loads) {
  Vec3 sum = Vec3::Zero();
  for (const NodalLoad& load : loads) sum += load.force;
  return sum;
}

/// A tissue free of contact; valid until it is asked again.
struct FreeMotion {
  std::span<const Vec3> positions;        ///< (n)
  std::span<const Vec3> velocities = {};  ///< (n), m/s, of its supports' doing; empty: they rest
  /// (n) under the loads that are held; empty: `apply` will tell, or told it before
  std::span<const Vec3> loaded = {};
  /// (n) as its supports alone have moved it; empty: they rest, or that is not known apart
  std::span<const Vec3> carried = {};
  /// Surface vertices that may be elsewhere than at the end of the step before; `apply` may add to them.
  /// Null: any may
  const std::vector<int>* moved = nullptr;
};

/// Around a tool, where contact may look, m, world.
struct Neighbourhood {
  Vec3 middle;
  double radius;
};

/// Bytes that a part of the program holds, for reports.
struct MemoryPart {
  std::string name;
  std::size_t bytes;
  std::string detail = {};  ///< counts
};

/// A tissue. Every model answers the same questions (where would you go, how compliant are you, here are the
/// loads: move), so that one contact solver serves them all. Vertices are those of the surface (`Surface`),
/// positions in m in the world frame. One thread; explicit steps of a large body hand parts of them to others
/// (`PromptTeam`). Answers of the models that are computed beforehand neither throw nor, but for the first
/// step of a large body, which starts threads, allocate. One that solves
/// in each step (`Implicit`), and one of tissue that can be cut, allocates, may start threads and wait for
/// them, and throws what those do (`std::bad_alloc`), which `Simulation::step` catches. A factor made in a
/// step locks for as long as its order is found, and warns in the log where memory does not let it be as fine
/// as it should be.
class DeformationModel {
 public:
  virtual ~DeformationModel() = default;

  /// Into how many steps of equal length a step of the scene is cut, with contact solved at the end of each.
  virtual int instants() const noexcept { return 1; }

  /// Whether a force belongs to where it begins to lead the surface, not to the end of the step that it is
  /// held for. Then contact is solved with the tool one such step ahead of the force that is felt.
  virtual bool force_leads() const noexcept { return false; }

  /// At all instants of the step to come but the last, contact looks nowhere else: a model of many may tell
  /// only there where the tissue is until the step ends. Empty: anywhere. `triangles`: the surface.
  virtual void narrow(std::span<const Neighbourhood> places, std::span<const Triangle> triangles) noexcept {
    (void)places, (void)triangles;
  }

  /// Where would you go freely in `dt` (s), without any contact?
  virtual FreeMotion free_motion(double dt) = 0;

  /// How compliant are you at these vertices? Fills the leading (3m x 3m) of `patch.compliance` (m/N:
  /// displacement at the end of the step per force held over it; symmetric, positive semi-definite) and
  /// `patch.tool_compliance`.
  virtual void compliance(std::span<const int> vertices, ContactPatch& patch) const = 0;

  /// The same column by column, of models that know it beforehand; else nothing.
  virtual const ComplianceSource* compliance_source() const noexcept { return nullptr; }

  /// Whether `compliance` always gives the same, whatever was done before; then any thread may ask for it at
  /// any time, into a patch of its own.
  virtual bool compliance_is_constant() const noexcept = 0;

  /// Here are the loads: move. Positions (n) under them, valid until the next call. Replaces the loads
  /// before.
  virtual std::span<const Vec3> apply(std::span<const NodalLoad> loads) = 0;

  /// Looks again at where the loads of the last `apply` led: where a linearisation about that place would say
  /// something else, the free motion of that, under the same loads; nothing where all is said.
  virtual std::optional<FreeMotion> relinearise() { return {}; }

  /// Whether the last step came to balance: false where it is an answer held for want of a better one.
  virtual bool balanced() const noexcept { return true; }
  /// Whether that is because some element stays turned inside out, which a law that softens in compression
  /// lets it do.
  virtual bool inside_out() const noexcept { return false; }

  /// How much farther (m/N, symmetric) the surface that bears these loads, as one piece, gives way to a force
  /// that is held for `seconds` than to one held to the end of the step, which is what `compliance` tells. 0
  /// where that is all the same, or not known.
  virtual Mat3 later_compliance([[maybe_unused]] std::span<const NodalLoad> loads,
                                [[maybe_unused]] double seconds) const noexcept {
    return Mat3::Zero();
  }
  /// Whether the compliance told, with that, is what a tool feels until the next sample; false: it is that of
  /// a much shorter time, so that a tangent made of it would be far too steep to be told, and the force at
  /// one instant chatters: the mean over the last quarter of a step is felt.
  virtual bool knows_later_compliance() const noexcept { return true; }
  /// The slow modes of a linear tissue that swings, for clients that step it between two samples; null: it
  /// has none, or does not know them. They never change, unless the model has a `told`.
  virtual const SlowModes* slow_modes() const noexcept { return nullptr; }
  /// Amplitudes and rates (m sqrt(kg), m sqrt(kg)/s) of the told ones of these modes, as many each, at the
  /// end of the last step, under the loads of `apply`.
  virtual void modal_state([[maybe_unused]] Eigen::Ref<Eigen::VectorXd> q,
                           [[maybe_unused]] Eigen::Ref<Eigen::VectorXd> v) {}
  /// Of a tissue that relaxes, what it remembers besides by then (`SlowModes::State`).
  virtual void relaxed_state([[maybe_unused]] Eigen::MatrixXd& z, [[maybe_unused]] std::vector<Vec3>& psi) {}
  /// As `compliance`, of all but the told modes, at rest: what follows at once. Constant; any thread.
  virtual void residual_compliance([[maybe_unused]] std::span<const int> vertices,
                                   [[maybe_unused]] ContactPatch& patch) const noexcept {}

  /// Where all vertices of the mesh are by now (m), as after the last `apply` or, where that costs more than
  /// to look, a contact instant before; valid until the next call. Empty: it only knows those of the surface.
  virtual std::span<const Vec3> nodes() const noexcept { return {}; }

  /// What went with tissue that was removed.
  struct Removed {
    double elastic = 0, kinetic = 0;  ///< J
    Vec3 momentum = Vec3::Zero();     ///< N s
  };
  /// Between two steps: these tetrahedra are no more, `left` are. What is left goes on from where it is, as
  /// fast as before. Loads on vertices that no tetrahedron is left at are dropped. Of models whose row says
  /// `cuts`. O(removed), whatever the size of the mesh. Allocates.
  virtual Removed remove([[maybe_unused]] std::span<const int> tetrahedra,
                         [[maybe_unused]] const CutMesh& left) {
    return {};
  }

  /// A mesh vertex goes along an edge of what is left by this share of it, at rest, and as it is deformed.
  struct Slide {
    int vertex, towards;
    double share;
  };
  /// Between two steps: these vertices slid, in this order, then faces were parted; `left` is what is left
  /// by now. Copies of vertices are where these are, as fast. Of models whose row says `cuts`. O(changed)
  /// but for room; of `Implicit` some solves in the next step. Allocates.
  virtual void part([[maybe_unused]] std::span<const Slide> slides, [[maybe_unused]] const Parting& parting,
                    [[maybe_unused]] const CutMesh& left) {}

  /// What clients may know by now of a surface that can be cut, with its `slow_modes`; null: nothing, as it
  /// has been cut just now, or cannot be. Never changes once it is told, and may be read by any thread.
  virtual std::shared_ptr<const ToldSurface> told() const noexcept { return {}; }
  /// A tool whose client wants to know the surface.
  struct ToldTool {
    Vec3 p_W, v_W;  ///< m, m/s
  };
  /// Between two steps, when all was removed: what is `told` may change now, to be that near these tools.
  /// `waits`: for the background, so that the same is told at the same step on every machine. Allocates
  /// where anything changes.
  virtual void tell_near([[maybe_unused]] std::span<const ToldTool> tools,
                         [[maybe_unused]] const CutMesh& left, [[maybe_unused]] bool waits) {}

  /// What this model holds in memory.
  virtual std::vector<MemoryPart> memory() const = 0;
};

}  // namespace palpate::sim
