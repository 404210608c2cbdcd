#include "haptic_client/extrapolation/modal_steps.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
namespace {
constexpr double kLongestStep = 4e-3;  // s, of a free motion that relaxes
}

void ModalSteps::prepare(double h, const ModalSystem& system) noexcept {
  count_ = system.count;
  for (std::size_t k = 0; k < count_; ++k) {
    const ModeStep step = ModeStep::over(h, system.w[k], system.damping[k]);
    w2_[k] = system.w[k] * system.w[k];
    q_of_q_[k] = step.q_of_q, q_of_v_[k] = step.q_of_v, q_of_p_[k] = step.q_of_p;
    v_of_q_[k] = step.v_of_q, v_of_v_[k] = step.v_of_v, v_of_p_[k] = step.v_of_p;
  }
  series_ = SeriesStep::over(h, system.relaxations());
  for (std::size_t j = 0; j < system.terms; ++j) half_[j] = -std::expm1(-0.5 * h / system.series[j].time);
}

void ModalSteps::advance(ModalState& state, const ModalNumbers& p) const noexcept {
  auto& [q, v, z] = state;
  const auto terms = static_cast<std::size_t>(series_.count);
  ModalNumbers from = q, pulled = p;
  for (std::size_t j = 0; j < terms; ++j) {  // by where z is in the middle of the step
    for (std::size_t k = 0; k < count_; ++k)
      pulled[k] += w2_[k] * series_.fraction[j] * (z[j][k] + half_[j] * (q[k] - z[j][k]));
  }
  for (std::size_t k = 0; k < count_; ++k) {
    q[k] = q_of_q_[k] * from[k] + q_of_v_[k] * v[k] + q_of_p_[k] * pulled[k];
    v[k] = v_of_q_[k] * from[k] + v_of_v_[k] * v[k] + v_of_p_[k] * pulled[k];
  }
  for (std::size_t j = 0; j < terms; ++j) {
    for (std::size_t k = 0; k < count_; ++k) z[j][k] = series_.step[j].followed(z[j][k], from[k], q[k]);
  }
}

ModalState free_motion(ModalState state, double time, const ModalSystem& system) noexcept {
  const double steps = system.terms == 0 ? 1 : std::clamp(std::ceil(time / kLongestStep), 1.0, 100.0);
  ModalSteps step;
  step.prepare(time / steps, system);
  for (double i = 0; i < steps; ++i) step.advance(state, {});
  return state;
}

}  // namespace palpate::client
