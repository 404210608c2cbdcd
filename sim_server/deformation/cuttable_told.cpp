// What clients are told of a tissue that is cut, and reports of what it holds: parts of CuttableMotion.
#include <fmt/core.h>

#include "sim_server/deformation/cuttable_motion.h"

namespace palpate::sim {

const SlowModes* CuttableMotion::slow_modes() const noexcept {
  return told_ && told_->told() != nullptr ? &told_->told()->motion.modes() : nullptr;
}

/// When the force that is felt began to lead, a sub-step before the body in motion stands where it does; that
/// force is not done to it yet.
void CuttableMotion::modal_state(Eigen::Ref<Eigen::VectorXd> q, Eigen::Ref<Eigen::VectorXd> v) noexcept {
  ToldMotion& motion = told_->told()->motion;
  if (body_->rest) {
    q = motion.amplitudes();
    v = motion.rates();
    return;
  }
  const ExplicitMotion::State& state = body_->motion.state;
  motion.begin(state.u, state.v, state.f, 0);
  motion.push(sub_step_, loads_, q, v);
}

void CuttableMotion::residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  told_->told()->motion.residual_compliance(vertices, patch);
}

std::shared_ptr<const ToldSurface> CuttableMotion::told() const noexcept {
  return told_ ? told_->shared() : nullptr;
}

void CuttableMotion::tell_near(std::span<const ToldTool> tools, const CutMesh& left, bool waits) {
  if (!told_) return;
  const std::shared_ptr<const ToldSurface> before = told_->shared();
  told_->step(tools, {left, positions_, body_->tensors}, waits);
  ToldSurface* const now = told_->told();
  if (!body_->rest || now == nullptr || now == before.get()) return;
  if (before != nullptr) return now->motion.stand_as(before->motion);  // a cut would have ended that
  now->motion.stand_under(loads_);
}

std::vector<MemoryPart> CuttableMotion::memory() const {
  std::vector<MemoryPart> parts{
      {"tensors", body_->tensors.bytes(),
       fmt::format("{} vertices, {} edges; {} sub-steps of {:.3g} ms; {:.2g} g more for stiff elements",
                   body_->tensors.vertices(), body_->tensors.edges(), instants_, 1e3 * sub_step_,
                   1e3 * scaling_.added)},
      {"motion", body_->motion.bytes() + force_.size() * sizeof(double)},
      {"positions", (free_.size() + positions_.size() + 2 * nodes_.size() + kept_.capacity()) * sizeof(Vec3) +
                        (moving_.capacity() + exposed_.capacity() + pressed_.capacity()) * sizeof(int) +
                        shown_.size() + loads_.capacity() * sizeof(NodalLoad) +
                        (body_->first.size() + node_.size()) * sizeof(int)}};
  if (told_)
    parts.push_back({"surface told to clients", told_->bytes(),
                     fmt::format("near their tools, {:.2g} s after the last cut{}{}", told_->delay(),
                                 told_->failure().empty() ? "" : "; not by now: ", told_->failure())});
  if (body_->rest)
    parts.push_back({"condensed rest", body_->rest->bytes(),
                     fmt::format("{} parts, {} modes, {} vertices at the border, {} that tools reach",
                                 body_->rest->parts(), body_->rest->modes(), body_->rest->border(),
                                 body_->rest->vertices().size())});
  return parts;
}

}  // namespace palpate::sim
