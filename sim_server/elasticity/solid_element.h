#pragma once
#include <type_traits>

#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

constexpr int kMostCorners = 10;

/// One tetrahedron with all it takes to work on it.
struct Solid::Element {
  Element(const Solid& solid, std::span<const Vec3> x, std::size_t e)
      : nodes(solid.element_nodes_.data() + e * static_cast<std::size_t>(solid.corners_)),
        solid_(solid),
        first_point_(e * static_cast<std::size_t>(solid.points_)),
        linear_(solid.material_.law == ElasticLaw::kLinear) {
    for (int i = 0; i < solid.corners_; ++i) x_[i] = x[nodes[i]];
  }
  std::size_t point(int q) const { return first_point_ + static_cast<std::size_t>(q); }
  double weight(int q) const { return solid_.weight_[point(q)]; }
  const Vec3* gradients(int q) const {
    return solid_.gradient_.data() + point(q) * static_cast<std::size_t>(solid_.corners_);
  }
  Mat3 deformation(int q) const {
    const Vec3* const g = gradients(q);
    const auto sum = [&](auto corners) {
      using Nodes = Eigen::Matrix<double, 3, decltype(corners)::value>;
      return Mat3(Eigen::Map<const Nodes>(x_[0].data()) * Eigen::Map<const Nodes>(g[0].data()).transpose());
    };
    return solid_.corners_ == 4 ? sum(std::integral_constant<int, 4>())
                                : sum(std::integral_constant<int, 10>());
  }
  /// What the stress before adds to the first Piola-Kirchhoff stress.
  Mat3 remembered(const Mat3& F, const Mat3& memory) const { return linear_ ? memory : Mat3(F * memory); }

  const int* nodes;

 private:
  const Solid& solid_;
  std::size_t first_point_;
  bool linear_;
  std::array<Vec3, kMostCorners> x_;
};

}  // namespace palpate::sim
