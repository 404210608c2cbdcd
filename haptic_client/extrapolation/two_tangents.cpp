#include "haptic_client/extrapolation/two_tangents.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kShortestPath = 10e-6;  // m
}

void TwoTangents::update(const Sample& sample) noexcept {
  first_.update(sample);
  if (!usable(sample) || (newest_.number > 0 && sample.t <= newest_.t)) return;
  newest_ = with_usable_parts(sample);
  motion_.update(newest_);
  if (newest_.ahead) newest_.ahead->tangent = restoring_part(newest_.ahead->tangent);
}

void TwoTangents::restart() noexcept {
  first_.restart();
  newest_ = {};
  motion_.restart();
}

Vec3 TwoTangents::force(const Vec3& p, Time t) noexcept {
  const Vec3 near = first_.force(p, t);
  if (!newest_.ahead || !newest_.at_tool) return near;
  const Vec3 relative = p - motion_.since_sample(t);  // where the organ stood at t_n
  const Vec3 d = newest_.ahead->p_W - newest_.p;
  const double along = (relative - newest_.p).dot(d) / (d.squaredNorm() + kShortestPath * kShortestPath);
  if (!(along > 0)) return near;
  const double s = std::min(along, 1.0), w = s * s * (3 - 2 * s);
  return (1 - w) * near + w * force_at(*newest_.ahead, relative);
}

}  // namespace palpate::client
