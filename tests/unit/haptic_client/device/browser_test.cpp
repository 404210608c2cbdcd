#include "haptic_client/device/browser.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

constexpr double kArm = 300;  // N/m

/// Reads for `seconds`, each millisecond, from `t` on (s); returns the place.
Vec3 read_for(Browser& browser, double seconds, double& t) {
  Vec3 p;
  for (const double end = t + seconds; t < end - 1e-9; t += 1e-3) p = browser.read(from_seconds(1 + t)).p_D;
  return p;
}

}  // namespace

TEST_CASE(
    "browser: without a mouse the hand stays where it began, with one it goes there, at 0.25 m/s at most") {
  Browser browser({.hand_stiffness = kArm}, {0, 0.1, 0});
  double t = 0;
  CHECK(read_for(browser, 0.5, t) == Vec3(0, 0.1, 0));
  browser.aim({0.1, 0.1, 0}, 3);
  Vec3 before = read_for(browser, 0.2, t);
  CHECK(before[0] < 0.25 * 0.2);  // the arm leads the hand
  CHECK(before[0] > 0.01);
  CHECK_THAT(read_for(browser, 2, t)[0], WithinAbs(0.1, 1e-4));
  CHECK(browser.read(from_seconds(1 + t)).buttons == 3);
}

TEST_CASE("browser: a force pushes the hand off the mouse by force over stiffness of the arm") {
  Browser browser({.hand_stiffness = kArm}, Vec3::Zero());
  double t = 0;
  browser.write({0, 1.5, 0});
  CHECK_THAT(read_for(browser, 3, t)[1], WithinRel(1.5 / kArm, 1e-3));
  browser.write(Vec3::Zero());
  CHECK_THAT(read_for(browser, 3, t)[1], WithinAbs(0, 1e-6));
}

TEST_CASE("browser: a mouse at no finite place is not followed") {
  Browser browser({.hand_stiffness = kArm}, Vec3::Zero());
  browser.aim({std::nan(""), 0, 0}, 1);
  double t = 0;
  CHECK(read_for(browser, 0.1, t) == Vec3::Zero());
}
