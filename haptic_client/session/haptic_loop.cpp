#include "haptic_client/session/haptic_loop.h"

#include <algorithm>

#include "common/clock.h"

namespace palpate::client {

HapticLoop::HapticLoop(Device& device, Pipeline& pipeline, HapticMailboxes& mailboxes,
                       Observation& observation, TelemetryMaker& telemetry, Time period)
    : device_(device),
      pipeline_(pipeline),
      mailboxes_(mailboxes),
      observation_(observation),
      telemetry_(telemetry),
      period_(period) {}

void HapticLoop::run(const std::stop_token& stop) noexcept {
  Time deadline = now(), last = deadline;
  while (!stop.stop_requested()) {
    sleep_until(deadline);
    const Time start = now();
    const auto late = static_cast<std::uint64_t>(std::max<Time::rep>((start - deadline) / period_, 0));
    deadline += static_cast<Time::rep>(late) * period_;
    stats_.missed += late;
    if (stats_.ticks > 0) stats_.period_ns.add((start - last).count());
    last = start;
    const TickResult result = tick();
    ++stats_.ticks;
    const Time took = now() - start;
    stats_.tick_ns.add(took.count());
    observation_.tick(result, took, late);
    report(result);
    publish_page(result);
    deadline += period_;
  }
  const bool at_rest = device_.stop();
  if (heartbeat != nullptr) heartbeat->end(at_rest);
}

void Arrivals::take(HapticMailboxes& mailboxes, Pipeline& pipeline) noexcept {
  fresh_ = mailboxes.force.read(sample_);
  for (count_ = 0; count_ < pages_.size() && mailboxes.pages.pop(pages_[count_]);) ++count_;
  pipeline.bound_pages(mailboxes.pages_hz.load(std::memory_order_relaxed));
}

TickResult HapticLoop::tick() noexcept {
  if (rearm.exchange(false, std::memory_order_relaxed)) pipeline_.rearm();
  if (protocol::Pointer pointer; mailboxes_.pointer.read(pointer))
    device_.aim(pipeline_.workspace().place_to_device(pointer.p_W), pointer.buttons);
  const DeviceReading reading = device_.read(now());
  arrivals_.take(mailboxes_, pipeline_);
  if (const protocol::ForceSample* const sample = arrivals_.sample())
    telemetry_.want((sample->flags & protocol::ForceSample::kRequestsTelemetry) != 0);
  const TickResult result = pipeline_.tick(reading, arrivals_.sample(), arrivals_.pages());
  device_.write(result.f_D);
  if (!mailboxes_.tool.push(result.tool)) ++stats_.unsent;
  mailboxes_.bell.ring();
  return result;
}

/// A message to a page is out of date by then, if the network thread has no room for it.
void HapticLoop::publish_page(const TickResult& result) noexcept {
  const protocol::Telemetry* published = telemetry_.tick(result, pipeline_, observation_, stats_.missed);
  if (published != nullptr && mailboxes_.telemetry.push(*published)) mailboxes_.bell.ring();
}

void HapticLoop::report(const TickResult& result) noexcept {
  ticks.store(stats_.ticks, std::memory_order_relaxed);
  missed.store(stats_.missed, std::memory_order_relaxed);
  newest_newton.store(result.f_D.norm(), std::memory_order_relaxed);
  newest_age_ns.store(pipeline_.age_ns(), std::memory_order_relaxed);
  if (heartbeat != nullptr) heartbeat->beat();
  law_newton.store(pipeline_.law_newton(), std::memory_order_relaxed);
  gain.store(pipeline_.passivity().gain(), std::memory_order_relaxed);
  paused.store(pipeline_.paused(), std::memory_order_relaxed);
  const std::optional<Doubt> why = pipeline_.doubt();
  doubt.store(why ? static_cast<int>(*why) : kNoDoubt, std::memory_order_relaxed);
  weak.store(pipeline_.rendered_fraction().weak(), std::memory_order_relaxed);
  fault.store(pipeline_.limiter().fault(), std::memory_order_relaxed);
}

}  // namespace palpate::client
