#pragma once
#include <algorithm>
#include <type_traits>

#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

constexpr int kMostCorners = 10,
              kMostPoints = 4;  ///< of a quadratic tetrahedron: nodes, and quadrature points

/// Elements whose forces or stiffness wait in the scratch to be added up in their order.
constexpr std::size_t kElementsOfBatch = 2048;

/// 3 x 3 blocks of the lower triangle of an element's stiffness.
constexpr std::size_t blocks_of(int corners) {
  return static_cast<std::size_t>(corners * (corners + 1) / 2);
}

/// Tetrahedron with its nodes, quadrature points and weights.
struct Solid::Element {
  Element(const Solid& solid, std::size_t e)
      : nodes(solid.element_nodes_.data() + e * static_cast<std::size_t>(solid.corners_)),
        solid_(solid),
        first_point_(e * static_cast<std::size_t>(solid.points_)),
        linear_(solid.material_.law == ElasticLaw::kLinear) {}
  std::size_t point(int q) const { return first_point_ + static_cast<std::size_t>(q); }
  double weight(int q) const { return solid_.weight_[point(q)]; }
  const Vec3* gradients(int q) const {
    return solid_.gradient_.data() + point(q) * static_cast<std::size_t>(solid_.corners_);
  }
  /// Computes the deformation gradient F at each of its points, at positions `x` of the nodes (m).
  void deform(std::span<const Vec3> x, Mat3* F) const {
    if (solid_.corners_ == 4) {
      deform_nodes<4>(x, F);
    } else {
      deform_nodes<10>(x, F);
    }
  }
  /// Returns the part of the first Piola-Kirchhoff stress (Pa) by the stress before.
  Mat3 stored(const Mat3& F, const Mat3& memory) const { return linear_ ? memory : Mat3(F * memory); }

  const int* nodes;

 private:
  const Solid& solid_;
  std::size_t first_point_;
  bool linear_;

  template <int corners>
  void deform_nodes(std::span<const Vec3> x, Mat3* F) const {
    using Nodes = Eigen::Matrix<double, 3, corners>;
    Nodes at;
    for (int i = 0; i < corners; ++i) at.col(i) = x[nodes[i]];
    for (int q = 0; q < solid_.points_; ++q)
      F[q].noalias() = at.lazyProduct(Eigen::Map<const Nodes>(gradients(q)[0].data()).transpose());
    if (weight(0) == 0)
      std::fill_n(F, solid_.points_, Mat3(Mat3::Identity()));  // removed: wherever its nodes are
  }
};

}  // namespace palpate::sim
