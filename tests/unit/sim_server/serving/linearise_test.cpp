// What a sample carries beyond its force.
#include "sim_server/serving/served_tools.h"
#include "sim_server/serving/surface_pager.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;

namespace {
constexpr double kDt = 0.03;
const Vec3 kAbove(-0.03, 0.10, 0.0);

/// The height at which the tool first touches the liver there.
double touching(Simulation& liver) {
  double low = 0.05, high = 0.10;
  while (high - low > 1e-9) {
    const double y = 0.5 * (low + high);
    test::lift_tools(liver);
    (liver.step(Vec3(kAbove[0], y, kAbove[2]), kDt).contacts > 0 ? low : high) = y;
  }
  return high;
}

Vec3 at(double y) {
  return {kAbove[0], y, kAbove[2]};
}
}  // namespace

TEST_CASE("linearise: in contact the tangent is the slope of the force, elsewhere, and nothing changes") {
  Simulation liver(test::liver_scene());
  const double top = touching(liver);
  test::lift_tools(liver);
  const ToolForce rendered = liver.step(at(top - 0.003), kDt);
  const std::uint64_t before = liver.state_hash();
  const auto at_tool = liver.linearise(0, at(top - 0.003), &rendered);
  CHECK(at_tool.tangent == rendered.tangent);
  CHECK(at_tool.gap == 0);
  const auto ahead = liver.linearise(0, at(top - 0.004), nullptr);
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = kStep * Vec3::Unit(axis);
    const Vec3 slope = (liver.linearise(0, at(top - 0.004) + d, nullptr).f_W -
                        liver.linearise(0, at(top - 0.004) - d, nullptr).f_W) /
                       (2 * kStep);
    CHECK((ahead.tangent.col(axis) - slope).norm() < 1e-4 * ahead.tangent.norm());
  }
  CHECK(liver.state_hash() == before);
  Simulation fresh(test::liver_scene());
  const ToolForce direct = fresh.step(at(top - 0.004), kDt);
  CHECK((ahead.f_W - direct.force).norm() < 1e-6 * direct.force.norm());
}

TEST_CASE("linearise: near the surface its plane, gap and stiffness, far away nothing") {
  Simulation liver(test::liver_scene());
  const double top = touching(liver);
  test::lift_tools(liver);
  const ToolForce free = liver.step(at(top + 0.002), kDt);
  REQUIRE(free.contacts == 0);
  const std::uint64_t before = liver.state_hash();
  const auto near = liver.linearise(0, at(top + 0.002), &free);
  CHECK(near.normal_W.norm() == Approx(1));
  CHECK(near.gap > 0);
  CHECK(near.gap <= 0.002 * (1 + 1e-9));  // straight down is the longer way, on a slope
  CHECK(near.f_W == Vec3::Zero());
  // Half a millimetre beyond the plane, the force is what the plane foretells, within the bend of the law.
  const double beyond = near.gap + 0.0003;
  const Vec3 p = at(top + 0.002) - beyond * near.normal_W;
  const Vec3 predicted = -0.0003 * (near.tangent * near.normal_W);
  const ToolForce real = liver.step(p, kDt);
  CHECK((predicted - real.force).norm() < 0.2 * real.force.norm());
  liver.step(at(top + 0.002), kDt);
  CHECK(liver.state_hash() == before);
  const ToolForce far = liver.step(at(top + 0.02), kDt);
  CHECK(liver.linearise(0, at(top + 0.02), &far).normal_W == Vec3::Zero());
}

TEST_CASE("parts of a sample: only those asked for, not of a lost device, and no allocation") {
  Simulation liver(test::liver_scene());
  const double top = touching(liver);
  test::lift_tools(liver);
  ServedTools tools(liver);
  std::vector<SessionInput> inputs{{7, {.tick = 1}, true}};
  auto& state = inputs[0].state;
  state.p_W = at(top - 0.003);
  using protocol::ForceSample;
  using protocol::ToolState;
  const auto answer = [&](std::uint16_t flags) {
    state.flags = flags;
    return *tools.step(inputs, kDt)[0].answer;
  };
  constexpr std::uint32_t kParts = ForceSample::kHasTangent | ForceSample::kHasAhead;
  CHECK((answer(0).flags & kParts) == 0);
  CHECK((answer(ToolState::kRequestsTangent).flags & kParts) == ForceSample::kHasTangent);
  state.v_W = {0, -0.1, 0};
  state.lead_ns = 10'000'000;
  const ForceSample both = answer(ToolState::kRequestsTangent | ToolState::kRequestsAhead);
  CHECK((both.flags & kParts) == kParts);
  CHECK((both.ahead_p_W - at(top - 0.004)).norm() < 1e-12);  // 10 ms at 0.1 m/s
  CHECK(both.ahead_f_W.norm() > both.f_W.norm());
  constexpr std::uint32_t kAll = kParts | ForceSample::kHasSurface;
  const ForceSample surface = answer(ToolState::kRequestsSurface);
  CHECK((surface.flags & kAll) == ForceSample::kHasSurface);
  CHECK(surface.surface.version == SurfacePager(liver, 0).state().version);
  CHECK(surface.surface.version != 0);
  CHECK(surface.at_tool.tangent == Mat3::Zero());
  CHECK(surface.ahead_p_W == Vec3::Zero());
  const ForceSample at_tool = answer(ToolState::kRequestsTangent);
  CHECK((at_tool.flags & kAll) == ForceSample::kHasTangent);
  CHECK(at_tool.at_tool.tangent(1, 1) == Approx(both.at_tool.tangent(1, 1)));
  CHECK(at_tool.ahead_p_W == Vec3::Zero());
  CHECK(at_tool.surface.version == 0);
  state.lead_ns = 1'000'000'000;
  CHECK((answer(ToolState::kRequestsAhead).ahead_p_W - at(top - 0.005)).norm() < 1e-12);  // at most 2 mm
  CHECK((answer(ToolState::kRequestsTangent | ToolState::kDeviceLost).flags & kParts) == 0);
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    answer(ToolState::kRequestsTangent | ToolState::kRequestsAhead);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
