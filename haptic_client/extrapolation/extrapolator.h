#pragma once
#include <cstdint>

#include "common/time.h"
#include "common/types.h"

namespace palpate::client {

/// What the simulation says, the triplet (t_n, P_n, F_n) of Picinbono and Lombardo (1999).
struct Sample {
  std::uint64_t number = 0;  ///< of the sample, from 1
  Time t{};                  ///< when the tool was at `p`, client clock
  Vec3 p = Vec3::Zero();     ///< tool position, m, world
  Vec3 f = Vec3::Zero();     ///< force on the tool there, N, world
};

/// Estimates the force between two samples. Haptic thread only; no allocation, lock or exception.
class Extrapolator {
 public:
  virtual ~Extrapolator() = default;
  /// A new sample; its time is later than that of the one before (the pipeline sees to it).
  virtual void update(const Sample& sample) noexcept = 0;
  /// Forgets all samples: what came before is too long ago to look back at.
  virtual void restart() noexcept = 0;
  /// Force (N, world) with the tool at `p` at time `t` >= that of the newest sample. Zero before the first
  /// sample.
  virtual Vec3 force(const Vec3& p, Time t) const noexcept = 0;
};

/// The two newest samples, which is all that the paper's laws know.
struct LastTwo {
  Sample newest, before;
  int count = 0;
  void push(const Sample& sample) noexcept {
    before = newest;
    newest = sample;
    if (count < 2) ++count;
  }
};

}  // namespace palpate::client
