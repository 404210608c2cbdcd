#include "haptic_client/extrapolation/linear_position.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
namespace {
constexpr double kSmallestStep = 20e-6;  // m: about what devices resolve
}

Vec3 LinearPosition::force(const Vec3& p, Time) noexcept {
  const auto& [newest, before, count] = samples_;
  const Vec3 d = newest.p - before.p;
  const double step = d.norm();
  if (count < 2 || !(step > 0) || !p.allFinite()) return newest.f;
  const double along = (p - newest.p).dot(d) / (step * std::max(step, kSmallestStep));
  return newest.f + (ratio_ == Ratio::kSigned ? along : std::abs(along)) * (newest.f - before.f);
}

}  // namespace palpate::client
