#include "sim_server/explicit/lumped_compliance.h"

#include <algorithm>

namespace palpate::sim {

LumpedCompliance::LumpedCompliance(const ElasticTensors& tensors, std::span<const int> first,
                                   CondensedPart* rest, double h, double held_stiffness)
    : tensors_(tensors), first_(first), rest_(rest), h_(h), held_compliance_(1 / held_stiffness) {}

/// Returns how a vertex moves per force on it, m/N.
Mat3 LumpedCompliance::own(int vertex) const noexcept {
  const int first = first_[static_cast<std::size_t>(vertex)];
  if (first >= 0) return h_ * h_ / tensors_.masses()[static_cast<std::size_t>(first / 3)] * Mat3::Identity();
  if (rest_ != nullptr && rest_->has(vertex)) return rest_->compliance(vertex, vertex);
  return held_compliance_ * Mat3::Identity();
}

/// Returns how one vertex moves per force on another, m/N.
Mat3 LumpedCompliance::block(int vertex, int other) const noexcept {
  if (vertex == other) return own(vertex);
  if (rest_ != nullptr && rest_->has(vertex) && rest_->has(other)) return rest_->compliance(vertex, other);
  return Mat3::Zero();
}

void LumpedCompliance::begin(ContactPatch& patch) const noexcept {
  if (rest_ != nullptr) rest_->watch(patch.vertices);
  patch.tool_compliance = 0;
  for (int i = 0; i < patch.nodes(); ++i)
    patch.compliance.block<3, 3>(3 * i, 3 * i) = own(patch.vertices[static_cast<std::size_t>(i)]);
}

void LumpedCompliance::fill(int node, ContactPatch& patch) const noexcept {
  const int vertex = patch.vertices[static_cast<std::size_t>(node)];
  for (int i = 0; i < patch.nodes(); ++i)
    patch.compliance.block<3, 3>(3 * i, 3 * node) =
        block(patch.vertices[static_cast<std::size_t>(i)], vertex);
}

bool LumpedCompliance::each_alone(std::span<const int> vertices, std::span<Mat3> each) const noexcept {
  const auto in_rest = [&](int vertex) { return rest_->has(vertex); };
  if (rest_ != nullptr && std::ranges::any_of(vertices, in_rest)) return false;
  std::ranges::transform(vertices, each.begin(), [&](int vertex) { return own(vertex); });
  return true;
}

void LumpedCompliance::fill(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  if (rest_ != nullptr) rest_->watch(vertices);
  patch.tool_compliance = 0;
  for (std::size_t j = 0; j < vertices.size(); ++j) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      patch.compliance.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j)) =
          block(vertices[i], vertices[j]);
  }
}

void LumpedCompliance::move(std::span<const VertexLoad> loads, bool all, std::span<const Vec3> free,
                            std::span<Vec3> positions) const noexcept {
  for (const VertexLoad& load : loads) {
    if (rest_ == nullptr || !rest_->has(load.vertex))
      positions[static_cast<std::size_t>(load.vertex)] += own(load.vertex) * load.force;
  }
  if (rest_ != nullptr) rest_->apply_loads(loads, all, free, positions);
}

}  // namespace palpate::sim
