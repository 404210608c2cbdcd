// Recorded motions are read for what they are: expected values are of the same motion in seconds and metres,
// or closed forms.
#include "common/motion_file.h"

#include <array>
#include <cmath>
#include <fmt/core.h>
#include <functional>
#include <numbers>

#include "common/error.h"
#include "common/trajectory.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using Catch::Matchers::Contains;

namespace {

/// A press of 10 mm at 1 kHz in 1 s; times and places in units of `time` (s) and `length` (m).
struct Recorded {
  double time = 1, length = 1;
  int hole_from = 0, hole_to = 0;  // rows that are not there
  std::string head = "t_s,x_m,y_m,z_m\n";

  static Vec3 place(int row) {
    const double sine = std::sin(std::numbers::pi * row / 1000);
    return {0.001, 0.012 - 0.010 * sine * sine, 0.002};
  }
  std::string text(int wrong_row = -1, const Vec3& off = Vec3::Zero(), int every = 1) const {
    return text_with([&](int i) { return i == wrong_row ? off : Vec3::Zero().eval(); }, every);
  }
  /// With each row off by what `off` says, m.
  std::string text_with(const std::function<Vec3(int row)>& off, int every = 1) const {
    std::string rows = head;
    for (int i = 0; i <= 1000; i += every) {
      if (i >= hole_from && i < hole_to) continue;
      const Vec3 p = (place(i) + off(i)) / length;
      rows += fmt::format("{},{},{},{}\n", i / 1000.0 / time, p[0], p[1], p[2]);
    }
    return rows;
  }
};

MotionRows read_text(const std::string& text, TrajectorySettings settings = {}) {
  const test::TemporaryFolder folder;
  settings.file = folder.write("motion.csv", text);
  return read_motion_rows(settings);
}

/// A motion at rest with these orientations at 0, 1, 2 s ...
std::string turning(const std::string& names, const std::vector<std::string>& quaternions) {
  std::string text = "t_s,x_m,y_m,z_m," + names + "\n";
  for (std::size_t i = 0; i < quaternions.size(); ++i)
    text += fmt::format("{},0,0,0,{}\n", i, quaternions[i]);
  return text;
}

}  // namespace

TEST_CASE("a motion in ms, us or ns, and in mm, is that in seconds and metres, by names or by keys") {
  const MotionRows expected = read_text(Recorded{}.text());
  const auto equals = [&](const MotionRows& read) {
    REQUIRE(read.t.size() == expected.t.size());
    for (std::size_t i = 0; i < read.t.size(); ++i) {
      CHECK(read.t[i] == Approx(expected.t[i]).epsilon(1e-15).margin(1e-15));
      CHECK((read.p[i] - expected.p[i]).norm() < 1e-16);
    }
  };
  equals(read_text(Recorded{.time = 1e-3, .head = "t_ms,x_m,y_m,z_m\n"}.text()));
  equals(read_text(Recorded{.time = 1e-6, .length = 1e-3, .head = "t_us,x_mm,y_mm,z_mm\n"}.text()));
  equals(read_text(Recorded{.time = 1e-9, .head = "t_ns,x_m,y_m,z_m\n"}.text()));
  equals(read_text(Recorded{.time = 1e-3, .length = 1e-3, .head = "when,x,y,z\n"}.text(),
                   {.file = {}, .columns = {"when", "x", "y", "z"}, .scale = 1e-3, .time_scale = 1e-3}));
  equals(
      read_text(Recorded{.head = "t_ms,x_mm,y_mm,z_mm\n"}.text(), {.file = {}, .scale = 1, .time_scale = 1}));
}

TEST_CASE("a motion without times comes at the rate that is told, and its times are not told twice") {
  const std::string text = "x_m,y_m,z_m\n0,0,0\n0.001,0,0\n0.003,0,0\n";
  const MotionRows read = read_text(text, {.file = {}, .rate_hz = 50});
  CHECK(read.t == std::vector<double>{0, 0.02, 0.04});
  CHECK(read.p[2] == Vec3(0.003, 0, 0));
  CHECK_THROWS_WITH(read_text(text),
                    Contains(":1: no column t_s, t_ms, t_us or t_ns") && Contains("`rate_hz`"));
  CHECK_THROWS_WITH(read_text(Recorded{}.text(), {.file = {}, .rate_hz = 50}),
                    Contains("leave `rate_hz` out"));
}

TEST_CASE("columns of different units of length need their scale") {
  const std::string text = "t_s,x_m,y_mm,z_m\n0,0,0,0\n1,1,1,1\n";
  CHECK_THROWS_WITH(read_text(text), Contains(":1: columns x_m and y_mm have different units"));
  CHECK(read_text(text, {.file = {}, .scale = 0.5}).p[1] == Vec3(0.5, 0.5, 0.5));
}

TEST_CASE("a hole in a recording is refused with its place and length, or accepted by `gap`") {
  const std::string text = Recorded{.hole_from = 300, .hole_to = 700}.text();
  CHECK_THROWS_WITH(read_text(text), Contains("motion.csv:302: a hole of 0.401 s at 0.299 s") &&
                                         Contains("every 0.001 s") && Contains("accept it by `gap = 0.44`"));
  CHECK(read_text(text, {.file = {}, .gap = 0.44}).t.size() == 601);
  CHECK_NOTHROW(read_text(Recorded{.hole_from = 300, .hole_to = 309}.text()));  // 10 ms: ten intervals
  CHECK_THROWS(read_text(Recorded{.hole_from = 300, .hole_to = 310}.text()));
  CHECK_NOTHROW(read_text("t_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0,0,0\n9,0.1,0,0\n"));  // corners of a path
}

TEST_CASE("a row away from both its neighbours is refused by its number, a fast motion is not") {
  CHECK_THROWS_WITH(read_text(Recorded{}.text(500, {1, 0, 0})),
                    Contains("motion.csv:502: row 501 lies 1000 mm from the rows before and after"));
  // At 50 Hz 10 mm is no speed, but twenty times the largest step of 0.63 mm.
  CHECK_THROWS_WITH(read_text(Recorded{}.text(500, {0, 0, 0.01}, 20)), Contains("row 26 lies 10"));
  CHECK_NOTHROW(read_text(Recorded{}.text(500, {0, 0, 0.002}, 20)));
  CHECK_THROWS_WITH(read_text(Recorded{}.text(1000, {0, 0, 1})),
                    Contains("row 1001 lies 1 m from the row 0.001 s before: 1000 m/s"));
}

TEST_CASE("rows that leap away and back within half a second are refused by their numbers, others are not") {
  // Every 5 ms a row of a press of 10 mm in 1 s: no step is longer than 0.16 mm.
  const auto read_with = [](int first, int rows, const std::function<Vec3(int)>& off) {
    return read_text(Recorded{}.text_with(
        [&](int i) {
          const int row = i / 5 + 1;
          return row >= first && row < first + rows ? off(row - first) : Vec3::Zero().eval();
        },
        5));
  };
  const auto beside = [](int) { return Vec3(0, 0, 0.03); };
  CHECK_THROWS_WITH(read_with(31, 1, beside),
                    Contains("motion.csv:32: row 31 lies 30") && Contains("correct it"));
  CHECK_THROWS_WITH(read_with(31, 2, beside),
                    Contains("motion.csv:32: rows 31 to 32 lie ") && Contains("leave them out"));
  CHECK_THROWS_WITH(read_with(31, 5, beside), Contains("rows 31 to 35 lie "));
  CHECK_THROWS_WITH(read_with(31, 98, beside), Contains("rows 31 to 128 lie "));
  // Each elsewhere.
  CHECK_THROWS_WITH(read_with(31, 2, [](int k) { return Vec3(0, 0, k == 0 ? 0.03 : -0.03); }),
                    Contains("rows 31 to 32 lie "));
  CHECK_THROWS_WITH(read_with(31, 5, [](int k) { return Vec3(0.03 * std::cos(k), 0, 0.03 * std::sin(k)); }),
                    Contains("rows 31 to 35 lie "));
  // A tool that stays away is believed, and it is said.
  const MotionRows away = read_with(31, 120, beside);
  REQUIRE(away.warnings.size() == 1);
  CHECK_THAT(away.warnings[0], Contains("motion.csv:152: row 151 lies 30") &&
                                   Contains(", the farthest of 2 such rows") &&
                                   Contains("and the tool stays there"));
  REQUIRE(read_with(31, 1000, beside).warnings.size() == 1);
  // A fast motion of several rows there and back is one.
  const auto fast = [](int k) { return Vec3(0, 0, 0.02 * std::min(k + 1, 9 - k)); };
  CHECK(read_with(31, 9, fast).warnings.empty());
}

TEST_CASE(
    "a quick press out of noise is a motion, however many usual steps it is long, and a leap no hand makes "
    "is not") {
  // 30 Hz, at rest for 10 s with noise of 20 um, four rows away by `press` (m), and at rest again.
  const auto read_with = [](const std::array<double, 4>& press) {
    constexpr double kNoise = 2e-5;
    std::string rows = "t_s,x_m,y_m,z_m\n";
    for (int i = 0; i < 400; ++i) {
      const double away = i >= 300 && i < 304 ? press[static_cast<std::size_t>(i) - 300] : 0;
      rows += fmt::format("{},0,{},{}\n", i / 30.0, kNoise * std::sin(1.7 * i * i) - away, kNoise * (i % 3));
    }
    return read_text(rows);
  };
  CHECK(read_with({0.003, 0.005, 0.005, 0.003}).warnings.empty());  // 90 mm/s
  CHECK(read_with({0.005, 0.005, 0.005, 0.005}).warnings.empty());
  // One row beside the others by 22 mm is 2 * 22 mm * (30 Hz)^2 = 39.6 m/s^2, by 22.5 mm 40.5 m/s^2.
  CHECK_NOTHROW(read_with({0, 0.022, 0, 0}));
  CHECK_THROWS_WITH(read_with({0, 0.0225, 0, 0}), Contains("row 302 lies 22.4"));
  CHECK_THROWS_WITH(read_with({0.05, 0.05, 0.05, 0.05}), Contains("rows 301 to 304 lie "));
  // Rows at 1 kHz with 0.05 um of a step: 0.9 mm for one of them is noise, though 1800 m/s^2.
  const std::string still = Recorded{.length = 200}.text(500, {0, 0, 0.9 * 0.2});
  CHECK_NOTHROW(read_text(still));
}

TEST_CASE("millimetres read as metres are faster than a hand, and the remedies work") {
  const std::string text = Recorded{.length = 1e-3}.text();  // 10 mm as 10 m: 10 pi m/s
  CHECK_THROWS_WITH(read_text(text), Contains("less than 10") && Contains("`scale = 1e-3`"));
  CHECK((read_text(text, {.file = {}, .scale = 1e-3}).p[500] - Vec3(0.001, 0.002, 0.002)).norm() < 1e-15);
}

TEST_CASE("milliseconds read as seconds are refused, rows once a second accepted where that is said") {
  const std::string text = Recorded{.time = 1e-3}.text();
  CHECK_THROWS_WITH(read_text(text),
                    Contains("motion.csv:1: 1001 rows of column t_s last 1000 s, one every 1 s") &&
                        Contains("`time_scale = 1e-3`"));
  CHECK(read_text(text, {.file = {}, .time_scale = 1e-3}).t.back() == Approx(1).epsilon(1e-15));
  CHECK(read_text(text, {.file = {}, .time_scale = 1}).t.back() == 1000);
}

TEST_CASE("times that do not increase are refused with file and line") {
  CHECK_THROWS_WITH(read_text("t_s,x_m,y_m,z_m\n0,0,0,0\n# paused\n0,1,1,1\n"),
                    Contains("motion.csv:4: column t_s must increase, but row 2 has 0 s after 0 s"));
}

TEST_CASE("rows at uneven times are warned of, even ones are not") {
  std::string uneven = "t_s,x_m,y_m,z_m\n";
  for (int i = 0; i < 100; ++i) uneven += fmt::format("{},0,0,0\n", 0.001 * (3 * (i / 2) + i % 2));
  const auto warnings = read_text(uneven).warnings;
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains("rows come 1 to 2 ms apart") && Contains("`rate_hz`"));
  CHECK(read_text(Recorded{}.text()).warnings.empty());
}

TEST_CASE("a motion says what it was taken for") {
  const MotionRows read = read_text("t_ms,x_mm,y_mm,z_mm,speed\n0,-10,0,0,7\n500,10,0,2.5,7\n1000,0,0,0,7\n");
  CHECK_THAT(read.summary,
             Contains("motion.csv: 3 rows, 1 s at 2 Hz, x -10 to 10 mm, y 0 to 0 mm, z 0 to 2.5 mm; "
                      "from t_ms, x_mm, y_mm, z_mm; not read: speed"));
}

TEST_CASE("orientation: by names in any order, normalised, the short way at an even rate") {
  const double half = std::sqrt(0.5);
  const std::string turned = fmt::format("{0},0,{0},0", half), flipped = fmt::format("-{0},0,-{0},0", half);
  const test::TemporaryFolder folder;
  for (const std::string& end : {turned, flipped, std::string("0.7071,0,0.7071,0")}) {
    CAPTURE(end);
    const auto file = folder.write("q.csv", turning("qw,qx,qy,qz", {"1,0,0,0", end}));
    const Trajectory motion({.file = file});
    for (const double t : {0.0, 0.3, 1.0, 2.0}) {
      const double angle = std::min(t, 1.0) * std::numbers::pi / 2;  // about y
      const Quat expected(std::cos(angle / 2), 0, std::sin(angle / 2), 0);
      CHECK(motion.orientation_at(t).angularDistance(expected) < 1e-7);
    }
  }
  const MotionRows other = read_text(turning("qx,qy,qz,qw", {"0,0,0,1", fmt::format("0,{0},0,{0}", half)}));
  CHECK((other.q[1].coeffs() - Quat(half, 0, half, 0).coeffs()).norm() < 1e-15);
  const Trajectory still({0}, {Vec3::Zero()});
  CHECK_FALSE(still.turns());
  CHECK(still.orientation_at(1).coeffs() == Quat::Identity().coeffs());
}

TEST_CASE("a quaternion far from unit length, or without all four columns, is refused") {
  CHECK_THROWS_WITH(read_text(turning("qw,qx,qy,qz", {"1,0,0,0", "0.9,0,0,0"})),
                    Contains("motion.csv:3: the quaternion qw, qx, qy, qz of row 2 has length 0.9"));
  CHECK_THROWS_WITH(read_text(turning("qw,qx,qy,qz", {"0,0,0,0"})), Contains("length 0"));
  CHECK_THROWS_WITH(read_text(turning("qw,qx,qy", {"1,0,0"})), Contains(":1: no column \"qz\""));
  CHECK_NOTHROW(read_text(turning("qw,qx,qy,qz", {"1.04,0,0,0"})));
}

TEST_CASE("axes turn places and orientation: z up of a file becomes y up of the world") {
  Mat3 axes;
  axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // world x, y, z are the file's x, z, -y
  const MotionRows read = read_text("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n",
                                    {.file = {}, .offset = Vec3(0, 0, 1), .axes = axes});
  CHECK(read.p[0] == Vec3(1, 3, -1));
  CHECK((read.q[0] * Vec3::UnitZ() - Vec3::UnitY()).norm() < 1e-15);  // the tool's axis, along z in the file
}
