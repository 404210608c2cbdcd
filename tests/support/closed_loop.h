#pragma once
/// A device, the whole tick and an organ in one loop of virtual time: what a hand would feel, in a test.
#include <cstdint>
#include <deque>
#include <functional>

#include "haptic_client/device/device.h"
#include "haptic_client/loop/pipeline.h"

namespace palpate::test {

/// How the loop runs.
struct ClosedLoopSettings {
  double haptic_hz = 1000, sim_hz = 30;
  double delay_s = 0.035;  ///< from reading the tool to having its force
};

/// The organ is a function of the tool's place: force on the tool (N, world).
class ClosedLoop {
 public:
  using Organ = std::function<Vec3(const Vec3& p_W)>;
  ClosedLoop(client::Device& device, client::Pipeline& pipeline, Organ organ,
             const ClosedLoopSettings& settings)
      : device_(device), pipeline_(pipeline), organ_(std::move(organ)), settings_(settings) {}

  /// One tick; returns what was written.
  client::TickResult tick() {
    const double t = static_cast<double>(ticks_) / settings_.haptic_hz;
    const Time now = from_seconds(1 + t);
    const client::DeviceReading reading = device_.read(now);
    const bool arrives = !on_the_way_.empty() && on_the_way_.front().ready <= now;
    const auto arrived = arrives ? on_the_way_.front().sample : protocol::ForceSample{};
    if (arrives) on_the_way_.pop_front();
    const client::TickResult result = pipeline_.tick(reading, arrives ? &arrived : nullptr);
    device_.write(result.f_D);
    if (static_cast<double>(steps_) / settings_.sim_hz <= t + 1e-9) {
      ++steps_;
      on_the_way_.push_back({now + from_seconds(settings_.delay_s),
                             {.number = steps_,
                              .tool_t_ns = result.tool.t_ns,
                              .p_W = result.tool.p_W,
                              .f_W = organ_(result.tool.p_W)}});
    }
    ++ticks_;
    return result;
  }

  double seconds() const { return static_cast<double>(ticks_) / settings_.haptic_hz; }

 private:
  struct OnTheWay {
    Time ready;
    protocol::ForceSample sample;
  };
  client::Device& device_;
  client::Pipeline& pipeline_;
  Organ organ_;
  ClosedLoopSettings settings_;
  std::uint64_t ticks_ = 0, steps_ = 0;
  std::deque<OnTheWay> on_the_way_;
};

/// A wall that begins at y = 0 and pushes upwards (N/m).
inline ClosedLoop::Organ wall(double stiffness) {
  return [stiffness](const Vec3& p_W) { return Vec3(0, stiffness * std::max(-p_W[1], 0.0), 0); };
}

}  // namespace palpate::test
