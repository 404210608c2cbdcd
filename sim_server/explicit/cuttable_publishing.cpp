// What is published of a tissue that is cut, and reports of its memory: parts of CuttableMotion.
#include <fmt/core.h>

#include "sim_server/explicit/cuttable_motion.h"

namespace palpate::sim {

const PublishedModes* CuttableMotion::modes() const noexcept {
  return publisher_->surface() != nullptr ? &publisher_->surface()->motion.modes() : nullptr;
}

/// Reads them at the contact instant of the rendered force, a sub-step before the positions of the body: that
/// force has not acted on it yet.
void CuttableMotion::read_modes(ModalMotion& state) noexcept {
  PublishedMotion& motion = publisher_->surface()->motion;
  if (body_->rest) {
    state.q = motion.amplitudes();
    state.v = motion.rates();
    return;
  }
  const ExplicitMotion::State& body = body_->motion.state;
  motion.begin(body.u, body.v, body.f, 0);
  motion.push(sub_step_, state_.loads, state.q, state.v);
}

void CuttableMotion::residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  publisher_->surface()->motion.residual_compliance(vertices, patch);
}

std::shared_ptr<const PublishedSurface> CuttableMotion::publish(std::span<const Tool> tools,
                                                                const CutMesh& remaining, bool waits) {
  const std::shared_ptr<const PublishedSurface> before = publisher_->shared();
  publisher_->step(tools, {remaining, state_.positions, body_->tensors}, waits);
  PublishedSurface* const now = publisher_->surface();
  if (body_->rest && now != nullptr && now != before.get()) {
    if (before != nullptr)
      now->motion.place_as(before->motion);  // a cut would have ended that
    else
      now->motion.place_under(state_.loads);
  }
  return publisher_->shared();
}

std::vector<MemoryPart> CuttableMotion::memory() const {
  std::vector<MemoryPart> parts{
      {"tensors", body_->tensors.bytes(),
       fmt::format("{} vertices, {} edges; {} sub-steps of {:.3g} ms; {:.2g} g more for stiff elements",
                   body_->tensors.vertices(), body_->tensors.edges(), instants_, 1e3 * sub_step_,
                   1e3 * scaling_.added)},
      {"motion", body_->motion.bytes() + state_.force.size() * sizeof(double)},
      {"positions",
       (state_.free.size() + state_.positions.size() + 2 * nodes_.size() + unloaded_.capacity()) *
               sizeof(Vec3) +
           (state_.moving.capacity() + state_.exposed.capacity() + state_.loaded_vertices.capacity()) *
               sizeof(int) +
           state_.shown.size() + state_.loads.capacity() * sizeof(VertexLoad) +
           (body_->first.size() + node_.size()) * sizeof(int)}};
  if (publisher_)
    parts.push_back(
        {"published surface", publisher_->bytes(),
         fmt::format("near their tools, {:.2g} s after the last cut{}{}", publisher_->delay(),
                     publisher_->failure().empty() ? "" : "; not by now: ", publisher_->failure())});
  if (body_->rest)
    parts.push_back({"condensed part", body_->rest->bytes(),
                     fmt::format("{} parts, {} modes, {} vertices at the border, {} that tools reach",
                                 body_->rest->parts(), body_->rest->modes(), body_->rest->border(),
                                 body_->rest->vertices().size())});
  return parts;
}

}  // namespace palpate::sim
