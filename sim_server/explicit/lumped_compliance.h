#pragma once
#include <vector>

#include "sim_server/elasticity/tensors.h"
#include "sim_server/explicit/condensed_part.h"

namespace palpate::sim {

/// Compliance of a tissue over one explicit sub-step of h (s). Each vertex in motion yields alone, by h^2 / m
/// of its lumped mass m, so that a removal of tissue does not change it and it takes no memory. The vertices
/// of a condensed part yield as that says, a fixed vertex by `held_stiffness`. One thread; neither allocates
/// nor throws.
class LumpedCompliance final : public ComplianceSource {
 public:
  using ComplianceSource::fill;
  /// `first`: per surface vertex three times its place among those of `tensors`, or -1: not in motion.
  /// `rest`: null where all of the body is in motion. All of them outlive this.
  LumpedCompliance(const ElasticTensors& tensors, std::span<const int> first, CondensedPart* rest, double h,
                   double held_stiffness);

  void begin(ContactPatch& patch) const noexcept override;
  void fill(int node, ContactPatch& patch) const noexcept override;
  bool each_alone(std::span<const int> vertices, std::span<Mat3> each) const noexcept override;
  /// Fills the compliance as `DeformationModel::compliance`.
  void fill(std::span<const int> vertices, ContactPatch& patch) const noexcept;
  /// Moves `positions` (surface vertices, m), those of loads at `free`, by what `loads` do; `all` as in
  /// `CondensedPart::apply_loads`.
  void move(std::span<const VertexLoad> loads, bool all, std::span<const Vec3> free,
            std::span<Vec3> positions) const noexcept;

 private:
  Mat3 block(int vertex, int other) const noexcept;
  Mat3 own(int vertex) const noexcept;

  const ElasticTensors& tensors_;
  std::span<const int> first_;
  CondensedPart* rest_;
  double h_, held_compliance_;
};

}  // namespace palpate::sim
