#include "common/trajectory.h"

#include <algorithm>
#include <cmath>

#include "common/config.h"
#include "common/csv.h"
#include "common/error.h"

namespace palpate {
namespace {
constexpr double kClosed = 1e-3;         // m: how near the start a motion that repeats must end
constexpr double kFarthestOffset = 1e3;  // m
}  // namespace

TrajectorySettings read_trajectory_settings(const Config& section) {
  TrajectorySettings trajectory;
  trajectory.file = section.file("file");
  const auto names = section.texts("columns", 4, {trajectory.columns.begin(), trajectory.columns.end()});
  std::copy(names.begin(), names.end(), trajectory.columns.begin());
  trajectory.scale = section.number("scale", {1e-9, 1e9, "m per unit"}, trajectory.scale);
  trajectory.offset = section.vector("offset", {-kFarthestOffset, kFarthestOffset, "m"}, trajectory.offset);
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
  const double open = (p_.back() - p_.front()).norm();
  if (repeats_ && open > kClosed)
    fail(
        "{}: the motion ends {:.3g} mm from where it began, so that `repeat` would jump there; make it end "
        "within {:g} mm, or leave `repeat` out",
        settings.file.string(), 1e3 * open, 1e3 * kClosed);
}

Trajectory::Trajectory(std::vector<double> t_s, std::vector<Vec3> p, bool repeats)
    : t_(std::move(t_s)), p_(std::move(p)), repeats_(repeats) {}

Vec3 Trajectory::at(double t) const noexcept {
  if (t <= 0 || t_.size() == 1) return p_.front();
  if (t >= duration()) {
    if (!repeats_) return p_.back();
    t = std::fmod(t, duration());
  }
  const double time = t_.front() + t;
  const auto after = std::upper_bound(t_.begin(), t_.end(), time);
  if (after == t_.end()) return p_.back();
  const auto i = static_cast<std::size_t>(after - t_.begin());
  const double share = (time - t_[i - 1]) / (t_[i] - t_[i - 1]);
  return p_[i - 1] + share * (p_[i] - p_[i - 1]);
}

}  // namespace palpate
