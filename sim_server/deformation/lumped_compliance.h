#pragma once
#include <vector>

#include "sim_server/deformation/vertex_compliance.h"
#include "sim_server/elasticity/tensors.h"

namespace palpate::sim {

/// How a tissue gives way over one explicit sub-step of h (s): each vertex for itself, by h^2 / m of its
/// lumped mass m, whatever it hangs on. So it stands when tissue is removed, and takes no memory. A fixed
/// vertex gives way as `held_stiffness` says.
class LumpedCompliance final : public VertexCompliance {
 public:
  /// `first`: per surface vertex three times its place among those of `tensors`, or -1: fixed. Both outlive
  /// this.
  LumpedCompliance(const ElasticTensors& tensors, std::span<const int> first, double h,
                   double held_stiffness);

  void begin(ContactPatch& patch) const noexcept override;
  void fill(int node, ContactPatch& patch) const noexcept override;
  void fill(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  bool gives_way(int vertex) const noexcept override { return first_[static_cast<std::size_t>(vertex)] >= 0; }
  Mat3 of_loads(std::span<const NodalLoad> loads) const noexcept override;
  void move(std::span<const NodalLoad> loads, std::span<Vec3> positions) noexcept override;
  std::size_t bytes() const override { return 0; }
  std::size_t index_bytes() const override { return 0; }

 private:
  double of(int vertex) const noexcept;

  const ElasticTensors& tensors_;
  std::span<const int> first_;
  double h_, held_compliance_;
};

}  // namespace palpate::sim
