// What clients are told of a tissue that is cut: parts of CuttableMotion.
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

}  // namespace palpate::sim
