#pragma once
#include "haptic_client/evaluation/captured_session.h"

namespace palpate::client {

/// The ticks of a captured session at another rate: tick k stands at t_0 + k / rate, its pose on the line
/// between the captured poses around it, and it knows the samples and events that the captured tick before it
/// knew. After a gap of more than a second the count of time begins again at the tick behind it.
class Resampler {
 public:
  Resampler(CapturedSession& session, double rate_hz) : session_(session), rate_hz_(rate_hz) {}
  /// False at the end.
  bool next(CapturedTick& out);

 private:
  /// Goes on to the next captured tick; false when there is none.
  bool pass();

  CapturedSession& session_;
  double rate_hz_;
  std::uint64_t k_ = 0;
  std::optional<CapturedTick> before_, after_;    // around the tick to give
  std::optional<protocol::ForceSample> arrived_;  // known since the last tick given
  std::vector<protocol::SurfacePage> pages_;      // come since then
  std::uint16_t flags_ = 0;                       // of the ticks since then
  Time start_{};                                  // of the grid
  std::uint64_t start_k_ = 0;                     // the tick there
};

}  // namespace palpate::client
