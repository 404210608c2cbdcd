#include "haptic_client/device/simulated_operator.h"

#include <cmath>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

TEST_CASE("against a steady force the hand settles where the arm's spring balances it") {
  SimulatedOperator hand({.hand_stiffness = 300}, Trajectory({0}, {Vec3(0.1, 0.2, 0.3)}));
  DeviceReading reading;
  for (int tick = 0; tick < 2000; ++tick) {
    reading = hand.read(tick * 2ms);
    hand.write({0, 1.5, 0});
  }
  CHECK((reading.p_D - Vec3(0.1, 0.2 + 1.5 / 300, 0.3)).norm() < 1e-6);
}

TEST_CASE("without force it follows a slow path, the same times give the same bits") {
  const Trajectory path({0, 1, 2}, {Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0, 0)});
  SimulatedOperator one({}, path), two({}, path);
  Vec3 p = Vec3::Zero();
  for (int tick = 0; tick <= 450; ++tick) {
    p = one.read(tick * 2ms).p_D;
    CHECK(two.read(tick * 2ms).p_D == p);
  }
  // 0.9 s along: the drag of the device, 2 N s/m at 0.02 m/s on 300 N/m, leaves it 0.13 mm behind.
  CHECK(p[0] == Approx(0.018 - 0.02 * 2 / 300).margin(1e-5));
}

TEST_CASE("a pause of the loop does not fling the hand") {
  SimulatedOperator hand({}, Trajectory({0, 1}, {Vec3(0, 0, 0), Vec3(1, 0, 0)}));
  hand.read(0s);
  CHECK(hand.read(100s).p_D.norm() < 0.2);
  CHECK(hand.read(99s).p_D.allFinite());
}

TEST_CASE("trajectories: interpolation, ends, repetition, scale and offset") {
  const Trajectory closed({0, 1, 2}, {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0, 0)}, true),
      open({5, 6}, {Vec3(0, 0, 0), Vec3(0.1, 0, 0)});
  CHECK(closed.at(0.5)[0] == Approx(0.05));
  CHECK(closed.at(2.5)[0] == Approx(0.05));
  CHECK(open.at(-1)[0] == 0);
  CHECK(open.at(0.5)[0] == Approx(0.05));
  CHECK(open.at(50)[0] == Approx(0.1));
  const test::TemporaryFolder folder;
  const auto file = folder.write("m.csv", "time,a,b,c\n10,1,2,3\n11,2,2,3\n");
  const Trajectory read(
      {.file = file, .columns = {"time", "c", "a", "b"}, .scale = 0.001, .offset = Vec3(0, 0, 1)});
  CHECK((read.at(0.5) - Vec3(0.003, 0.0015, 1.002)).norm() < 1e-15);
  const auto bad = folder.write("bad.csv", "t_s,x_m,y_m,z_m\n0,0,0,0\n0,1,1,1\n");
  CHECK_THROWS_AS(Trajectory({.file = bad}), Error);
}

TEST_CASE("trajectories: one that ends near its start stays at its end unless it is asked to repeat") {
  const test::TemporaryFolder folder;
  const auto press = folder.write("press.csv", "t_s,x_m,y_m,z_m\n0,0,0,0\n1,0,-0.0005,0\n");
  const Trajectory once({.file = press}), again({.file = press, .repeat = true});
  CHECK(once.at(7.25)[1] == -0.0005);
  CHECK(again.at(7.25)[1] == Approx(-0.000125));
  const auto far = folder.write("far.csv", "t_s,x_m,y_m,z_m\n0,0,0,0\n1,0,-0.5,0\n");
  CHECK_THROWS_WITH(Trajectory({.file = far, .repeat = true}),
                    Catch::Contains("ends 500 mm from where it began"));
}

TEST_CASE("the hand turns the tool as its motion does, and tells no orientation where that has none") {
  const test::TemporaryFolder folder;
  const auto turns =
      folder.write("q.csv", "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.2,0,0,0,0,1,0,0\n");
  SimulatedOperator turning({}, Trajectory({.file = turns})), still({}, Trajectory({0}, {Vec3::Zero()}));
  turning.read(0s);
  std::optional<Quat> half;  // of the half turn about x
  for (int tick = 1; tick <= 50; ++tick) half = turning.read(tick * 2ms).q_D;
  REQUIRE(half);
  CHECK(half->angularDistance(Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0)) < 1e-7);
  CHECK_FALSE(still.read(0s).q_D);
}
