#pragma once
#include <random>

#include "common/types.h"

namespace palpate::test {

/// Seeded draws, the same on every machine (std::uniform_real_distribution is not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  Vec3 vector(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
  std::uint64_t bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace palpate::test
