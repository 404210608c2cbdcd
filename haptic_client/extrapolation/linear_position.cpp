#include "haptic_client/extrapolation/linear_position.h"

#include <cmath>

namespace palpate::client {
namespace {
constexpr double kSamePlace = 1e-9;  // m
}

Vec3 LinearPosition::force(const Vec3& p, Time) noexcept {
  const auto& [newest, before, count] = samples_;
  const Vec3 d = newest.p - before.p;
  if (count < 2 || d.squaredNorm() < kSamePlace * kSamePlace || !p.allFinite()) return newest.f;
  const double along = (p - newest.p).dot(d) / d.squaredNorm();
  return newest.f + (ratio_ == Ratio::kSigned ? along : std::abs(along)) * (newest.f - before.f);
}

}  // namespace palpate::client
