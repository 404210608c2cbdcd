#pragma once
#include <span>

#include "sim_server/deformation/deformation_model.h"

namespace palpate::sim {

/// How compliant a linear tissue is at the vertices of its surface, to the end of a period. One thread;
/// neither allocates nor throws.
class VertexCompliance : public ComplianceSource {
 public:
  using ComplianceSource::fill;
  /// As `DeformationModel::compliance`.
  virtual void fill(std::span<const int> vertices, ContactPatch& patch) const noexcept = 0;
  /// Whether the tissue gives way at a surface vertex: it is free, and a tool can reach it.
  virtual bool gives_way(int vertex) const noexcept = 0;
  /// Of the surface that bears these loads, as one piece, m/N. O(loads^2).
  virtual Mat3 of_loads(std::span<const NodalLoad> loads) const noexcept = 0;
  /// Moves `positions` (surface vertices, m) by what `loads` do.
  virtual void move(std::span<const NodalLoad> loads, std::span<Vec3> positions) noexcept = 0;
  /// Of the numbers in it, and of what they belong to.
  virtual std::size_t bytes() const = 0;
  virtual std::size_t index_bytes() const = 0;
};

}  // namespace palpate::sim
