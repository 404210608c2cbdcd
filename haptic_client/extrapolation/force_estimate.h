#pragma once
#include <memory>

#include "common/ages.h"
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// An extrapolation law with what stands around every law alike, so that the rendered law and those that
/// only run beside it are treated the same: it sees each sample once and in order; when no sample has come
/// for three periods longer than usual, time turns for it and runs back to that of the newest one, as fast as
/// it ran on, and stands still there; it starts afresh after an outage; and where the newest sample saw the
/// tool free, there is no force (a law that looks back would go on pulling: sticky tissue), unless the law
/// knows where the surface is. Pure; haptic thread only; no allocation.
class ForceEstimate {
 public:
  /// `blend`: how long what a new sample changes, or a simpler law that stands in, takes to come in (time
  /// constant, s, 0 to 0.1); 0: at once.
  explicit ForceEstimate(std::unique_ptr<Extrapolator> law, double blend = 0)
      : law_(std::move(law)),
        sees_surface_(law_->request().at_tool || law_->request().ahead || law_->request().surface),
        blend_(blend) {}

  /// A sample is here at time `now`, with the tool at `p` (m). False, and nothing changes, unless it is
  /// finite, later than the newest and not from before the clock began or from the future.
  bool take(const Sample& sample, const Vec3& p, Time now) noexcept;

  /// Force (N, world) on a tool at `p` (m) at time `t` >= that of the newest sample.
  Vec3 force(const Vec3& p, Time t) noexcept;

  Request request() const noexcept { return law_->request(); }
  bool stepped_down() const noexcept { return law_->stepped_down(); }
  std::string_view substitute() const noexcept { return law_->substitute(); }
  /// Number 0: none yet.
  const Sample& newest() const noexcept { return newest_; }
  /// Between the two newest samples; 0 with less than two since the last outage.
  Time period() const noexcept { return period_; }

 private:
  static constexpr int kPatience = 3;   // periods
  static constexpr int kAgeFilter = 8;  // samples
  std::unique_ptr<Extrapolator> law_;
  Vec3 law_force(const Vec3& p, Time t) noexcept;
  Time law_time(Time t) const noexcept;
  Vec3 blended(const Vec3& f, Time t) noexcept;
  void blend_from(const Vec3& before, const Vec3& after, Time t) noexcept;

  bool sees_surface_;
  double blend_;                // s
  Vec3 offset_ = Vec3::Zero();  // what the newest sample, or a simpler law that stands in, took away, N
  Time changed_{};              // when it did
  double began_ = 0;            // the force of the law then, N
  Vec3 last_ = Vec3::Zero();    // force given, N
  bool stepped_down_ = false;
  Sample newest_;
  Time period_{};
  Time usual_age_{};  // of a sample that arrives, filtered
};

}  // namespace palpate::client
