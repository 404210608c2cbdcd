#include "common/motion_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/ranges.h>

#include "common/config.h"
#include "common/csv.h"
#include "common/error.h"
#include "common/units.h"

namespace palpate {
namespace {

constexpr std::size_t kRecording = 20;  // rows: fewer are corners of a path that somebody wrote
constexpr double kUsualGaps = 10;       // times the median interval: the longest accepted
constexpr double kUsualSteps = 10;      // times the usual step: there and back is no motion
constexpr double kLongestAway = 0.5;    // s: a tool that leaps and stays for longer is believed
// A reach of 0.3 m in 0.3 s peaks at 1.9 m/s and 19 m/s^2 (minimum jerk: Flash and Hogan 1985); twice that.
constexpr double kHandAcceleration = 40;  // m/s^2
constexpr double kTremor = 1e-3;          // m: shorter leaps are noise, which hardly changes a force
constexpr double kFastest = 10;           // m/s: a hand that throws
constexpr double kSlowRows = 0.5, kLongMotion = 3600;  // s: of rows, and of a motion, in another unit
constexpr double kUnitError = 0.05;                    // of the length of a quaternion: rounding is less
constexpr const char* kButtons = "buttons";
const std::array<std::string, 4> kOrientation{"qw", "qx", "qy", "qz"};

/// Unit that a name of a column ends with.
struct NamedUnit {
  const char* ending;
  double in_si;
};
constexpr std::array<NamedUnit, 4> kTimes{{{"_s", 1}, {"_ms", 1e-3}, {"_us", 1e-6}, {"_ns", 1e-9}}};
constexpr std::array<NamedUnit, 2> kLengths{{{"_m", 1}, {"_mm", 1e-3}}};

template <class Units>
std::optional<double> unit_in(const std::string& name, const Units& units) {
  for (const NamedUnit& unit : units) {
    if (name.ends_with(unit.ending)) return unit.in_si;
  }
  return {};
}

/// Returns the first of the names of a quantity, with a unit each, that the table has; the one in SI if none.
template <class Units>
std::string usual_name(const CsvTable& table, const std::string& quantity, const Units& units) {
  for (const NamedUnit& unit : units) {
    if (table.has(quantity + unit.ending)) return quantity + unit.ending;
  }
  return quantity + units.front().ending;
}

/// A motion as it is read, and what it was read from.
class MotionReader {
 public:
  explicit MotionReader(const TrajectorySettings& settings);
  MotionRows read();

 private:
  void choose_columns();
  double length_unit() const;
  void read_times();
  void read_places();
  void read_orientation();
  void read_buttons();
  void refuse_wrong_unit_of_time() const;
  void refuse_gaps() const;
  std::optional<double> usual_step() const;
  std::optional<std::size_t> row_of_return(std::size_t first, double usual) const;
  bool is_leap(std::size_t i, double usual) const;
  void refuse_rows(std::size_t first, std::size_t back, double usual) const;
  void judge_leaps();
  void refuse_speeds() const;
  void note_irregular_rows();
  std::string summary() const;
  std::string sources() const;

  std::size_t rows() const { return table_.rows(); }
  bool is_recording() const { return rows() >= kRecording; }
  double interval(std::size_t i) const { return rows_.t[i] - rows_.t[i - 1]; }
  /// Length of the step to row `i`, m, world.
  double step(std::size_t i) const { return settings_.frame.scale * (rows_.p[i] - rows_.p[i - 1]).norm(); }
  double step_or_none(std::size_t i) const { return i > 0 && i < rows() ? step(i) : 0; }
  double acceleration(std::size_t i) const;

  const TrajectorySettings& settings_;
  CsvTable table_;
  std::string time_;                   // name of its column; empty: none
  std::vector<std::string> position_;  // names of its columns
  bool turns_ = false, presses_ = false;
  MotionRows rows_{};
  double usual_interval_ = 0;  // s, median
};

MotionReader::MotionReader(const TrajectorySettings& settings)
    : settings_(settings), table_(settings.file), presses_(table_.has(kButtons)) {
  choose_columns();
  turns_ = std::ranges::any_of(kOrientation, [&](const std::string& name) { return table_.has(name); });
}

void MotionReader::choose_columns() {
  position_ = settings_.columns;
  if (position_.empty()) {
    for (const char* const axis : {"x", "y", "z"}) position_.push_back(usual_name(table_, axis, kLengths));
    time_ = usual_name(table_, "t", kTimes);
    if (settings_.rate_hz && table_.has(time_))
      fail("{}: has a column {}, so that `rate_hz` would say its times twice; leave `rate_hz` out",
           table_.where_names(), time_);
    if (settings_.rate_hz) time_.clear();
    if (!settings_.rate_hz && !table_.has(time_))
      fail(
          "{}: no column t_s, t_ms, t_us or t_ns; in the [trajectory] of a client file `columns` names the "
          "column of time, or `rate_hz` gives the rows a second; known: {}",
          table_.where_names(), fmt::join(table_.names(), ", "));
  } else if (!settings_.rate_hz) {
    time_ = position_.front();
    position_.erase(position_.begin());
  }
}

/// Returns m per unit of the position columns.
double MotionReader::length_unit() const {
  if (settings_.scale) return *settings_.scale;
  const double unit = unit_in(position_.front(), kLengths).value_or(1);
  for (const std::string& name : position_) {
    if (unit_in(name, kLengths).value_or(1) != unit)
      fail("{}: columns {} and {} have different units; give all positions one, and its metres as `scale`",
           table_.where_names(), position_.front(), name);
  }
  return unit;
}

void MotionReader::read_times() {
  if (time_.empty()) {
    for (std::size_t i = 0; i < rows(); ++i) rows_.t.push_back(static_cast<double>(i) / *settings_.rate_hz);
  } else {
    const std::array names{time_};
    rows_.t = std::move(table_.columns(names).front());
    const double unit = settings_.time_scale.value_or(unit_in(time_, kTimes).value_or(1));
    for (std::size_t i = 0; i < rows(); ++i) {
      if (i > 0 && rows_.t[i] * unit <= rows_.t[i - 1])
        fail("{}: column {} must increase, but row {} has {} s after {} s", table_.where(i), time_, i + 1,
             rows_.t[i] * unit, rows_.t[i - 1]);
      rows_.t[i] *= unit;
    }
  }
  std::vector<double> intervals;
  for (std::size_t i = 1; i < rows(); ++i) intervals.push_back(interval(i));
  std::ranges::sort(intervals);
  if (!intervals.empty()) usual_interval_ = intervals[intervals.size() / 2];
}

void MotionReader::read_places() {
  const auto columns = table_.columns(position_);
  const Workspace& frame = settings_.frame;
  const double scale = length_unit() / frame.scale;
  const Vec3 offset = frame.motion_to_device(settings_.offset - frame.offset_W);
  const Mat3 axes = frame.axes.transpose() * settings_.axes;
  for (std::size_t i = 0; i < rows(); ++i)
    rows_.p.push_back(offset + scale * axes * Vec3(columns[0][i], columns[1][i], columns[2][i]));
}

void MotionReader::read_orientation() {
  if (!turns_) return;
  const auto columns = table_.columns(kOrientation);
  const Quat axes(Mat3(settings_.frame.axes.transpose() * settings_.axes));
  for (std::size_t i = 0; i < rows(); ++i) {
    Quat q(columns[0][i], columns[1][i], columns[2][i], columns[3][i]);
    if (!(std::abs(q.norm() - 1) <= kUnitError))
      fail("{}: the quaternion qw, qx, qy, qz of row {} has length {:.3g}; expected 1 within {:g}",
           table_.where(i), i + 1, q.norm(), kUnitError);
    q = axes * q.normalized();
    if (i > 0 && q.dot(rows_.q.back()) < 0) q.coeffs() *= -1;  // the same turn, the short way
    rows_.q.push_back(q);
  }
}

void MotionReader::read_buttons() {
  if (!presses_) return;
  const std::array<std::string, 1> names{kButtons};
  const auto values = std::move(table_.columns(names).front());
  for (std::size_t i = 0; i < rows(); ++i) {
    const double bits = values[i];
    if (!(bits >= 0 && bits <= 65535 && bits == std::floor(bits)))
      fail("{}: column {} holds {:g}; expected the bits of buttons, a whole number from 0 to 65535",
           table_.where(i), kButtons, bits);
    rows_.buttons.push_back(static_cast<std::uint16_t>(bits));
  }
}

/// A recording whose rows come once a second, or that lasts hours, has its times in another unit.
void MotionReader::refuse_wrong_unit_of_time() const {
  const double lasts = rows_.t.back() - rows_.t.front();
  if (!is_recording() || settings_.time_scale || settings_.rate_hz) return;
  if (usual_interval_ < kSlowRows && lasts <= kLongMotion) return;
  fail(
      "{}: {} rows of column {} last {:g} s, one every {:g} s, as milliseconds read as seconds do; name the "
      "column t_ms, or set `time_scale = 1e-3` in the [trajectory] of a client file (1 if they are seconds)",
      table_.where_names(), rows(), time_, lasts, usual_interval_);
}

void MotionReader::refuse_gaps() const {
  if (!is_recording() && !settings_.gap) return;
  const double longest_accepted = settings_.gap.value_or(kUsualGaps * usual_interval_);
  std::size_t worst = 1, found = 0;
  for (std::size_t i = 1; i < rows(); ++i) {
    if (interval(i) > interval(worst)) worst = i;
    if (interval(i) > longest_accepted) ++found;
  }
  if (found == 0) return;
  const double gap = interval(worst);
  fail(
      "{}: a hole of {:.3g} s at {:.6g} s{}: no rows, which come every {:.3g} s; fill it, or accept it by "
      "`gap = {:.2g}` in the [trajectory] of a client file",
      table_.where(worst), gap, rows_.t[worst - 1],
      found == 1 ? "" : fmt::format(", the longest of {}", found), usual_interval_, 1.1 * gap);
}

/// Returns a step that 95 % of those that move do not exceed, m; none where nothing moves.
std::optional<double> MotionReader::usual_step() const {
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows(); ++i) {
    if (step(i) > 0) steps.push_back(step(i));
  }
  if (steps.empty()) return {};
  const auto usual =
      steps.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(steps.size() - 1));
  std::ranges::nth_element(steps, usual);
  return *usual;
}

/// Acceleration by the steps to row `i` and from it, m/s^2: a mean over both, so that the motion between the
/// rows reached it. 0 at either end.
double MotionReader::acceleration(std::size_t i) const {
  if (i == 0 || i + 1 >= rows()) return 0;
  const Vec3 before = (rows_.p[i] - rows_.p[i - 1]) / interval(i);
  const Vec3 after = (rows_.p[i + 1] - rows_.p[i]) / interval(i + 1);
  return settings_.frame.scale * 2 * (after - before).norm() / (interval(i) + interval(i + 1));
}

/// Returns the row that ends an excursion which begins at row `first`: with it the motion is back where usual
/// steps, or a tenth of the leap, would have led. A leap leads there and a leap back, each of half the
/// farthest distance at least, and twice as long as the steps around, as no fast motion of several rows has.
/// None where the tool stays away.
std::optional<std::size_t> MotionReader::row_of_return(std::size_t first, double usual) const {
  double farthest = step(first);
  for (std::size_t i = first + 1; i < rows(); ++i) {
    if (i > first + 1 && rows_.t[i] - rows_.t[first - 1] > kLongestAway) return {};
    const double across = settings_.frame.scale * (rows_.p[i] - rows_.p[first - 1]).norm();
    const double leap = std::min(step(first), step(i));
    const double way = std::max(leap / kUsualSteps, usual * static_cast<double>(i - first + 1));
    const double around = std::max(step_or_none(first - 1), step_or_none(i + 1));
    const bool is_back = across <= std::min(way, 0.5 * leap);
    if (is_back && leap > std::max(kUsualSteps * usual, 2 * around) && 2 * leap > farthest) return i;
    farthest = std::max(farthest, across);
  }
  return {};
}

/// True if the step to row `i` is longer than those of the motion, and no hand makes it.
bool MotionReader::is_leap(std::size_t i, double usual) const {
  return step(i) > std::max(kUsualSteps * usual, kTremor) &&
         std::max(acceleration(i - 1), acceleration(i)) > kHandAcceleration;
}

void MotionReader::refuse_rows(std::size_t first, std::size_t back, double usual) const {
  const bool is_one = back == first + 1;
  fail(
      "{}: {} {:.4g} mm from the rows before and after, where the usual step is {:.3g} mm; correct {}, or "
      "leave {} out",
      table_.where(first),
      is_one ? fmt::format("row {} lies", first + 1) : fmt::format("rows {} to {} lie", first + 1, back),
      1e3 * std::min(step(first), step(back)), 1e3 * usual, is_one ? "it" : "them", is_one ? "it" : "them");
}

/// Refuses rows to which the motion leaps, and from which it leaps back; notes leaps after which it stays,
/// slow before and after.
void MotionReader::judge_leaps() {
  const auto usual = is_recording() ? usual_step() : std::nullopt;
  if (!usual) return;
  std::size_t worst = 0, leaps = 0;
  for (std::size_t i = 1; i < rows(); ++i) {
    if (!is_leap(i, *usual)) continue;
    if (const auto back = row_of_return(i, *usual)) refuse_rows(i, *back, *usual);
    if (step(i) <= kUsualSteps * std::max(step_or_none(i - 1), step_or_none(i + 1))) continue;
    ++leaps;
    if (worst == 0 || step(i) > step(worst)) worst = i;
  }
  if (leaps == 0) return;
  rows_.warnings.push_back(
      fmt::format("{}: row {} lies {:.4g} mm from the row before{}, where the usual step is {:.3g} mm, and "
                  "the tool stays "
                  "there; correct the rows if it did not",
                  table_.where(worst), worst + 1, 1e3 * step(worst),
                  leaps == 1 ? "" : fmt::format(", the farthest of {} such rows", leaps), 1e3 * *usual));
}

void MotionReader::refuse_speeds() const {
  for (std::size_t i = 1; i < rows(); ++i) {
    const double speed = step(i) / interval(i);
    if (speed > kFastest)
      fail(
          "{}: row {} lies {:.4g} m from the row {:.3g} s before: {:.4g} m/s, and a hand does less than "
          "{:g}; "
          "correct it, or, if these are millimetres, name the columns x_mm, y_mm, z_mm or set `scale = 1e-3` "
          "in the [trajectory] of a client file",
          table_.where(i), i + 1, step(i), interval(i), speed, kFastest);
  }
}

void MotionReader::note_irregular_rows() {
  if (!is_recording()) return;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < rows(); ++i) intervals.push_back(interval(i));
  const auto odd = std::ranges::count_if(
      intervals, [&](double dt) { return std::abs(dt - usual_interval_) > 0.5 * usual_interval_; });
  if (static_cast<std::size_t>(odd) * 100 <= rows()) return;
  const auto [least, most] = std::ranges::minmax(intervals);
  rows_.warnings.push_back(fmt::format(
      "{}: rows come {:.3g} to {:.3g} ms apart, {:.3g} ms in the middle; if the recorder took them "
      "evenly, its times are wrong: leave the column out and set `rate_hz`",
      settings_.file.string(), 1e3 * least, 1e3 * most, 1e3 * usual_interval_));
}

/// The columns that were read, and those that were not.
std::string MotionReader::sources() const {
  std::vector<std::string> read = position_, ignored;
  if (!time_.empty()) read.insert(read.begin(), time_);
  if (turns_) read.insert(read.end(), kOrientation.begin(), kOrientation.end());
  if (presses_) read.emplace_back(kButtons);
  for (const std::string& name : table_.names()) {
    if (!name.empty() && std::ranges::find(read, name) == read.end()) ignored.push_back(name);
  }
  return fmt::format("{}{}", fmt::join(read, ", "),
                     ignored.empty() ? "" : fmt::format("; not read: {}", fmt::join(ignored, ", ")));
}

std::string MotionReader::summary() const {
  const double lasts = rows_.t.back() - rows_.t.front();
  std::string line = fmt::format("{}: {} rows, {:.4g} s", settings_.file.string(), rows(), lasts);
  if (lasts > 0) line += fmt::format(" at {:.4g} Hz", static_cast<double>(rows() - 1) / lasts);
  Vec3 least = settings_.frame.to_world(rows_.p.front()), most = least;
  for (const Vec3& p : rows_.p) {
    least = least.cwiseMin(settings_.frame.to_world(p));
    most = most.cwiseMax(settings_.frame.to_world(p));
  }
  for (int i = 0; i < 3; ++i)
    line += fmt::format(", {} {:.4g} to {:.4g} mm", "xyz"[i], 1e3 * least[i], 1e3 * most[i]);
  return line + "; from " + sources();
}

MotionRows MotionReader::read() {
  read_times();
  read_places();
  read_orientation();
  read_buttons();
  refuse_wrong_unit_of_time();
  refuse_gaps();
  judge_leaps();
  refuse_speeds();
  note_irregular_rows();
  rows_.summary = summary();
  return std::move(rows_);
}

}  // namespace

TrajectorySettings read_trajectory_settings(const Config& section) {
  TrajectorySettings motion;
  motion.file = section.file("file");
  if (section.has("rate_hz")) motion.rate_hz = section.number("rate_hz", {0.1, 1e5, "Hz"});
  if (section.has("columns")) motion.columns = section.texts("columns", motion.rate_hz ? 3 : 4, {});
  if (section.has("time_scale")) motion.time_scale = section.number("time_scale", {1e-9, 1e3, "s per unit"});
  if (motion.rate_hz && motion.time_scale)
    fail("{}: `time_scale` is of a column of times, and `rate_hz` is for files without one; leave one out",
         section.where("time_scale"));
  if (section.has("gap")) motion.gap = section.number("gap", {1e-6, 1e5, "s"});
  if (section.has("scale")) motion.scale = section.number("scale", {1e-9, 1e9, "m per unit"});
  motion.axes = read_rotated_axes(section);
  motion.offset = section.vector("offset", {-kMaxCoordinate, kMaxCoordinate, "m"}, motion.offset);
  motion.repeat = section.flag("repeat", motion.repeat);
  section.reject_unknown();
  return motion;
}

TrajectorySettings motion_settings(const std::filesystem::path& file) {
  if (file.extension() != ".toml") return {.file = file};
  const auto section = Config::read(file).table("trajectory");
  if (!section) fail("{}: has no [trajectory] section to take the motion from", file.string());
  return read_trajectory_settings(*section);
}

MotionRows read_motion_rows(const TrajectorySettings& settings) {
  return MotionReader(settings).read();
}

}  // namespace palpate
