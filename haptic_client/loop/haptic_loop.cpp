#include "haptic_client/loop/haptic_loop.h"

#include <algorithm>

#include "common/clock.h"

namespace palpate::client {

HapticLoop::HapticLoop(Device& device, Pipeline& pipeline, HapticMailboxes& mailboxes, double rate_hz,
                       std::size_t record_ticks)
    : device_(device),
      pipeline_(pipeline),
      mailboxes_(mailboxes),
      period_(std::max(from_seconds(1 / rate_hz), device.limits().min_period)),
      ring_(record_ticks) {}

void HapticLoop::run(const std::stop_token& stop) noexcept {
  Time deadline = now(), last = deadline;
  while (!stop.stop_requested()) {
    sleep_until(deadline);
    const Time start = now();
    if (const auto late = (start - deadline) / period_; late > 0) {
      stats_.missed += static_cast<std::uint64_t>(late);
      deadline += late * period_;
    }
    if (stats_.ticks > 0) stats_.period_ns.add((start - last).count());
    last = start;
    tick();
    ++stats_.ticks;
    stats_.tick_ns.add((now() - start).count());
    deadline += period_;
    ticks.store(stats_.ticks, std::memory_order_relaxed);
    missed.store(stats_.missed, std::memory_order_relaxed);
  }
  device_.write(Vec3::Zero());
}

void HapticLoop::tick() noexcept {
  if (rearm.exchange(false, std::memory_order_relaxed)) pipeline_.rearm();
  const DeviceReading reading = device_.read(now());
  protocol::ForceSample sample;
  const bool fresh = mailboxes_.force.read(sample);
  const TickResult result = pipeline_.tick(reading, fresh ? &sample : nullptr);
  device_.write(result.f_D);
  mailboxes_.tool.write(result.tool);
  mailboxes_.bell.ring();
  if (!ring_.empty()) {
    ring_[recorded_++ % ring_.size()] = {reading.t,
                                         result.tool.p_W,
                                         result.f_D,
                                         fresh,
                                         {sample.number, Time{sample.tool_t_ns}, sample.p_W, sample.f_W}};
  }
  newest_newton.store(result.f_D.norm(), std::memory_order_relaxed);
  newest_age_ns.store(pipeline_.age_ns(), std::memory_order_relaxed);
  fault.store(pipeline_.limiter().fault(), std::memory_order_relaxed);
}

std::vector<TickRecord> HapticLoop::record() const {
  std::vector<TickRecord> all;
  const std::uint64_t size = ring_.size(), first = recorded_ > size ? recorded_ - size : 0;
  for (std::uint64_t i = first; i < recorded_; ++i) all.push_back(ring_[i % size]);
  return all;
}

}  // namespace palpate::client
