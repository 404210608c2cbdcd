#include "haptic_client/evaluation/scoring.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {
namespace {
/// A tick waits for the next sample (an outage at most) to be computed, and as long for it to arrive.
constexpr double kLongestWait = 3 * to_seconds(kOutage);  // s

PublishedForce published_force(const Sample& sample) noexcept {
  PublishedForce force{.number = sample.number,
                       .t = sample.t,
                       .p = sample.p,
                       .f = sample.f,
                       .surface_v = sample.surface_v,
                       .cuts = sample.cuts};
  if (sample.at_tool && usable(*sample.at_tool)) force.tangent = sample.at_tool->tangent;
  return force;
}
}  // namespace

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) noexcept {
  contact += other.contact;
  reference_squared += other.reference_squared;
  for (std::size_t i = 0; i < error.size(); ++i) error[i] += other.error[i];
  return *this;
}

Scoring::Scoring(const std::vector<std::string>& laws, double rate_hz, const std::string& where, double blend,
                 const Truth* truth)
    : names_(laws), rate_hz_(rate_hz), truth_(truth) {
  if (laws.size() > kMaxLaws) fail("{}: at most {} laws can be scored, not {}", where, kMaxLaws, laws.size());
  force_.fill(Vec3::Zero());
  for (const std::string& name : laws) {
    laws_.emplace_back(find_row(extrapolators(), name, "method", where).make(), blend);
    tables_.emplace_back(rate_hz);
    paper_.emplace_back(rate_hz);
  }
  if (truth == nullptr && request().surface) contact_ = std::make_unique<FollowedContact>(rate_hz);
  if (laws.empty()) return;
  pending_.resize(longest_wait(rate_hz));
  newly_scored_.reserve(pending_.size() + 1);
}

std::size_t Scoring::longest_wait(double rate_hz) {
  return static_cast<std::size_t>(kLongestWait * rate_hz) + 1;
}

Request Scoring::request() const noexcept {
  Request all;
  for (const ForceEstimate& law : laws_) all |= law.request();
  return all;
}

void Scoring::judge_between_samples() {
  if (truth_ == nullptr || laws_.empty()) return;
  own_.emplace(rate_hz_);
  if (request().surface) contact_ = std::make_unique<FollowedContact>(rate_hz_);
}

ErrorMetrics Scoring::metrics(std::size_t law) const noexcept {
  ErrorMetrics m = tables_[law].metrics();
  const ErrorMetrics line = paper_[law].metrics();
  m.paper_mean_percent = line.paper_mean_percent;
  m.paper_max_percent = line.paper_max_percent;
  m.paper_max_force_percent = line.paper_max_force_percent;
  return m;
}

ReferenceKind Scoring::mostly_between() const noexcept {
  const auto most = std::ranges::max_element(between_);
  return static_cast<ReferenceKind>(most - between_.begin());
}

void Scoring::tick(const Vec3& p_W, Time t, const Sample* taken, ErrorSums& sums) noexcept {
  if (taken != nullptr) jumps_.add(published_force(*taken));
  if (laws_.empty()) return;
  newly_scored_.clear();
  PathTick path{t, p_W};
  if (contact_) path.contact = contact_->follow(p_W, t);
  if (ticked_) {
    newest_.moved = p_W - place_;
    if (truth_ != nullptr) newest_.right = truth_->at(newest_.path.t);
    if (newest_.right) score(newest_, *newest_.right, sums);
    wait(newest_);
  }
  if (taken != nullptr) take(*taken, path, sums);
  for (std::size_t i = 0; i < laws_.size(); ++i) force_[i] = laws_[i].force(p_W, t);
  ticked_ = laws_.front().newest().number > 0;
  ticks_ += ticked_ ? 1 : 0;
  for (std::size_t i = 0; ticked_ && i < laws_.size(); ++i) substitutes_[i].add(laws_[i].substitute());
  newest_ = {path, Vec3::Zero(), force_, {}, number_++};
  place_ = p_W;
}

void Scoring::wait(const Pending& tick) noexcept {
  if (waiting_ == pending_.size()) {  // too old to be scored still
    first_ = (first_ + 1) % pending_.size();
    --waiting_;
  }
  pending_[(first_ + waiting_++) % pending_.size()] = tick;
}

void Scoring::take(const Sample& sample, const PathTick& now, ErrorSums& sums) noexcept {
  const Sample before = laws_.front().newest();
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Vec3 old = laws_[i].force(now.p, now.t);
    laws_[i].take(sample, now.p, now.t);
    if (laws_[i].period() > Time::zero()) tables_[i].add_jump((laws_[i].force(now.p, now.t) - old).norm());
  }
  if (contact_) contact_->take(sample);
  const bool connected = laws_.front().period() > Time::zero();
  for (; waiting_ > 0 && pending(0).path.t < (connected ? before.t : sample.t); --waiting_)
    first_ = (first_ + 1) % pending_.size();
  if (connected) score_between(before, sample, now, sums);
}

/// All that waits is of the time from `before` on; `now` is the tick after it.
void Scoring::score_between(const Sample& before, const Sample& after, const PathTick& now,
                            ErrorSums& sums) noexcept {
  BetweenSamples between(before, after);
  std::size_t ready = 0;
  for (; ready < waiting_ && pending(ready).path.t < after.t; ++ready) between.add(pending(ready).path);
  between.close(ready < waiting_ ? pending(ready).path : now);
  for (; ready > 0; --ready) {
    const Pending& tick = pending(0);
    const ReferenceForce line(between.line(tick.path.t), tick.path.t);
    for (std::size_t i = 0; i < laws_.size(); ++i) paper_[i].add(tick.force[i], line);
    const Vec3 f = between.at(tick.path);
    ++between_[static_cast<std::size_t>(between.kind())];
    if (truth_ == nullptr) score(tick, f, sums);
    if (own_ && tick.right) own_->add(f, ReferenceForce(*tick.right, tick.path.t));
    first_ = (first_ + 1) % pending_.size();
    --waiting_;
  }
}

void Scoring::score(const Pending& tick, const Vec3& right, ErrorSums& sums) noexcept {
  const ReferenceForce reference(right, tick.path.t);
  newly_scored_.push_back({tick.number, right});
  ++scored_;
  sums.contact += reference.norm > 0 ? 1 : 0;
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
