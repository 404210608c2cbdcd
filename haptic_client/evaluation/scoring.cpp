#include "haptic_client/evaluation/scoring.h"

#include "common/error.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {
namespace {
/// A tick waits for the next sample (an outage at most) to be computed and to arrive (likewise).
constexpr double kLongestWait = 3 * to_seconds(kOutage);  // s
}  // namespace

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) noexcept {
  ticks += other.ticks;
  reference_squared += other.reference_squared;
  for (std::size_t i = 0; i < error.size(); ++i) error[i] += other.error[i];
  return *this;
}

Scoring::Scoring(const std::vector<std::string>& laws, double rate_hz, const std::string& where)
    : names_(laws) {
  if (laws.size() > kMaxLaws) fail("{}: at most {} laws can be scored, not {}", where, kMaxLaws, laws.size());
  force_.fill(Vec3::Zero());
  for (const std::string& name : laws) {
    laws_.emplace_back(find_row(extrapolators(), name, "method", where).make());
    tables_.emplace_back(rate_hz);
  }
  if (!laws.empty()) pending_.resize(static_cast<std::size_t>(kLongestWait * rate_hz) + 1);
}

Wants Scoring::wants() const noexcept {
  Wants all;
  for (const ForceEstimate& law : laws_) all |= law.wants();
  return all;
}

void Scoring::tick(const Vec3& p_W, Time t, const Sample* taken, ErrorSums& sums) noexcept {
  if (laws_.empty()) return;
  if (taken != nullptr) take(*taken, p_W, t, sums);
  for (std::size_t i = 0; i < laws_.size(); ++i) force_[i] = laws_[i].force(p_W, t);
  if (laws_.front().newest().number == 0) return;
  if (waiting_ == pending_.size()) {  // too old to be scored still
    first_ = (first_ + 1) % pending_.size();
    --waiting_;
  }
  pending_[(first_ + waiting_++) % pending_.size()] = {t, force_};
}

void Scoring::take(const Sample& sample, const Vec3& p_W, Time t, ErrorSums& sums) noexcept {
  const Sample before = laws_.front().newest();
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Vec3 old = laws_[i].force(p_W, t);
    laws_[i].take(sample, t);
    if (laws_[i].period() > Time::zero()) tables_[i].add_jump((laws_[i].force(p_W, t) - old).norm());
  }
  const bool connected = laws_.front().period() > Time::zero();
  for (; waiting_ > 0 && pending_[first_].t < sample.t; --waiting_) {
    if (connected && pending_[first_].t >= before.t) score(pending_[first_], before, sample, sums);
    first_ = (first_ + 1) % pending_.size();
  }
}

void Scoring::score(const Pending& tick, const Sample& before, const Sample& after,
                    ErrorSums& sums) noexcept {
  const double share = to_seconds(tick.t - before.t) / to_seconds(after.t - before.t);
  const Reference reference(before.f + share * (after.f - before.f));
  ++scored_;
  ++sums.ticks;
  sums.reference_squared += reference.norm * reference.norm;
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    tables_[i].add(tick.force[i], reference);
    sums.error[i] += (tick.force[i] - reference.f).norm();
  }
}

}  // namespace palpate::client
