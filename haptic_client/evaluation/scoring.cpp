#include "haptic_client/evaluation/scoring.h"

#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {
namespace {
/// A tick waits for the next sample (an outage at most) to be computed, and as long for it to arrive.
constexpr double kLongestWait = 3 * to_seconds(kOutage);  // s
}  // namespace

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) noexcept {
  ticks += other.ticks;
  reference_squared += other.reference_squared;
  for (std::size_t i = 0; i < error.size(); ++i) error[i] += other.error[i];
  return *this;
}

Scoring::Scoring(const std::vector<std::string>& laws, double rate_hz, const std::string& where, double blend,
                 const Truth* truth)
    : names_(laws), truth_(truth) {
  if (laws.size() > kMaxLaws) fail("{}: at most {} laws can be scored, not {}", where, kMaxLaws, laws.size());
  force_.fill(Vec3::Zero());
  for (const std::string& name : laws) {
    laws_.emplace_back(find_row(extrapolators(), name, "method", where).make(), blend);
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
  if (ticked_) {
    newest_.moved = p_W - place_;
    if (truth_ == nullptr) {
      wait(newest_);
    } else if (const auto right = truth_->at(newest_.t)) {
      score(newest_, *right, sums);
    }
  }
  if (taken != nullptr) take(*taken, p_W, t, sums);
  for (std::size_t i = 0; i < laws_.size(); ++i) force_[i] = laws_[i].force(p_W, t);
  ticked_ = laws_.front().newest().number > 0;
  ticks_ += ticked_ ? 1 : 0;
  for (std::size_t i = 0; ticked_ && i < laws_.size(); ++i) stand_ins_[i].add(laws_[i].stand_in());
  newest_ = {t, Vec3::Zero(), force_};
  place_ = p_W;
}

void Scoring::wait(const Pending& tick) noexcept {
  if (waiting_ == pending_.size()) {  // too old to be scored still
    first_ = (first_ + 1) % pending_.size();
    --waiting_;
  }
  pending_[(first_ + waiting_++) % pending_.size()] = tick;
}

void Scoring::take(const Sample& sample, const Vec3& p_W, Time t, ErrorSums& sums) noexcept {
  const Sample before = laws_.front().newest();
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Vec3 old = laws_[i].force(p_W, t);
    laws_[i].take(sample, p_W, t);
    if (laws_[i].period() > Time::zero()) tables_[i].add_jump((laws_[i].force(p_W, t) - old).norm());
  }
  const bool connected = laws_.front().period() > Time::zero();
  for (; waiting_ > 0 && pending_[first_].t < sample.t; --waiting_) {
    const Pending& tick = pending_[first_];
    if (connected && tick.t >= before.t) {
      const double share = to_seconds(tick.t - before.t) / to_seconds(sample.t - before.t);
      score(tick, before.f + share * (sample.f - before.f), sums);
    }
    first_ = (first_ + 1) % pending_.size();
  }
}

void Scoring::score(const Pending& tick, const Vec3& right, ErrorSums& sums) noexcept {
  const Reference reference(right);
  ++scored_;
  ++sums.ticks;
  sums.reference_squared += reference.norm * reference.norm;
  exchanged_ += std::abs(right.dot(tick.moved));
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Vec3 error = tick.force[i] - right;
    tables_[i].add(tick.force[i], reference);
    sums.error[i] += error.norm();
    excess_[i] += error.dot(tick.moved);
  }
}

}  // namespace palpate::client
