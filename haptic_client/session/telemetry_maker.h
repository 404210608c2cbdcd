#pragma once
#include <string>

#include "haptic_client/evaluation/observation.h"
#include "haptic_client/pipeline/pipeline.h"

namespace palpate::client {

/// Makes `protocol::Telemetry` of what passes, some 30 times a second while the server wants it, for the page
/// that shows it; nothing else depends on it. Haptic thread, after the force was written; no allocation.
class TelemetryMaker {
 public:
  /// `device`, `law`: names. `motors`: whether the device has any. `rate_hz`: ticks a second.
  TelemetryMaker(const std::string& device, bool motors, const std::string& law, double rate_hz);

  void want(bool wanted) noexcept { wanted_ = wanted; }

  /// A tick gave `result`. `missed`: deadlines given up so far. Returns a message when one is complete, valid
  /// until the next call; else null. 15 ns on the mean, while nobody wants it 5 ns (`scripts/bench
  /// telemetry`: a thousand ticks).
  const protocol::Telemetry* tick(const TickResult& result, const Pipeline& pipeline,
                                  const Observation& observation, std::uint64_t missed) noexcept;

 private:
  static constexpr double kMessagesHz = 30;  // protocol/README.md, "Telemetry"
  void start_at(std::int64_t t_ns) noexcept;
  void add(const Vec3& rendered_W, const Scoring& scoring) noexcept;
  void complete(const TickResult& result, const Pipeline& pipeline, const Observation& observation,
                std::uint64_t missed) noexcept;
  void name_error(const Observation& observation) noexcept;

  std::string law_;
  std::uint64_t every_;  // ticks between two that are sent
  std::size_t ticks_;    // in a message
  bool wanted_ = false, began_ = false;
  std::int64_t last_ns_ = 0, start_ns_ = 0, longest_ns_ = 0, oldest_ns_ = 0;
  std::uint64_t seen_ = 0;  // ticks since the message before
  protocol::Telemetry next_, published_;
};

}  // namespace palpate::client
