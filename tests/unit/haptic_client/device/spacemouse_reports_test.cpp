#include "haptic_client/device/spacemouse_reports.h"

#include <algorithm>
#include <vector>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;

namespace {

std::vector<std::byte> report_of(std::initializer_list<int> bytes) {
  std::vector<std::byte> report;
  for (const int byte : bytes) report.push_back(static_cast<std::byte>(byte));
  return report;
}

}  // namespace

TEST_CASE("SpaceMouse: translation in 7 bytes and in 13, to x right, y up, z towards the user") {
  // Raw: 350 to the right, -350 towards the user (so away), 180 down: ((180 - 10) / 340)^2 = 1/4.
  for (const auto& report :
       {report_of({1, 0x5e, 0x01, 0xa2, 0xfe, 0xb4, 0x00}),
        report_of({1, 0x5e, 0x01, 0xa2, 0xfe, 0xb4, 0x00, 0x5e, 0x01, 0x5e, 0x01, 0x5e, 0x01})}) {
    CAPTURE(report.size());
    SpaceMouseState state;
    CHECK(take_spacemouse_report(report, state));
    CHECK((state.push_D - Vec3(1, -0.25, -1)).norm() < 1e-15);
    CHECK(state.buttons == 0);
  }
}

TEST_CASE("SpaceMouse: rotation is not a translation") {
  SpaceMouseState state{.push_D = {0.5, 0, 0}, .buttons = 1};
  CHECK_FALSE(take_spacemouse_report(report_of({2, 0x5e, 0x01, 0, 0, 0, 0}), state));
  CHECK(state.push_D == Vec3(0.5, 0, 0));
}

TEST_CASE("SpaceMouse: buttons, of a model with two bytes and of one with four") {
  SpaceMouseState state{.push_D = {0, 1, 0}};
  CHECK_FALSE(take_spacemouse_report(report_of({3, 0x02, 0x80}), state));
  CHECK(state.buttons == 0x8002);
  CHECK_FALSE(take_spacemouse_report(report_of({3, 0x01, 0, 0xff, 0xff}), state));
  CHECK(state.buttons == 1);
  CHECK(state.push_D == Vec3(0, 1, 0));
}

TEST_CASE("SpaceMouse: truncated, too long, unknown and empty reports change nothing") {
  const auto entire = report_of({1, 100, 0, 100, 0, 100, 0, 100, 0, 100, 0, 100, 0, 100, 0});
  const auto battery = report_of({0x17, 50, 0}), light = report_of({4, 1}), buttons = report_of({3, 1});
  SpaceMouseState state{.push_D = {0.1, 0.2, 0.3}, .buttons = 7};
  for (std::size_t size = 0; size <= entire.size(); ++size) {
    if (size == 7 || size == 13) continue;
    CHECK_FALSE(take_spacemouse_report(std::span(entire).first(size), state));
  }
  for (const auto& report : {battery, light, buttons}) CHECK_FALSE(take_spacemouse_report(report, state));
  CHECK(state.push_D == Vec3(0.1, 0.2, 0.3));
  CHECK(state.buttons == 7);
}

TEST_CASE("SpaceMouse: the response has a dead band, no step, odd symmetry, and ends at one") {
  for (int raw = -kSpaceMouseDeadBand; raw <= kSpaceMouseDeadBand; ++raw)
    CHECK(spacemouse_response(raw) == 0);
  for (int raw = 0; raw < 400; ++raw) {
    CHECK(spacemouse_response(-raw) == -spacemouse_response(raw));
    const double step = spacemouse_response(raw + 1) - spacemouse_response(raw);
    CHECK(step >= 0);
    CHECK(step < 2.0 / (kSpaceMouseFull - kSpaceMouseDeadBand));  // the largest slope of the square
  }
  CHECK(spacemouse_response(kSpaceMouseDeadBand + 1) < 1e-5);
  for (const int raw : {kSpaceMouseFull, 351, 1000, 32767}) CHECK(spacemouse_response(raw) == 1);
  CHECK(spacemouse_response(-32768) == -1);
}

TEST_CASE("SpaceMouse: random bytes stay in range and take no memory") {
  test::Random random(17);
  SpaceMouseState state;
  std::array<std::byte, 64> bytes{};
  std::size_t allocations = 1;
  double largest = 0;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 20000; ++i) {
      for (std::byte& b : bytes) b = static_cast<std::byte>(random.bits());
      bytes[0] = static_cast<std::byte>(random.bits() % 5);
      take_spacemouse_report(std::span(bytes).first(random.bits() % 16), state);
      largest = std::max(largest, state.push_D.cwiseAbs().maxCoeff());
    }
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  CHECK(largest == 1);
}

TEST_CASE("SpaceMouse: models with six axes are known, others of the maker are not") {
  const auto known = [](std::uint16_t vendor, std::uint16_t product) {
    const auto ids = spacemouse_ids();
    return std::ranges::find(ids, UsbId{vendor, product}) != ids.end();
  };
  CHECK(spacemouse_ids().size() == 21);
  CHECK(known(0x046d, 0xc626));
  CHECK(known(0x256f, 0xc635));
  for (const int product : {0xc641, 0xc62c, 0xc650, 0xc652, 0xc658, 0xc664, 0xc665, 0xc668})
    CHECK_FALSE(known(0x256f, static_cast<std::uint16_t>(product)));
  CHECK(std::string(spacemouse_name({0x046d, 0xc626})) == "SpaceNavigator");
  CHECK(std::string(spacemouse_name({0x256f, 0xc63a})) == "SpaceMouse");
}
