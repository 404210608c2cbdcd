#include "haptic_client/evaluation/scoring.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {
namespace {
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
    : names_(laws), past_(rate_hz), rendered_(rate_hz), rate_hz_(rate_hz), truth_(truth) {
  if (laws.size() > kMaxLaws) fail("{}: at most {} laws can be scored, not {}", where, kMaxLaws, laws.size());
  force_.fill(Vec3::Zero());
  for (const std::string& name : laws) {
    laws_.emplace_back(find_row(extrapolators(), name, "method", where).make(), blend);
    tables_.emplace_back(rate_hz);
    paper_.emplace_back(rate_hz);
  }
  if (truth == nullptr && request().surface) past_.follow_surface(rate_hz);
  newly_scored_.reserve(PastTicks::longest_wait(rate_hz) + 1);
}

Request Scoring::request() const noexcept {
  Request all;
  for (const ForceEstimate& law : laws_) all |= law.request();
  return all;
}

void Scoring::judge_between_samples() {
  if (truth_ == nullptr || laws_.empty()) return;
  own_.emplace(rate_hz_);
  if (request().surface) past_.follow_surface(rate_hz_);
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

void Scoring::tick(const Vec3& p_W, Time t, const Sample* taken, ErrorSums& sums,
                   const std::optional<RenderedForce>& rendered) noexcept {
  if (taken != nullptr) jumps_.add(published_force(*taken));
  newly_scored_.clear();
  const PathTick path = past_.at(p_W, t);
  if (ticked_) {
    newest_.moved = p_W - place_;
    if (truth_ != nullptr) newest_.right = truth_->at(newest_.path.t);
    if (newest_.right) score(newest_, *newest_.right, sums);
    past_.wait(newest_);
  }
  if (taken != nullptr) take(*taken, path, sums);
  for (std::size_t i = 0; i < laws_.size(); ++i) force_[i] = laws_[i].force(p_W, t);
  ticked_ = past_.began();
  ticks_ += ticked_ ? 1 : 0;
  for (std::size_t i = 0; ticked_ && i < laws_.size(); ++i) substitutes_[i].add(laws_[i].substitute());
  newest_ = {.path = path, .force = force_, .rendered = rendered, .number = number_++};
  place_ = p_W;
}

void Scoring::take(const Sample& sample, const PathTick& now, ErrorSums& sums) noexcept {
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Vec3 old = laws_[i].force(now.p, now.t);
    laws_[i].take(sample, now.p, now.t);
    if (laws_[i].period() > Time::zero()) tables_[i].add_jump((laws_[i].force(now.p, now.t) - old).norm());
  }
  past_.take(sample, now, [&](const PastTick& tick, const RightForce& right) { judge(tick, right, sums); });
}

void Scoring::judge(const PastTick& tick, const RightForce& right, ErrorSums& sums) noexcept {
  if (truth_ == nullptr) {
    if (tick.rendered) rendered_.add(*tick.rendered, ReferenceForce(right.f, tick.path.t), right.outage);
    newly_scored_.push_back({tick.number, right.f});
  }
  if (right.outage) return;
  const ReferenceForce line(right.line, tick.path.t);
  for (std::size_t i = 0; i < laws_.size(); ++i) paper_[i].add(tick.force[i], line);
  ++between_[static_cast<std::size_t>(right.kind)];
  if (truth_ == nullptr) score(tick, right.f, sums);
  if (own_ && tick.right) own_->add(right.f, ReferenceForce(*tick.right, tick.path.t));
}

void Scoring::score(const PastTick& tick, const Vec3& right, ErrorSums& sums) noexcept {
  const ReferenceForce reference(right, tick.path.t);
  if (truth_ != nullptr) newly_scored_.push_back({tick.number, right});
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
