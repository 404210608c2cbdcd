#pragma once
#include <optional>

#include "sim_server/deformation/cuttable_body.h"
#include "sim_server/deformation/lumped_compliance.h"
#include "sim_server/deformation/mass_scaling.h"
#include "sim_server/deformation/near_tools.h"
#include "sim_server/deformation/cuttable_body.h"
#include "sim_server/deformation/region_in_motion.h"
#include "sim_server/deformation/told_nearby.h"

namespace palpate::sim {

/// Linear elastic tissue in motion that is cut while it is felt: explicit dynamics with a tensor per vertex
/// and edge (`ExplicitMotion`), all of the body or, beside a `CondensedRest`, the vertices that what can be
/// cut has, with some around them. Contact is solved at each sub-step of h, over which each vertex in motion
/// gives way alone, by h^2 / m (`LumpedCompliance`): nothing that was computed beforehand is of tissue that
/// is no more. Sub-steps are as short as the stiffest elements ask for, so that they stay stable whatever is
/// removed; the very stiffest get a little more mass instead (`MassScaling`). Clients are told no tangents:
/// those of so short a time are far too steep; but, while it is left alone, the surface near the tools with
/// its slow modes (`ToldNearby`). At such short instants contact in a pit of
/// a coarse mesh chatters by some percent; more `instants` end that.
///
/// The rest follows the border at each sub-step: what it does there is part of the stiffness of an explicit
/// step, no stiffer than the border is where the rest is held (Guyan), so that sub-steps need not be shorter
/// for it. Once in some sub-steps is no choice: where the rest takes the share p of a mode's stiffness away,
/// it lags by p / (1 - p) / 2 of the time in between, and p is 0.9 to 1 of what moves slowly.
class CuttableMotion : public DeformationModel {
 public:
  /// All of the body in motion. Throws `Error` where nothing holds it, or the scene names no rate.
  explicit CuttableMotion(const ModelInputs& inputs);
  /// A region of it in motion; the rest is condensed. Throws `Error` as `CondensedRest`, too.
  CuttableMotion(const ModelInputs& inputs, const RegionInMotion& region);

  int instants() const noexcept override { return instants_; }
  bool force_leads() const noexcept override { return true; }
  /// Any `dt` > 0 is taken for one sub-step.
  void narrow(std::span<const Neighbourhood> places, std::span<const Triangle> triangles) noexcept override;
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  const ComplianceSource* compliance_source() const noexcept override { return &*compliance_; }
  bool compliance_is_constant() const noexcept override { return false; }
  std::span<const Vec3> apply(std::span<const NodalLoad> loads) noexcept override;
  bool knows_later_compliance() const noexcept override { return false; }
  /// Empty where some of the body is condensed.
  std::span<const Vec3> nodes() const noexcept override;
  Removed remove(std::span<const int> tetrahedra, const CutMesh& left) override;
  void part(std::span<const Slide> slides, const Parting& parting, const CutMesh& left) override;
  const SlowModes* slow_modes() const noexcept override;
  void modal_state(Eigen::Ref<Eigen::VectorXd> q, Eigen::Ref<Eigen::VectorXd> v) noexcept override;
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::shared_ptr<const ToldSurface> told() const noexcept override;
  void tell_near(std::span<const ToldTool> tools, const CutMesh& left, bool waits) override;
  std::vector<MemoryPart> memory() const override;

  double sub_step() const { return sub_step_; }  ///< s

 private:
  CuttableMotion(const ModelInputs& inputs, const RegionInMotion* region);
  void choose_sub_step(const ModelInputs& inputs, double modes);
  void look_at_body();
  void show_corners(std::span<const int> tetrahedra, const CutMesh& left);
  void go_on_with_body() noexcept;
  void end_contact() noexcept;
  void end_sub_step() noexcept;
  void take_sub_step() noexcept;
  void follow() noexcept;
  void note_moved() noexcept;
  void look_at(int vertex) noexcept;
  const std::vector<int>& looked_at() const noexcept {
    return near_.narrowed() ? near_.vertices() : exposed_;
  }
  void update_free(std::span<const int> vertices) noexcept;
  void carry_rest() noexcept;
  /// What a load on a vertex in motion changes its velocity by over a sub-step, m/s.
  Vec3 kick_of(const NodalLoad& load) const {
    const int place = body_->first[static_cast<std::size_t>(load.vertex)] / 3;
    return sub_step_ / body_->tensors.masses()[static_cast<std::size_t>(place)] * load.force;
  }
  const Vec3& rest_place(int vertex) const {
    return rest_places_[static_cast<std::size_t>(node_[static_cast<std::size_t>(vertex)])];
  }
  void press() noexcept;
  void note_pressed() noexcept;
  void go_free(std::span<const int> vertices) noexcept;
  Removed lost_with(int tetrahedron, const CutMesh& left) const;

  Material material_;
  double held_stiffness_;  // N/m
  MassScaling scaling_;
  std::unique_ptr<CuttableBody> body_;  // its motion free of the loads of this sub-step
  std::optional<ToldNearby> told_;  // to clients
  std::vector<double> force_;       // of the rest on the border, N
  int instants_ = 1, instant_ = 0;  // of a step; how many of this one are done
  double sub_step_ = 0;             // s
  std::optional<LumpedCompliance> compliance_;
  bool changed_ = true;                 // the body is not as its last sub-step left it
  bool ended_ = false;                  // the sub-step in hand has its end, as tissue was removed
  std::vector<Vec3> kept_;              // of `carry_rest`: where loaded vertices are without their loads, m
  std::vector<NodalLoad> loads_;        // over it
  std::vector<char> shown_;             // of surface vertices: triangles have or had them as corners
  std::vector<int> moving_, exposed_;   // surface vertices in motion; those of them that are shown
  NearTools near_;                      // of these, where contact looks within a step
  std::vector<int> pressed_;            // that are loaded, and not where they are free
  std::vector<int> moved_;              // in this sub-step; those that are pressed last
  std::size_t moved_by_itself_ = 0;     // so many of them are not
  std::size_t watched_ = 0;             // so many that contact looks at of the rest are among them
  std::vector<int> node_;               // per surface vertex: its mesh vertex
  std::vector<Vec3> free_, positions_;  // of surface vertices, m
  std::vector<Vec3> rest_places_;       // of mesh vertices, m
  mutable std::vector<Vec3> nodes_;     // of `nodes`
};

}  // namespace palpate::sim
