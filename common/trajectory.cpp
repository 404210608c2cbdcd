#include "common/trajectory.h"

#include <algorithm>
#include <cmath>

#include "common/config.h"
#include "common/csv.h"
#include "common/error.h"
#include "common/units.h"

namespace palpate {
namespace {
constexpr double kClosed = 1e-3;  // m: how near the start a motion that repeats must end
}  // namespace

TrajectorySettings read_trajectory_settings(const Config& section) {
  TrajectorySettings trajectory;
  trajectory.file = section.file("file");
  const auto names = section.texts("columns", 4, {trajectory.columns.begin(), trajectory.columns.end()});
  std::ranges::copy(names, trajectory.columns.begin());
  trajectory.scale = section.number("scale", {1e-9, 1e9, "m per unit"}, trajectory.scale);
  trajectory.offset = section.vector("offset", {-kMaxCoordinate, kMaxCoordinate, "m"}, trajectory.offset);
  trajectory.repeat = section.flag("repeat", trajectory.repeat);
  section.reject_unknown();
  return trajectory;
}

Trajectory::Trajectory(const TrajectorySettings& settings) : repeats_(settings.repeat) {
  auto columns = read_csv_columns(settings.file, settings.columns);
  t_ = std::move(columns[0]);
  for (std::size_t i = 0; i < t_.size(); ++i) {
    if (i > 0 && t_[i] <= t_[i - 1]) {
      fail("{}: column {} must increase, but data row {} has {} after {}", settings.file.string(),
           settings.columns[0], i + 1, t_[i], t_[i - 1]);
    }
    p_.push_back(settings.offset +
                 settings.scale * settings.axes * Vec3(columns[1][i], columns[2][i], columns[3][i]));
  }
  if (CsvTable(settings.file).has(TrajectorySettings::kButtons)) {
    const std::vector<std::string> column{TrajectorySettings::kButtons};
    const auto values = read_csv_columns(settings.file, column);
    for (const double bits : values.front()) {
      if (!(bits >= 0 && bits <= 65535 && bits == std::floor(bits)))
        fail("{}: column {} holds {:g}; expected the bits of buttons, a whole number from 0 to 65535",
             settings.file.string(), TrajectorySettings::kButtons, bits);
      buttons_.push_back(static_cast<std::uint16_t>(bits));
    }
  }
  const double open = (p_.back() - p_.front()).norm();
  if (repeats_ && open > kClosed)
    fail(
        "{}: the motion ends {:.3g} mm from where it began, so that `repeat` would jump there; make it end "
        "within {:g} mm, or leave `repeat` out",
        settings.file.string(), 1e3 * open, 1e3 * kClosed);
}

Trajectory::Trajectory(std::vector<double> t_s, std::vector<Vec3> p, bool repeats)
    : t_(std::move(t_s)), p_(std::move(p)), repeats_(repeats) {}

/// `t` after the start, on the clock of the rows, between the first and the last.
double Trajectory::time_in_rows(double t) const noexcept {
  if (!(t > 0)) return t_.front();
  if (t >= duration()) t = repeats_ && duration() > 0 ? std::fmod(t, duration()) : duration();
  return t_.front() + t;
}

std::uint16_t Trajectory::buttons_at(double t) const noexcept {
  if (buttons_.empty()) return 0;
  const auto after = std::ranges::upper_bound(t_, time_in_rows(t));
  return buttons_[static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - t_.begin(), 1) - 1)];
}

Vec3 Trajectory::at(double t) const noexcept {
  const double time = time_in_rows(t);
  const auto after = std::ranges::upper_bound(t_, time);
  if (after == t_.begin()) return p_.front();
  if (after == t_.end()) return p_.back();
  const auto i = static_cast<std::size_t>(after - t_.begin());
  const double fraction = (time - t_[i - 1]) / (t_[i] - t_[i - 1]);
  return p_[i - 1] + fraction * (p_[i] - p_[i - 1]);
}

}  // namespace palpate
