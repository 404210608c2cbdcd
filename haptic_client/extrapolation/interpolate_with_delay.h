#pragma once
#include <array>

#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// No extrapolation, but the line between samples, two periods late; Picinbono and Lombardo (1999) name it
/// and turn it down for its delay. With samples four or more deep,
///   F = the line through the samples at the time t - 2 T,  T = t_n - t_(n-1),
/// and the nearest sample where that lies outside them (so it is smooth for latencies up to T). Before four
/// samples: F_n. About 8 ns.
class InterpolateWithDelay : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override;
  void restart() noexcept override { count_ = 0; }
  Vec3 force(const Vec3& p, Time t) noexcept override;

 private:
  static constexpr std::size_t kDepth = 4;  // reaches back 3 T, for 2 T and a latency up to T
  std::array<Sample, kDepth> samples_{};    // newest first
  std::size_t count_ = 0;
};

}  // namespace palpate::client
