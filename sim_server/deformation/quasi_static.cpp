#include "sim_server/deformation/quasi_static.h"

#include <algorithm>

#include "sim_server/deformation/linear_statics.h"

namespace palpate::sim {

QuasiStatic::QuasiStatic(const ModelInputs& inputs) : compliance_(inputs) {
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  positions_ = rest_;
  const LinearStatics statics(inputs);
  statics.fill(compliance_);
  supports_ = statics.supports(Following::kAtOnce);
  inputs.progress(name_of(Stage::kCompliance), 1);
}

double QuasiStatic::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  return body_bytes(counts, scene.material->element, 1);
}

FreeMotion QuasiStatic::free_motion(double dt) noexcept {
  return supports_ ? supports_->advance(dt) : FreeMotion{rest_};
}

void QuasiStatic::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
}

std::span<const Vec3> QuasiStatic::apply(std::span<const NodalLoad> loads) noexcept {
  const std::span<const Vec3> free = supports_ ? supports_->positions() : rest_;
  std::copy(free.begin(), free.end(), positions_.begin());
  compliance_.move(loads, positions_);
  return positions_;
}

std::vector<MemoryPart> QuasiStatic::memory() const {
  std::vector<MemoryPart> parts{
      {"compliance", compliance_.bytes(), compliance_.detail()},
      {"positions", (rest_.size() + positions_.size()) * sizeof(Vec3) + compliance_.index_bytes()}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  return parts;
}

}  // namespace palpate::sim
