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
  for (const CapturedLink& link : longest->links) {
    if (link.scene) scene_ = link.scene;
  }
  CapturedSession session(file, static_cast<std::size_t>(longest - found.runs.begin()));
  for (CapturedTick tick; session.next(tick);) {
    if (!tick.arrived) continue;
    const Time t{tick.arrived->tool_t_ns};
    const bool flagged = (tick.arrived->flags & protocol::ForceSample::kFlagged) != 0;
    if (points_.empty() || t > points_.back().t)
      points_.push_back({t, tick.arrived->p_W, tick.arrived->f_W, flagged});
  }
  const double seconds = points_.size() < 2 ? 0 : to_seconds(points_.back().t - points_.front().t);
  rate_hz_ = seconds > 0 ? static_cast<double>(points_.size() - 1) / seconds : 0;
  if (rate_hz_ < kSlowest) {
    fail(
        "{}: has {:.4g} force samples a second, a truth has {:g} or more; make one with `sim_server record "
        "... --rate 2000 --plain`",
        file.string(), rate_hz_, kSlowest);
  }
  if (2 * flagged() > samples()) {
    fail(
        "{}: {} of its {} force samples are flagged: its server found no settled answer, so that they are no "
        "truth; record it at a higher --rate, or along a motion that the tissue can follow",
        file.string(), flagged(), samples());
  }
}

std::size_t Truth::flagged() const noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(points_, &Point::flagged));
}

std::optional<ForceJumps> Truth::snaps() const {
  SnapCounter counter(rate_hz_);
  for (const Point& point : points_) {
    if (!point.flagged) counter.add(point.f, point.t);
  }
  return counter.snaps();
}

/// Notes the sample before `t`; returns how much of the way to the next has gone by then.
std::optional<double> Truth::find(Time t) const noexcept {
  if (t < points_.front().t || t > points_.back().t) return {};
  if (points_[hint_].t > t) hint_ = 0;
  while (hint_ + 2 < points_.size() && points_[hint_ + 1].t <= t) ++hint_;
  return to_seconds(t - points_[hint_].t) / to_seconds(points_[hint_ + 1].t - points_[hint_].t);
}

std::optional<Vec3> Truth::at(Time t) const noexcept {
  const auto fraction = find(t);
  if (!fraction || points_[hint_].flagged || points_[hint_ + 1].flagged) return {};
  return points_[hint_].f + *fraction * (points_[hint_ + 1].f - points_[hint_].f);
}

std::optional<double> Truth::distance(const Vec3& p, Time t) const noexcept {
  const auto fraction = find(t);
  if (!fraction) return {};
  return (points_[hint_].p + *fraction * (points_[hint_ + 1].p - points_[hint_].p) - p).norm();
}

}  // namespace palpate::client
