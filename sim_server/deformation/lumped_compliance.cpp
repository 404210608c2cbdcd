#include "sim_server/deformation/lumped_compliance.h"

namespace palpate::sim {

LumpedCompliance::LumpedCompliance(const ElasticTensors& tensors, std::span<const int> first, double h,
                                   double held_stiffness)
    : tensors_(tensors), first_(first), h_(h), held_compliance_(1 / held_stiffness) {}

/// m/N.
double LumpedCompliance::of(int vertex) const noexcept {
  const int first = first_[static_cast<std::size_t>(vertex)];
  return first < 0 ? held_compliance_ : h_ * h_ / tensors_.masses()[static_cast<std::size_t>(first / 3)];
}

void LumpedCompliance::begin(ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  for (int i = 0; i < patch.nodes(); ++i)
    patch.compliance.block<3, 3>(3 * i, 3 * i) =
        of(patch.vertices[static_cast<std::size_t>(i)]) * Mat3::Identity();
}

void LumpedCompliance::fill(int node, ContactPatch& patch) const noexcept {
  const double own = of(patch.vertices[static_cast<std::size_t>(node)]);
  patch.compliance.block(0, 3 * node, 3 * patch.nodes(), 3).setZero();
  patch.compliance.block<3, 3>(3 * node, 3 * node) = own * Mat3::Identity();
}

void LumpedCompliance::fill(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  const auto size = 3 * static_cast<Eigen::Index>(vertices.size());
  patch.compliance.topLeftCorner(size, size).setZero();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    patch.compliance.block<3, 3>(row, row) = of(vertices[i]) * Mat3::Identity();
  }
}

Mat3 LumpedCompliance::of_loads(std::span<const NodalLoad> loads) const noexcept {
  const Vec3 sum = sum_of(loads);
  double yields = 0;
  for (const NodalLoad& load : loads) yields += share_of(load, sum) * share_of(load, sum) * of(load.vertex);
  return yields * Mat3::Identity();
}

void LumpedCompliance::move(std::span<const NodalLoad> loads, std::span<Vec3> positions) noexcept {
  for (const NodalLoad& load : loads)
    positions[static_cast<std::size_t>(load.vertex)] += of(load.vertex) * load.force;
}

}  // namespace palpate::sim
