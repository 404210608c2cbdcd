#include "sim_server/models/quasi_static.h"

#include <algorithm>

#include "sim_server/statics/linear_statics.h"

namespace palpate::sim {

QuasiStatic::QuasiStatic(const ModelInputs& inputs) : compliance_(inputs) {
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  for (Answer* answer : {&answer_, &before_}) {
    answer->positions = rest_;
    answer->loads.reserve(rest_.size());
  }
  const LinearStatics statics(inputs);
  statics.fill(compliance_);
  supports_ = statics.supports(Following::kAtOnce);
  inputs.progress(name_of(Stage::kCompliance), 1);
}

double QuasiStatic::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  return body_bytes(counts, scene.material->element, 1);
}

FreeMotion QuasiStatic::free_motion(double dt) noexcept {
  if (!supports_) return {rest_};
  answer_.valid = before_.valid = false;
  return supports_->advance(dt);
}

void QuasiStatic::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
}

std::span<const Vec3> QuasiStatic::apply(std::span<const VertexLoad> loads) noexcept {
  const auto is_of = [&](const Answer& answer) {
    return answer.valid && std::ranges::equal(answer.loads, loads);
  };
  if (is_of(answer_)) return answer_.positions;
  std::swap(answer_, before_);
  if (is_of(answer_)) return answer_.positions;
  const std::span<const Vec3> free = supports_ ? supports_->positions() : rest_;
  std::ranges::copy(free, answer_.positions.begin());
  compliance_.move(loads, answer_.positions);
  answer_.valid = loads.size() <= answer_.loads.capacity();
  if (answer_.valid) answer_.loads.assign(loads.begin(), loads.end());
  return answer_.positions;
}

std::any QuasiStatic::save() {
  State state{answer_, before_, {}};
  if (supports_) state.supports = supports_->state();
  return state;
}

FreeMotion QuasiStatic::restore(const std::any& saved) {
  const auto& state = std::any_cast<const State&>(saved);
  const auto take = [this](Answer& to, const Answer& from) {
    to = from;
    to.loads.reserve(rest_.size());
  };
  take(answer_, state.answer);
  take(before_, state.before);
  if (!supports_) return {.positions = rest_, .loaded = answer_.positions};
  supports_->set_state(*state.supports);
  return {.positions = supports_->positions(),
          .velocities = supports_->velocities(),
          .loaded = answer_.positions};
}

std::vector<MemoryPart> QuasiStatic::memory() const {
  std::vector<MemoryPart> parts{{"compliance", compliance_.bytes(), compliance_.detail()},
                                {"positions", 3 * rest_.size() * sizeof(Vec3) + compliance_.index_bytes()}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  return parts;
}

}  // namespace palpate::sim
