#pragma once
#include <optional>

#include "sim_server/deformation/explicit_motion.h"
#include "sim_server/deformation/lumped_compliance.h"
#include "sim_server/deformation/mass_scaling.h"

namespace palpate::sim {

/// Linear elastic tissue in motion that is cut while it is felt: explicit dynamics with a tensor per vertex
/// and edge (`ExplicitMotion`), all of the body or, beside a `CondensedRest`, the vertices that what can be
/// cut has, with some around them. Contact is solved at each sub-step of h, over which each vertex in motion
/// gives way alone, by h^2 / m (`LumpedCompliance`): nothing that was computed beforehand is of tissue that
/// is no more. Sub-steps are as short as the stiffest elements ask for, so that they stay stable whatever is
/// removed; the very stiffest get a little more mass instead (`MassScaling`). Clients are told no modes, and
/// no tangents: those of so short a time are far too steep. At such short instants contact in a pit of a
/// coarse mesh chatters by some percent; more `instants` end that.
///
/// The rest has no mass of its own but for that at the border, where its tetrahedra give their quarters. It
/// stays where it is, but for what tools press, until it follows the border, every so many sub-steps; from
/// then on it pushes there by B u_b of that moment (block Gauss-Seidel in time, as the alternating method of
/// Schwarz). That is right at rest, and stable however seldom it is done: a mode of frequency w in which B,
/// or what is left of it where tools hold the rest, takes the share p of the stiffness that the border has
/// where the rest stays, 0 <= p <= 1, goes over a time t with its centre held at p u_0, so that the
/// determinant of the step is 1 - p + p cos(w t) and its trace p + (2 - p) cos(w t): both roots lie in the
/// unit circle for all w t (Jury). It loses energy where it is late.
class CuttableMotion : public DeformationModel {
 public:
  /// All of the body in motion. Throws `Error` where nothing holds it, or the scene names no rate.
  explicit CuttableMotion(const ModelInputs& inputs);
  /// `moves`: of each mesh vertex, not 0 where it is in motion; the rest follows every `follow_every`
  /// sub-steps. Throws `Error` as `CondensedRest`, too.
  CuttableMotion(const ModelInputs& inputs, const std::vector<char>& moves, int follow_every);

  int instants() const noexcept override { return instants_; }
  bool force_leads() const noexcept override { return true; }
  /// Any `dt` > 0 is taken for one sub-step.
  FreeMotion free_motion(double dt) noexcept override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  const ComplianceSource* compliance_source() const noexcept override { return &*compliance_; }
  bool compliance_is_constant() const noexcept override { return false; }
  std::span<const Vec3> apply(std::span<const NodalLoad> loads) noexcept override;
  bool knows_later_compliance() const noexcept override { return false; }
  /// Empty where some of the body is condensed.
  std::span<const Vec3> nodes() const noexcept override;
  Removed remove(std::span<const int> tetrahedra, const CutMesh& left) override;
  std::vector<MemoryPart> memory() const override;

  double sub_step() const { return sub_step_; }  ///< s

 private:
  CuttableMotion(const ModelInputs& inputs, const std::vector<char>* moves, int follow_every);
  void choose_sub_step(const ModelInputs& inputs);
  void end_sub_step() noexcept;
  void take_sub_step() noexcept;
  void follow() noexcept;
  void update_free() noexcept;
  const Vec3& rest_place(int vertex) const {
    return rest_places_[static_cast<std::size_t>(node_[static_cast<std::size_t>(vertex)])];
  }
  void press() noexcept;
  Removed lost_with(int tetrahedron, const CutMesh& left) const;

  Material material_;
  MassScaling scaling_;
  ElasticTensors tensors_;
  std::optional<CondensedRest> rest_;
  int follow_every_;
  ExplicitMotion motion_;           // free of the loads of this sub-step
  std::vector<double> force_;       // of the rest on the border, N
  int instants_ = 1, instant_ = 0;  // of a step; how many of this one are done
  double sub_step_ = 0;             // s
  std::optional<LumpedCompliance> compliance_;
  bool ended_ = false;                  // the sub-step in hand has its end, as tissue was removed
  std::vector<NodalLoad> loads_;        // over it
  std::vector<int> first_;              // per surface vertex: its first number in `motion_`, or -1
  std::vector<int> node_;               // per surface vertex: its mesh vertex
  std::vector<Vec3> free_, positions_;  // of surface vertices, m
  std::vector<Vec3> rest_places_;       // of mesh vertices, m
  mutable std::vector<Vec3> nodes_;     // of `nodes`
};

}  // namespace palpate::sim
