#include "sim_server/solvers/factor_policy.h"

namespace palpate::sim {
namespace {

constexpr int kMostFactors = 3;  // on demand, in a step
constexpr double kSlowConvergence =
    0.3;                            // share of the residual before: an iteration that leaves more is slow
constexpr double kRounding = 1e-6;  // relative residual that may be rounding
constexpr double kNegligibleFraction = 1e-3;  // of a negligible force: a residual that may be rounding
constexpr double kSameRounding = 2;           // of a known rounding: a residual that is the same rounding

}  // namespace

bool FactorPolicy::start(int steps_before, bool damped, bool unbalanced) {
  comparable_ = false;
  demanded_ = 0;
  damped_ = damped;
  if (state_ == State::kOutdated) state_ = State::kStale;
  const bool due = settings_.background && (unbalanced || steps_before % settings_.refresh_steps == 0);
  if (!due || steps_before == exchanged_) return false;
  exchanged_ = steps_before;
  return true;
}

FactorPolicy::Decision FactorPolicy::decide(const Residual& residual, double previous, bool just_factored) {
  const double force = residual.relative * residual.force_scale;
  // Learnt under large forces, it is a large residual under small ones.
  if (force <= kSameRounding * rounding_ && is_rounding(residual, kSameRounding)) return Decision::kStop;
  const State before = state_;
  if (!comparable_ || !(residual.relative > kSlowConvergence * previous)) {
    comparable_ = true;
    if (before != State::kOutdated) state_ = just_factored ? State::kFresh : State::kStale;
    return Decision::kKeep;
  }
  if (before != State::kStale && is_rounding(residual)) {
    rounding_ = force;
    return Decision::kStop;
  }
  const bool another = damped_ || demanded_ < kMostFactors;
  if (settings_.background || before == State::kOutdated || !another) {
    state_ = State::kOutdated;
    return Decision::kKeep;
  }
  ++demanded_;
  state_ = State::kFresh;
  return before == State::kStale ? Decision::kRefactor : Decision::kRefactorChecked;
}

bool FactorPolicy::is_rounding(const Residual& residual, double times) const {
  return residual.relative <= times * kRounding ||
         residual.relative * residual.force_scale <= times * kNegligibleFraction * settings_.negligible_force;
}

}  // namespace palpate::sim
