#include "common/damped_mode.h"

#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// e^(-g t) cosh(r t) and e^(-g t) sinh(r t) / r with r^2 = g^2 - w^2 of either sign.
std::pair<double, double> decay(double w, double g, double time) noexcept {
  const double square = g * g - w * w, r = std::sqrt(std::abs(square));
  if (std::abs(r * time) < 1e-6) return {std::exp(-g * time), time * std::exp(-g * time)};
  if (square < 0)
    return {std::exp(-g * time) * std::cos(r * time), std::exp(-g * time) * std::sin(r * time) / r};
  const double slow = std::exp((r - g) * time), fast = std::exp(-(r + g) * time);
  return {0.5 * (slow + fast), 0.5 * (slow - fast) / r};
}

}  // namespace

ModeStep ModeStep::over(double time, double w, double damping) noexcept {
  const double g = 0.5 * damping;
  const auto [even, odd] = decay(w, g, time);
  ModeStep step;
  step.q_of_q = even + g * odd;
  step.q_of_v = odd;
  step.v_of_q = -w * w * odd;
  step.v_of_v = even - g * odd;
  step.q_of_p = (1 - step.q_of_q) / (w * w);
  step.v_of_p = odd;
  return step;
}

}  // namespace palpate
