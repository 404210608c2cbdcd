#pragma once
#include <array>
#include <cmath>
#include <numbers>

#include "protocol/messages.h"

namespace palpate::bench {

/// A hand that strokes a soft wall to and fro, 500 ticks a second, and the samples of a server that takes 16
/// ms to answer every 16th tick. It never comes to rest, leaves the wall or asks for more than the limiter
/// gives (0.2 to 1.7 N, below 20 N/s), so that every turn takes the same way through the program.
class Palpation {
 public:
  static constexpr double kRate = 500;                                   // Hz
  static constexpr std::size_t kTurn = 512, kPerSample = 16, kLate = 8;  // ticks

  Palpation() {
    const Vec3 middle(0, -0.002, 0), stroke(0.004, 0.0015, 0.003), aside(0.0003, -0.0002, 0.0002);  // m
    for (std::size_t i = 0; i < kTurn; ++i) {
      const double phi = 2 * std::numbers::pi * static_cast<double>(i) / kTurn;
      const double w = 2 * std::numbers::pi * kRate / kTurn;  // rad/s
      place_[i] = middle + std::cos(phi) * stroke + std::sin(phi) * aside;
      speed_[i] = w * (std::cos(phi) * aside - std::sin(phi) * stroke);
    }
  }

  /// Goes on to the next tick.
  void next() noexcept {
    const std::size_t k = tool_.tick++;
    tool_.t_ns = time_of(k);
    tool_.p_W = place_[k % kTurn];
    tool_.v_W = speed_[k % kTurn];
    fresh_ = k % kPerSample == kLate;
    if (fresh_) answer(k - kLate);
  }
  const protocol::ToolState& tool() const noexcept { return tool_; }
  /// The sample that arrives in this tick, or null.
  const protocol::ForceSample* arrived() const noexcept { return fresh_ ? &sample_ : nullptr; }

 private:
  static std::int64_t time_of(std::size_t k) noexcept {
    return static_cast<std::int64_t>(k + 1) * static_cast<std::int64_t>(1e9 / kRate);
  }
  /// The force for the tool of tick `k`: springs along the axes.
  void answer(std::size_t k) noexcept {
    ++sample_.number;
    sample_.tool_tick = k + 1;
    sample_.tool_t_ns = time_of(k);
    sample_.p_W = place_[k % kTurn];
    sample_.f_W = -Vec3(100, 450, 100).cwiseProduct(sample_.p_W);
    sample_.step_ns = 40'000;
    sample_.flags = protocol::ForceSample::kInContact;
    tool_.newest_sample = sample_.number;
  }

  std::array<Vec3, kTurn> place_, speed_;
  protocol::ToolState tool_;
  protocol::ForceSample sample_;
  bool fresh_ = false;
};

}  // namespace palpate::bench
