#pragma once
#include <memory>
#include <vector>

#include "haptic_client/evaluation/followed_contact.h"
#include "haptic_client/evaluation/rendered_error.h"
#include "protocol/messages.h"

namespace palpate::client {

/// Laws scored side by side: as many as a page can show.
constexpr std::size_t kMaxLaws = protocol::Telemetry::kMostLaws;

/// A tick that waits until it is known which force was right then.
struct PastTick {
  PathTick path;
  Vec3 moved = Vec3::Zero();                   ///< until the next tick, m
  std::array<Vec3, kMaxLaws> force;            ///< of the scored laws, N, world
  std::optional<RenderedForce> rendered = {};  ///< none: no hand holds the tool, or nobody asks
  std::optional<Vec3> right = {};              ///< by a truth, N
  std::uint64_t number = 0;                    ///< from 0
};

/// The force that was right at a tick.
struct RightForce {
  Vec3 f, line;  ///< N: on the path really taken (`BetweenSamples`), and on the straight line in time
  ReferenceKind kind = ReferenceKind::kLine;
  bool outage = false;  ///< the samples around the tick are further apart than `kOutage`
};

/// The ticks since the newest sample, which wait for the next one: only then is it known which force was
/// right. A ring, of as long as an outage takes to be noticed three times; ticks that had to make room, as no
/// sample came for longer, are never judged, nor are those beside a sample that the server calls not settled.
/// Haptic thread; only the constructor and `follow_surface` allocate.
class PastTicks {
 public:
  explicit PastTicks(double rate_hz);
  /// Solves the contact at every tick from now on, 15 MB, 5 to 120 us a tick.
  void follow_surface(double rate_hz) { contact_ = std::make_unique<FollowedContact>(rate_hz); }

  /// A tick with the tool at `p_W` (m) at `t`, with the contact there, where it is followed.
  PathTick at(const Vec3& p_W, Time t) noexcept;
  /// The tick waits, after all others.
  void wait(const PastTick& tick) noexcept;
  /// A sample came; `now` is the tick that takes it. Gives each tick between the sample before and this one
  /// to `judge(const PastTick&, const RightForce&)`, in their order.
  template <class Judge>
  void take(const Sample& sample, const PathTick& now, Judge&& judge) noexcept;

  /// True from the first sample on.
  bool began() const noexcept { return newest_.number > 0; }
  /// Ticks with a rendered force that nothing can judge, as no sample came soon enough after them, or the
  /// next one was of another session.
  std::uint64_t unjudged() const noexcept { return unjudged_; }
  /// Ticks with a rendered force that nothing can judge, as a sample around them was not settled.
  std::uint64_t unsettled() const noexcept { return unsettled_; }
  /// After how many others a tick is judged at most, or never.
  static std::size_t longest_wait(double rate_hz);

 private:
  const PastTick& at(std::size_t i) const noexcept { return ring_[(first_ + i) % ring_.size()]; }
  void pop() noexcept {
    first_ = (first_ + 1) % ring_.size();
    --waiting_;
  }
  void drop() noexcept {
    unjudged_ += at(0).rendered ? 1 : 0;
    pop();
  }
  void drop_unsettled(Time until) noexcept {
    for (; waiting_ > 0 && at(0).path.t < until; pop()) unsettled_ += at(0).rendered ? 1 : 0;
  }

  std::vector<PastTick> ring_;
  std::size_t first_ = 0, waiting_ = 0;
  std::unique_ptr<FollowedContact> contact_;  // null: not followed
  Sample newest_;
  std::uint64_t unjudged_ = 0, unsettled_ = 0;
};

template <class Judge>
void PastTicks::take(const Sample& sample, const PathTick& now, Judge&& judge) noexcept {
  if (contact_) contact_->take(sample);
  const Sample before = std::exchange(newest_, sample);
  const bool connected = before.number > 0 && sample.number > before.number && sample.t > before.t;
  while (waiting_ > 0 && at(0).path.t < (connected ? before.t : sample.t)) drop();
  if (!connected) return;
  if (!before.settled || !sample.settled) return drop_unsettled(sample.t);
  BetweenSamples between(before, sample);
  std::size_t ready = 0;
  for (; ready < waiting_ && at(ready).path.t < sample.t; ++ready) between.add(at(ready).path);
  between.close(ready < waiting_ ? at(ready).path : now);
  for (; ready > 0; --ready) {
    const PastTick& tick = at(0);
    judge(tick, RightForce{.f = between.at(tick.path),
                           .line = between.line(tick.path.t),
                           .kind = between.kind(),
                           .outage = sample.t - before.t > kOutage});
    pop();
  }
}

}  // namespace palpate::client
