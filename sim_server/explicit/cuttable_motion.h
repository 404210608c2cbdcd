#pragma once
#include <optional>

#include "sim_server/client_model/published_surface.h"
#include "sim_server/explicit/cuttable_body.h"
#include "sim_server/explicit/lumped_compliance.h"
#include "sim_server/explicit/mass_scaling.h"
#include "sim_server/explicit/near_tools.h"
#include "sim_server/explicit/region_in_motion.h"

namespace palpate::sim {

/// Linear elastic tissue in motion that is cut while tools touch it: explicit dynamics with a tensor per
/// vertex and edge (`ExplicitMotion`), all of the body or, beside a `CondensedPart`, the vertices that what
/// can be cut has, with some around them. Contact is solved at each sub-step of h, over which each vertex in
/// motion gives way alone, by h^2 / m (`LumpedCompliance`): nothing that was computed beforehand is of tissue
/// that is no more. Sub-steps are as short as the stiffest elements ask for, so that they stay stable
/// whatever is removed; the very stiffest get a little more mass instead (`MassScaling`). No tangents are
/// published: those of so short a time are far too steep; but, while it is left alone, the surface near the
/// tools with its slow modes (`SurfacePublisher`). At such short instants contact in a pit of a coarse mesh
/// chatters by some percent; more `instants` end that.
///
/// The rest follows the border at each sub-step: what it does there is part of the stiffness of an explicit
/// step, no stiffer than the border is where the rest is held (Guyan), so that sub-steps need not be shorter
/// for it. Once in some sub-steps is no choice: where the rest takes the share p of a mode's stiffness away,
/// it lags by p / (1 - p) / 2 of the time in between, and p is 0.9 to 1 of what moves slowly.
class CuttableMotion final : public DeformationModel,
                             public CuttableModel,
                             public ClientModel,
                             public InteriorView,
                             public StatefulModel {
 public:
  /// Puts all of the body in motion. Throws `Error` where nothing holds it, or the scene names no rate.
  explicit CuttableMotion(const ModelInputs& inputs);
  /// A region of it in motion; the rest is condensed. Throws `Error` as `CondensedPart`, too.
  CuttableMotion(const ModelInputs& inputs, const RegionInMotion& region);

  void restrict_contact(std::span<const Neighbourhood> places,
                        std::span<const Triangle> triangles) noexcept override;
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) noexcept override;
  std::span<const Vec3> nodes() const noexcept override;
  Removed remove(std::span<const int> tetrahedra, const CutMesh& remaining) override;
  void part(std::span<const Slide> slides, const Parting& parting, const CutMesh& remaining) override;
  void release(std::span<const std::vector<int>> floating, const CutMesh& remaining) override;
  const PublishedModes* modes() const noexcept override;
  void read_modes(ModalMotion& state) noexcept override;
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::shared_ptr<const PublishedSurface> publish(std::span<const Tool> tools, const CutMesh& remaining,
                                                  bool waits) override;
  ModelTraits traits() noexcept override;
  std::vector<MemoryPart> memory() const override;
  std::any save() override;
  FreeMotion restore(const std::any& state) override;

  double sub_step() const { return sub_step_; }  ///< s

 private:
  CuttableMotion(const ModelInputs& inputs, const RegionInMotion* region);
  void choose_sub_step(const ModelInputs& inputs, double modes);
  void take_body();
  void show_corners(std::span<const int> tetrahedra, const CutMesh& remaining);
  void continue_with_body() noexcept;
  void end_contact() noexcept;
  void end_sub_step() noexcept;
  void take_sub_step() noexcept;
  void note_moved() noexcept;
  void observe(int vertex) noexcept;
  const std::vector<int>& looked_at() const noexcept {
    return state_.near.narrowed() ? state_.near.vertices() : state_.exposed;
  }
  void update_free(std::span<const int> vertices) noexcept;
  void carry_rest() noexcept;
  /// Returns the change of velocity (m/s) of a vertex in motion by a load over a sub-step.
  Vec3 impulse_of(const VertexLoad& load) const {
    const int place = body_->first[static_cast<std::size_t>(load.vertex)] / 3;
    return sub_step_ / body_->tensors.masses()[static_cast<std::size_t>(place)] * load.force;
  }
  const Vec3& rest_place(int vertex) const {
    return state_.rest_places[static_cast<std::size_t>(node_[static_cast<std::size_t>(vertex)])];
  }
  void apply_loads() noexcept;
  void note_loaded() noexcept;
  void become_free(std::span<const int> vertices) noexcept;
  Removed lost_with(int tetrahedron, const CutMesh& remaining) const;

  /// State beside the body and what is published.
  struct State {
    std::vector<double> force;          // of the condensed part on the border, N
    int instant = 0;                    // contact instants of this step that are done
    bool changed = true;                // the body is not as its last sub-step left it
    bool ended = false;                 // the sub-step in hand has ended, as tissue was removed
    std::vector<VertexLoad> loads;      // over the sub-step
    std::vector<char> shown;            // of surface vertices: triangles have or had them as corners
    std::vector<int> moving, exposed;   // surface vertices in motion; those of them that are shown
    NearTools near;                     // of these, where contact is searched within a step
    std::vector<int> loaded_vertices;   // vertices that are loaded, and not at their free positions
    std::vector<int> moved;             // in this sub-step; those that are pressed last
    std::size_t moved_freely = 0;       // so many of them are not pressed
    std::size_t watched = 0;            // so many watched vertices of the condensed part are among them
    std::vector<Vec3> free, positions;  // of surface vertices, m
    std::vector<Vec3> rest_places;      // of mesh vertices, m
  };
  /// The whole model as a value.
  struct Saved {
    State state;
    ElasticTensors tensors;
    std::optional<CondensedPart> condensed;
    ExplicitMotion::Snapshot motion;
    std::vector<int> first;
    std::optional<SurfacePublisher::State> publisher;
  };
  void make_compliance();

  Material material_;
  double held_stiffness_;  // N/m
  MassScaling scaling_;
  std::unique_ptr<CuttableBody> body_;  // its motion free of the loads of this sub-step
  std::optional<SurfacePublisher> publisher_;
  int instants_ = 1;     // of a step
  double sub_step_ = 0;  // s
  std::optional<LumpedCompliance> compliance_;
  std::vector<int> node_;  // per surface vertex: its mesh vertex
  State state_;
  std::vector<Vec3> unloaded_;       // of `carry_rest`: positions of loaded vertices without their loads, m
  mutable std::vector<Vec3> nodes_;  // of `nodes`
};

}  // namespace palpate::sim
