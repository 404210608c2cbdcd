// Where a tool was lately.
#include "sim_server/serving/tool_path.h"

#include <limits>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr std::int64_t kMs = 1'000'000;  // ns

/// At 30 mm/s along x, by the time alone.
protocol::ToolState at(std::int64_t t_ns) {
  return {
      .tick = 1, .t_ns = t_ns, .p_W = Vec3(3e-11 * static_cast<double>(t_ns), 0, 0), .v_W = Vec3(0.03, 0, 0)};
}

}  // namespace

TEST_CASE("tool path: straight between two poses, turning evenly, and nothing before and behind them") {
  ToolPath path;
  CHECK_FALSE(path.at(0));
  path.add(at(10 * kMs));
  protocol::ToolState turned = at(14 * kMs);
  turned.q_W = {0, 0, 0, 1};  // by half a turn about z
  path.add(turned);
  const auto middle = path.at(12 * kMs);
  REQUIRE(middle);
  CHECK(middle->pose.p_W[0] == Approx(3.6e-4).epsilon(1e-12));
  CHECK(middle->pose.q_W.angularDistance(Quat::Identity()) == Approx(1.5707963).epsilon(1e-6));
  CHECK(path.at(14 * kMs)->pose.p_W == turned.p_W);
  CHECK_FALSE(path.at(10 * kMs - 1));
  CHECK_FALSE(path.at(14 * kMs + 1));
}

TEST_CASE("tool path: a client of 4 kHz is thinned, its newest pose and 120 ms before it are known") {
  ToolPath path;
  std::int64_t t = 0;
  for (; t <= 1000 * kMs; t += kMs / 4) path.add(at(t));
  const std::int64_t newest = t - kMs / 4;
  for (const std::int64_t ago : {std::int64_t{0}, kMs / 4, kMs, 33 * kMs, 120 * kMs}) {
    CAPTURE(ago);
    const auto there = path.at(newest - ago);
    REQUIRE(there);
    CHECK(there->pose.p_W[0] == Approx(3e-11 * static_cast<double>(newest - ago)).epsilon(1e-9));
  }
  CHECK_FALSE(path.at(newest - 400 * kMs));
}

TEST_CASE("tool path: a pose that is not later changes nothing, nor does an orientation that is none") {
  ToolPath path;
  path.add(at(10 * kMs));
  protocol::ToolState late = at(10 * kMs);
  late.p_W = Vec3(1, 1, 1);
  path.add(late);
  CHECK(path.at(10 * kMs)->pose.p_W[0] == Approx(3e-4).epsilon(1e-12));
  late.q_W = {0, 0, 0, 0};
  CHECK(pose_of(late).q_W.coeffs() == Quat::Identity().coeffs());
}

TEST_CASE("tool path: clocks at the ends of what fits into 64 bits do no harm") {
  ToolPath path;
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min(),
                         kLast = std::numeric_limits<std::int64_t>::max();
  path.add(at(kFirst));
  path.add(at(kLast));
  path.add(at(kLast));
  REQUIRE(path.at(0));
  CHECK(path.at(0)->pose.p_W.allFinite());
  CHECK(path.at(kLast)->t_ns == kLast);
}

TEST_CASE("tool path: after one pose with a wild clock the next ones are known") {
  ToolPath path;
  path.add(at(10 * kMs));
  path.add(at(std::int64_t{1} << 60));
  for (int i = 2; i < 10; ++i) path.add(at(10 * i * kMs));
  REQUIRE(path.at(85 * kMs));
  CHECK(path.at(85 * kMs)->pose.p_W[0] == Approx(85 * 3e-5).epsilon(1e-9));
}
