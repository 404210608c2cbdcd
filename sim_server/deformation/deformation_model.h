#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/contact/contact_solver.h"

namespace palpate::sim {

/// A force on one vertex of the surface.
struct NodalLoad {
  int vertex;  ///< surface vertex
  Vec3 force;  ///< N, world
  bool operator==(const NodalLoad&) const = default;
};

/// A tissue free of contact; valid until it is asked again.
struct FreeMotion {
  std::span<const Vec3> positions;        ///< (n)
  std::span<const Vec3> velocities = {};  ///< (n), m/s, of its supports' doing; empty: they rest
  /// (n) under the loads that are held; empty: `apply` will tell, or told it before
  std::span<const Vec3> loaded = {};
};

/// Bytes that a part of the program holds, for reports.
struct MemoryPart {
  std::string name;
  std::size_t bytes;
  std::string detail = {};  ///< counts
};

/// A tissue. Every model answers the same questions (where would you go, how compliant are you, here are the
/// loads: move), so that one contact solver serves them all. Vertices are those of the surface (`Surface`),
/// positions in m in the world frame. One thread. Answers of the models that are computed beforehand neither
/// allocate nor throw; one that solves in each step (`Implicit`) allocates, may start threads, and throws
/// what those do (`std::bad_alloc`), which `Simulation::step` catches.
class DeformationModel {
 public:
  virtual ~DeformationModel() = default;

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

  /// What this model holds in memory.
  virtual std::vector<MemoryPart> memory() const = 0;
};

}  // namespace palpate::sim
