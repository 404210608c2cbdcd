#include "sim_server/solvers/factor_policy.h"

namespace palpate::sim {
namespace {

constexpr double kSlow = 0.3;       // share of the residual before: an iteration that leaves more is slow
constexpr double kRounding = 1e-6;  // relative residual that may be rounding
constexpr double kNegligibleShare = 1e-3;  // of a negligible force: a residual that may be rounding
constexpr double kSameRounding = 2;        // of a known rounding: a residual that is the same rounding

}  // namespace

bool FactorPolicy::begin_step(int steps_before) {
  comparable_ = false;
  if (settings_.forgives && state_ == State::kWorn) state_ = State::kStale;
  const bool due = settings_.background && steps_before % settings_.refresh_steps == 0;
  if (!due || steps_before == exchanged_) return false;
  exchanged_ = steps_before;
  return true;
}

FactorPolicy::Decision FactorPolicy::decide(const Residual& residual, double previous, bool just_factored) {
  const double force = residual.relative * residual.force_scale;
  if (force <= kSameRounding * rounding_) return Decision::kStop;
  const State before = state_;
  if (!comparable_ || !(residual.relative > kSlow * previous)) {
    comparable_ = true;
    if (before != State::kWorn) state_ = just_factored ? State::kFresh : State::kStale;
    return Decision::kKeep;
  }
  if (before != State::kStale && is_rounding(residual)) {
    rounding_ = force;
    return Decision::kStop;
  }
  state_ = State::kWorn;
  if (settings_.background) return Decision::kKeep;
  return before == State::kStale ? Decision::kRefactor : Decision::kRefactorChecked;
}

bool FactorPolicy::is_rounding(const Residual& residual) const {
  return residual.relative <= kRounding ||
         residual.relative * residual.force_scale <= kNegligibleShare * settings_.negligible_force;
}

}  // namespace palpate::sim
