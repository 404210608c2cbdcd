#include "sim_server/models/spring.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"

namespace palpate::sim {
namespace {

/// The root >= 1 of g^3 - g^2 = c for c >= 0, by Newton's method from above, where it falls monotonically.
double hardening(double c) noexcept {
  double g = 1 + std::cbrt(c);
  for (int i = 0; i < 64; ++i) {
    const double next = g - (g * g * (g - 1) - c) / (g * (3 * g - 2));
    if (!(next < g)) break;
    g = std::max(next, 1.0);
  }
  return g;
}

}  // namespace

SpringSettings SpringSettings::read(const Config& config) {
  SpringSettings settings;
  if (config.has("spring_stiffness"))
    settings.stiffness = config.vector("spring_stiffness", {1e-3, 1e6, "N/m"});
  if (config.has("hardening_length"))
    settings.hardening_length = config.number("hardening_length", {1e-4, 10, "m"});
  return settings;
}

std::string SpringSettings::to_text() const {
  std::string text;
  if (stiffness)
    text += fmt::format("spring_stiffness = [{:g}, {:g}, {:g}]\n", stiffness->x(), stiffness->y(),
                        stiffness->z());
  if (hardening_length) text += fmt::format("hardening_length = {:g}\n", *hardening_length);
  return text;
}

Spring::Spring(const ModelInputs& inputs)
    : held_(inputs.surface.vertices.size(), 0), held_compliance_(1 / held_stiffness(inputs.scene)) {
  const auto& settings = inputs.scene.deformation.of<SpringSettings>();
  if (!settings.stiffness)
    fail("{}: model \"spring\" needs `spring_stiffness`, [x, y, z] in N/m", inputs.scene.deformation.where);
  stiffness_ = *settings.stiffness;
  if (settings.hardening_length) per_length2_ = 1 / (*settings.hardening_length * *settings.hardening_length);
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  for (std::size_t v = 0; v < held_.size(); ++v)
    held_[v] = std::ranges::binary_search(inputs.fixed, inputs.surface.vertices[v]);
  state_.positions = rest_;
}

FreeMotion Spring::free_motion(double) noexcept {
  return {rest_};
}

double Spring::stretch_ratio() const noexcept {
  return state_.moved.dot(stiffness_.cwiseProduct(state_.moved)) / stiffness_.mean() * per_length2_;
}

void Spring::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  const Vec3 pull = stiffness_.cwiseProduct(state_.moved);
  Mat3 tangent = 2 * per_length2_ / stiffness_.mean() * pull * pull.transpose();
  tangent += (1 + stretch_ratio()) * Mat3(stiffness_.asDiagonal());
  const Mat3 inverse = tangent.inverse();
  const Mat3 block = 0.5 * (inverse + inverse.transpose());
  patch.tool_compliance = 0;
  const auto m = static_cast<Eigen::Index>(vertices.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i < m; ++i) {
      const bool held = held_[vertices[i]] != 0 || held_[vertices[j]] != 0;
      const Mat3 of_held = (i == j ? held_compliance_ : 0.0) * Mat3::Identity();
      patch.compliance.block<3, 3>(3 * i, 3 * j) = held ? of_held : block;
    }
  }
}

std::span<const Vec3> Spring::apply(std::span<const VertexLoad> loads) noexcept {
  Vec3 force = Vec3::Zero();
  for (const VertexLoad& load : loads) {
    if (held_[load.vertex] == 0) force += load.force;
  }
  const Vec3 linear = force.cwiseQuotient(stiffness_);
  state_.moved = linear / hardening(force.dot(linear) / stiffness_.mean() * per_length2_);
  for (std::size_t v = 0; v < rest_.size(); ++v)
    state_.positions[v] = held_[v] != 0 ? rest_[v] : Vec3(rest_[v] + state_.moved);
  for (const VertexLoad& load : loads) {
    if (held_[load.vertex] != 0) state_.positions[load.vertex] += held_compliance_ * load.force;
  }
  return state_.positions;
}

FreeMotion Spring::restore(const std::any& state) {
  state_ = std::any_cast<const State&>(state);
  return {.positions = rest_, .loaded = state_.positions};
}

std::vector<MemoryPart> Spring::memory() const {
  return {{"positions", (rest_.size() + state_.positions.size()) * sizeof(Vec3) + held_.size()}};
}

}  // namespace palpate::sim
