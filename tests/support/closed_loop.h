#pragma once
/// A device, the whole tick and an organ in one loop of virtual time: what a hand would feel, in a test.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "haptic_client/device/device.h"
#include "haptic_client/loop/pipeline.h"
#include "tests/support/random.h"

namespace palpate::test {

/// How the loop runs.
struct ClosedLoopSettings {
  double haptic_hz = 1000, sim_hz = 30;
  double delay_s = 0.035;  ///< from reading the tool to having its force
  double jitter_s = 0;     ///< of the delay: between nothing and so much more, seeded
  double loss = 0;         ///< share of samples that never arrive
  std::uint64_t seed = 1;
};

/// The organ is a function of the tool's place, with its tangent, and its surface out of contact.
class ClosedLoop {
 public:
  using Organ = std::function<client::Linearised(const Vec3& p_W)>;
  ClosedLoop(client::Device& device, client::Pipeline& pipeline, Organ organ,
             const ClosedLoopSettings& settings)
      : device_(device),
        pipeline_(pipeline),
        organ_(std::move(organ)),
        settings_(settings),
        random_(settings.seed) {}

  /// One tick; returns what was written.
  client::TickResult tick() {
    const double t = seconds();
    const Time now = from_seconds(1 + t);
    const client::DeviceReading reading = device_.read(now);
    const auto ready = std::find_if(on_the_way_.begin(), on_the_way_.end(),
                                    [&](const OnTheWay& next) { return next.ready <= now; });
    std::optional<protocol::ForceSample> arrived;
    if (ready != on_the_way_.end()) {
      arrived = ready->sample;
      on_the_way_.erase(ready);
    }
    const client::TickResult result = pipeline_.tick(reading, arrived ? &*arrived : nullptr);
    device_.write(result.f_D);
    if (static_cast<double>(steps_) / settings_.sim_hz <= t + 1e-9) {
      ++steps_;
      const double delay = settings_.delay_s + settings_.jitter_s * random_.between(0, 1);
      if (random_.between(0, 1) >= settings_.loss)
        on_the_way_.push_back({now + from_seconds(delay), answer(result.tool)});
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
  protocol::ForceSample answer(const protocol::ToolState& tool) const {
    using protocol::ForceSample;
    protocol::ForceSample sample{.number = steps_, .tool_t_ns = tool.t_ns, .p_W = tool.p_W};
    const client::Linearised here = organ_(tool.p_W);
    sample.f_W = here.f;
    if ((tool.flags & protocol::ToolState::kWantsHere) != 0) {
      sample.flags |= ForceSample::kHasHere;
      sample.here = on_the_wire(here);
    }
    if ((tool.flags & protocol::ToolState::kWantsAhead) != 0) {
      const Vec3 way = to_seconds(Time{tool.lead_ns}) * tool.v_W;
      sample.flags |= ForceSample::kHasAhead;
      sample.ahead_p_W = tool.p_W + (way.norm() > 2e-3 ? Vec3(2e-3 * way.normalized()) : way);
      const client::Linearised ahead = organ_(sample.ahead_p_W);
      sample.ahead_f_W = ahead.f;
      sample.ahead = on_the_wire(ahead);
    }
    return sample;
  }
  static protocol::Linearisation on_the_wire(const client::Linearised& l) {
    const Mat3& k = l.k;
    return {{k(0, 0), k(0, 1), k(0, 2), k(1, 1), k(1, 2), k(2, 2)}, l.normal, l.gap};
  }

  client::Device& device_;
  client::Pipeline& pipeline_;
  Organ organ_;
  ClosedLoopSettings settings_;
  Random random_;
  std::uint64_t ticks_ = 0, steps_ = 0;
  std::vector<OnTheWay> on_the_way_;
};

/// A wall that begins at y = 0 and pushes upwards (N/m).
inline ClosedLoop::Organ wall(double stiffness) {
  return [stiffness](const Vec3& p_W) {
    client::Linearised l{.p = p_W, .normal = {0, 1, 0}, .gap = std::max(p_W[1], 0.0)};
    l.f[1] = stiffness * std::max(-p_W[1], 0.0);
    l.k(1, 1) = -stiffness;
    return l;
  };
}

/// A wall as a sphere feels it on an elastic half-space (Hertz 1882): F = c depth^(3/2), with the c that
/// makes its slope `stiffness` (N/m) at `force` (N): F' = 3/2 c^(2/3) F^(1/3).
inline ClosedLoop::Organ hertz_wall(double stiffness, double force) {
  const double c = std::pow(stiffness / (1.5 * std::cbrt(force)), 1.5);
  return [c](const Vec3& p_W) {
    client::Linearised l{.p = p_W, .normal = {0, 1, 0}, .gap = std::max(p_W[1], 0.0)};
    const double depth = std::max(-p_W[1], 0.0);
    l.f[1] = c * std::pow(depth, 1.5);
    l.k(1, 1) = -1.5 * c * std::sqrt(std::max(depth, 2e-4));  // free: as it will be at 0.2 mm
    return l;
  };
}

}  // namespace palpate::test
