#include "haptic_client/evaluation/truth.h"

#include <algorithm>

#include "common/error.h"
#include "haptic_client/evaluation/captured_session.h"

namespace palpate::client {
namespace {
constexpr double kSlowest = 200;  // Hz
}

Truth::Truth(const std::filesystem::path& file, const std::function<void(double fraction)>& progress) {
  const CaptureSurvey found = survey(file, progress);
  const auto longest =
      std::ranges::max_element(found.runs, [](const auto& a, const auto& b) { return a.ticks < b.ticks; });
  CapturedSession session(file, static_cast<std::size_t>(longest - found.runs.begin()));
  for (CapturedTick tick; session.next(tick);) {
    if (!tick.arrived) continue;
    const Time t{tick.arrived->tool_t_ns};
    if (points_.empty() || t > points_.back().t) points_.push_back({t, tick.arrived->f_W});
  }
  const double seconds = points_.size() < 2 ? 0 : to_seconds(points_.back().t - points_.front().t);
  rate_hz_ = seconds > 0 ? static_cast<double>(points_.size() - 1) / seconds : 0;
  if (rate_hz_ < kSlowest) {
    fail(
        "{}: has {:.4g} force samples a second, a truth has {:g} or more; make one with `sim_server record "
        "... --rate 2000 --plain`",
        file.string(), rate_hz_, kSlowest);
  }
}

std::optional<ForceJumps> Truth::snaps() const {
  SnapCounter counter(rate_hz_);
  for (const Point& point : points_) counter.add(point.f, point.t);
  return counter.snaps();
}

std::optional<Vec3> Truth::at(Time t) const noexcept {
  if (t < points_.front().t || t > points_.back().t) return {};
  if (points_[hint_].t > t) hint_ = 0;
  while (hint_ + 2 < points_.size() && points_[hint_ + 1].t <= t) ++hint_;
  const Point &before = points_[hint_], &after = points_[hint_ + 1];
  const double fraction = to_seconds(t - before.t) / to_seconds(after.t - before.t);
  return before.f + fraction * (after.f - before.f);
}

}  // namespace palpate::client
