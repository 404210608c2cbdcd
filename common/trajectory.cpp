#include "common/trajectory.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/log.h"

namespace palpate {
namespace {
constexpr double kClosed = 1e-3;  // m: how near the start a motion that repeats must end
}  // namespace

Trajectory::Trajectory(const TrajectorySettings& settings)
    : rows_(read_motion_rows(settings)), repeats_(settings.repeat) {
  const double open = (rows_.p.back() - rows_.p.front()).norm();
  if (repeats_ && open > kClosed)
    fail(
        "{}: the motion ends {:.3g} mm from where it began, so that `repeat` would jump there; make it end "
        "within {:g} mm, or leave `repeat` out",
        settings.file.string(), 1e3 * open, 1e3 * kClosed);
}

Trajectory::Trajectory(std::vector<double> t_s, std::vector<Vec3> p, bool repeats)
    : rows_{.t = std::move(t_s), .p = std::move(p)}, repeats_(repeats) {}

void Trajectory::log_source() const {
  log::info("{}", rows_.summary);
  for (const std::string& warning : rows_.warnings) log::warning("{}", warning);
}

/// `t` after the start, on the clock of the rows, between the first and the last.
double Trajectory::time_in_rows(double t) const noexcept {
  if (!(t > 0)) return rows_.t.front();
  if (t >= duration()) t = repeats_ && duration() > 0 ? std::fmod(t, duration()) : duration();
  return rows_.t.front() + t;
}

Trajectory::Between Trajectory::between(double t) const noexcept {
  const double time = time_in_rows(t);
  const auto after = std::ranges::upper_bound(rows_.t, time);
  if (after == rows_.t.begin()) return {0, 0};
  const auto i = static_cast<std::size_t>(after - rows_.t.begin()) - 1;
  if (after == rows_.t.end()) return {i, 0};
  return {i, (time - rows_.t[i]) / (rows_.t[i + 1] - rows_.t[i])};
}

std::uint16_t Trajectory::buttons_at(double t) const noexcept {
  return rows_.buttons.empty() ? 0 : rows_.buttons[between(t).row];
}

Vec3 Trajectory::at(double t) const noexcept {
  const auto [i, fraction] = between(t);
  if (i + 1 == rows_.p.size()) return rows_.p.back();
  return rows_.p[i] + fraction * (rows_.p[i + 1] - rows_.p[i]);
}

Quat Trajectory::orientation_at(double t) const noexcept {
  if (!turns()) return Quat::Identity();
  const auto [i, fraction] = between(t);
  return i + 1 == rows_.q.size() ? rows_.q.back() : rows_.q[i].slerp(fraction, rows_.q[i + 1]);
}

}  // namespace palpate
