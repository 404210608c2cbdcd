#pragma once
#include <any>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/contact/contact_solver.h"
#include "common/contact/vertex_load.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

class CutMesh;
struct Parting;
struct PublishedSurface;
struct PublishedModes;
struct ModalMotion;

/// Shape of the surface free of contact (n vertices, world frame). Valid until the model is called again.
struct FreeMotion {
  std::span<const Vec3> positions;        ///< (n) m
  std::span<const Vec3> velocities = {};  ///< (n) m/s, due to moving supports; empty: the supports rest
  /// (n) m, under the loads of the last `apply`; empty: unchanged since that `apply`
  std::span<const Vec3> loaded = {};
  /// (n) m, as the supports alone move the surface; empty: they rest, or the model does not separate this
  std::span<const Vec3> carried = {};
  /// Surface vertices that may have moved since the last contact instant; `apply` may append to them. Null:
  /// any vertex.
  const std::vector<int>* moved = nullptr;
};

/// Ball around a tool, in which contact is searched, world frame, m.
struct Neighbourhood {
  Vec3 middle;
  double radius;
};

/// Memory of one part of the program, for reports.
struct MemoryPart {
  std::string name;
  std::size_t bytes;
  std::string detail = {};  ///< counts
};

/// Capability of a model whose answer to loads is not linear in them.
class NonlinearModel {
 public:
  virtual ~NonlinearModel() = default;
  /// Linearises again where the loads of the last `apply` led. Returns the free shape of the new
  /// linearisation under the same loads, or nothing once the step has converged or may iterate no more.
  virtual std::optional<FreeMotion> relinearise() = 0;
  enum class Balance {
    kBalanced,
    kUnbalanced,  ///< the step ended before the forces balanced
    kInsideOut,   ///< some element stays inverted, which a law that softens in compression permits
  };
  /// Returns how the last step ended.
  virtual Balance balance() const noexcept = 0;
};

/// Capability of a model whose tissue can be removed and parted between two steps.
class CuttableModel {
 public:
  virtual ~CuttableModel() = default;
  /// Energy and momentum of removed tissue.
  struct Removed {
    double elastic = 0, kinetic = 0;  ///< J
    Vec3 momentum = Vec3::Zero();     ///< N s
  };
  /// Removes these tetrahedra. The remaining tissue keeps its positions and velocities. Loads on vertices
  /// that belong to no remaining tetrahedron are dropped. O(removed). Allocates.
  virtual Removed remove(std::span<const int> tetrahedra, const CutMesh& remaining) = 0;

  /// Motion of a mesh vertex along an edge by a fraction of it, at rest and as deformed.
  struct Slide {
    int vertex, towards;
    double fraction;
  };
  /// Slides these vertices, in this order, then parts faces. Copies of vertices take over position and
  /// velocity of their originals. O(changed) but for room; `implicit` pays some solves in the next step.
  /// Allocates.
  virtual void part(std::span<const Slide> slides, const Parting& parting, const CutMesh& remaining) = 0;

  /// Lets these parts (their tetrahedra, ascending) float: nothing holds them, and all else is held. Called
  /// after `remove` and `part`, once some tissue has come loose: linear tissue turns with the frame of each
  /// part (`FloatingPieces`). O(tissue). Allocates.
  virtual void release(std::span<const std::vector<int>> floating, const CutMesh& remaining) = 0;

  /// Restricts contact to these places until the last instant of the next step, so that the model need
  /// update no other vertices before. Empty: contact may be anywhere. `triangles`: the surface.
  virtual void restrict_contact(std::span<const Neighbourhood> places,
                                std::span<const Triangle> triangles) noexcept {
    (void)places, (void)triangles;
  }
};

/// Capability of a linear model in motion that publishes its slow modes and the residual compliance to
/// clients, which step the modes between two samples.
class ClientModel {
 public:
  virtual ~ClientModel() = default;
  /// Returns the published modes, or null: there are none now. They never change, except where the surface
  /// can be cut (`publish`).
  virtual const PublishedModes* modes() const noexcept = 0;
  /// Writes the amplitudes and rates of the published modes at the end of the last step, under the loads of
  /// `apply`, and, where `state` has room for it, the viscous memory of a tissue that relaxes.
  virtual void read_modes(ModalMotion& state) = 0;
  /// Fills the compliance as `DeformationModel::compliance`, at rest, without the published modes. Constant
  /// while the modes are; any thread.
  virtual void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept = 0;

  /// Tool whose client asks for the surface.
  struct Tool {
    Vec3 p_W, v_W;  ///< m, m/s
  };
  /// Updates the surface published near these tools, between two steps, after all removals. Returns it, or
  /// null: nothing is published now, as after a cut, or the whole surface is published for good. A published
  /// surface is immutable and may be read by any thread. `waits`: waits for the background thread, so that
  /// the same is published in the same step on every machine. Allocates where anything changes.
  virtual std::shared_ptr<const PublishedSurface> publish([[maybe_unused]] std::span<const Tool> tools,
                                                          [[maybe_unused]] const CutMesh& remaining,
                                                          [[maybe_unused]] bool waits) {
    return {};
  }
};

/// Capability of a model that knows its compliance over the sample interval.
class LaterCompliance {
 public:
  virtual ~LaterCompliance() = default;
  /// Returns how much more (m/N, symmetric) the surface that bears these loads, as one piece, yields to a
  /// force held for `seconds` than to one held to the end of the step, which `compliance` describes.
  virtual Mat3 later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept = 0;
};

/// Capability of a model that knows the positions of all mesh vertices.
class InteriorView {
 public:
  virtual ~InteriorView() = default;
  /// Returns the positions of all mesh vertices (m), at most a contact instant before the last `apply`.
  /// Valid until the next call. Empty: only the surface is known now.
  virtual std::span<const Vec3> nodes() const noexcept = 0;
};

/// Capability of every model that changes in a step: its state as a value.
class StatefulModel {
 public:
  virtual ~StatefulModel() = default;
  /// Returns a copy of all that steps and cuts change. Waits for background work, whose results take effect
  /// in the same step as without. Allocates.
  virtual std::any save() = 0;
  /// Takes over such a state, of this model. The model then continues byte for byte as after `save`. Returns
  /// the free shape then. Allocates.
  virtual FreeMotion restore(const std::any& state) = 0;
};

/// Properties of a model that set-up fixes, and its capabilities: null where it has none.
struct ModelTraits {
  int instants = 1;  ///< contact instants within a step of the scene, evenly spaced, the last at its end
  /// `compliance` always gives the same; any thread may call it at any time with a patch of its own.
  bool constant_compliance = false;
  /// A force takes effect from its contact instant on: contact is solved with the tool one instant ahead of
  /// the force that is rendered.
  bool leading_force = false;
  /// The compliance, with `later`, holds until the next sample. False: it holds for a much shorter time, so
  /// that a tangent made of it would be far too steep to publish, and the rendered force is the mean over the
  /// last quarter of a step, as that at one instant chatters.
  bool publishes_tangents = true;
  bool turns =
      true;  ///< false: it moves as one piece that no torque turns, so jaws that hold it turn without it
  double added_mass = 0;  ///< more mass for the stiffest elements in motion, of the mass in motion
  const ComplianceSource* columns = nullptr;  ///< `compliance` column by column; null: not precomputed
  NonlinearModel* nonlinear = nullptr;
  CuttableModel* cuttable = nullptr;
  ClientModel* client = nullptr;
  LaterCompliance* later = nullptr;
  InteriorView* interior = nullptr;
  StatefulModel* state = nullptr;
};

/// Deformable body. Every model answers the same questions: free motion, compliance, positions under loads;
/// so that one contact solver serves them all. Vertices are those of the surface (`Surface`), positions in m
/// in the world frame. One thread; explicit steps of a large body hand parts of them to others
/// (`PromptTeam`). Precomputed models neither throw nor, after the first step of a large body, allocate. A
/// model that solves in each step (`Implicit`), and one of tissue that can be cut, allocates, may start
/// threads and wait for them, and throws what those do (`std::bad_alloc`), which `Simulation::step` catches.
class DeformationModel {
 public:
  virtual ~DeformationModel() = default;

  /// Advances the body by `dt` (s) without contact; 0: no time passes. Models of fixed step length take any
  /// `dt` > 0 for one contact instant.
  virtual FreeMotion free_motion(double dt) = 0;

  /// Fills the leading (3m x 3m) of `patch.compliance` for these vertices (m/N: displacement at the end of
  /// the instant per force held over it; symmetric, positive semi-definite) and `patch.tool_compliance`.
  virtual void compliance(std::span<const int> vertices, ContactPatch& patch) const = 0;

  /// Replaces the loads. Returns the positions (n) under them, valid until the next call.
  virtual std::span<const Vec3> apply(std::span<const VertexLoad> loads) = 0;

  /// Returns the properties and capabilities of this model. The same at each call; read once, at set-up.
  virtual ModelTraits traits() noexcept = 0;

  /// Returns the memory of this model, by parts. `explain` adds details to parts of these names:
  /// "compliance", "stiffness matrix", "its factor" (`sim_server/commands/explain.cpp`).
  virtual std::vector<MemoryPart> memory() const = 0;
};

}  // namespace palpate::sim
