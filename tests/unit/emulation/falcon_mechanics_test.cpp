#include "tests/emulation/falcon_mechanics.h"

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate::emulation;
using palpate::test::Random;

namespace {

double sum(const Work& work) {
  return work.hand + work.motors + work.friction + work.stops + work.weight;
}

/// Pulls out and pushes in, as the user does for homing.
void home(FalconMechanics& falcon) {
  falcon.set_homing(true);
  falcon.hand.move({0, 0, 0.172}, 0.3);
  falcon.hand.then({0, 0, 0.080}, 0.3);
  falcon.advance(1.5);
}

}  // namespace

TEST_CASE("falcon mechanics: the work of all forces is the kinetic energy") {
  Random random(3);
  FalconMechanics falcon({});
  falcon.hand.tremor = 0.001;
  falcon.weight = 0.2;
  for (int i = 0; i < 100; ++i) {
    const auto dac = [&] { return static_cast<int>(random.between(-6000, 6000)); };
    falcon.set_dac({dac(), dac(), dac()});
    falcon.hand.move({random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(0.06, 0.19)},
                     0.05);
    falcon.advance(0.02);
    CHECK(sum(falcon.work()) == Approx(falcon.kinetic_energy()).margin(1e-12));
  }
  CHECK(falcon.work().friction < 0);
}

TEST_CASE("falcon mechanics: a positive command pulls in, and is cut at 4096") {
  FalconMechanics falcon({});
  falcon.hand.stiffness = falcon.hand.damping = 0;
  falcon.set_dac({100000, 100000, 100000});
  CHECK(falcon.dac() == std::array<int, 3>{4096, 4096, 4096});
  CHECK(falcon.motor_force().z < -5);
  CHECK(std::abs(falcon.motor_force().x) < 1e-6);
  const auto before = falcon.encoders();
  falcon.advance(0.05);
  CHECK(falcon.position().z < 0.11);
  for (std::size_t i = 0; i < 3; ++i) CHECK(falcon.encoders()[i] < before[i]);
}

TEST_CASE("falcon mechanics: the force follows the torque constant and the mains") {
  FalconMechanics weak({}), strong({.torque_constant = 5000});
  for (FalconMechanics* falcon : {&weak, &strong}) falcon->set_dac({1000, -500, 200});
  CHECK(norm(strong.motor_force() - 2 * weak.motor_force()) < 1e-12);
  strong.set_mains(false);
  CHECK(norm(strong.motor_force()) == 0);
}

TEST_CASE("falcon mechanics: at rest hand and motors are in balance, within the friction") {
  FalconMechanics falcon({.coulomb = 0});
  falcon.set_dac({800, 800, 800});
  falcon.advance(3);
  const Vec by_hand = falcon.hand.force(falcon.position(), falcon.velocity());
  CHECK(norm(by_hand + falcon.motor_force()) < 1e-3);
  CHECK(by_hand.z > 1);
}

TEST_CASE("falcon mechanics: a weight pulls down, and swings slower than the grip alone") {
  FalconMechanics falcon({.coulomb = 0});
  falcon.weight = 0.2;
  falcon.advance(3);
  CHECK(falcon.hand.stiffness * falcon.position().y == Approx(-0.2 * 9.80665).epsilon(1e-6));
  falcon.hand.stiffness = falcon.hand.damping = falcon.weight = 0;
  CHECK(falcon.place({0, 0, 0.11}));
  falcon.weight = 0.2;
  falcon.advance(0.01);
  // Half of the mass is balanced: it falls at half of g, less what the joints take.
  CHECK(falcon.velocity().y == Approx(-0.01 * 9.80665 / 2).epsilon(0.02));
}

TEST_CASE("falcon mechanics: the hard stops hold the grip, and give back no more than they took") {
  FalconMechanics falcon({});
  for (const Vec& far : {Vec{0, 0, 0.3}, Vec{0, 0, -0.1}, Vec{0.2, 0.1, 0.12}}) {
    falcon.hand.move(far, 0.2);
    falcon.advance(1);
    CHECK(falcon.position().z < 0.185);
    CHECK(falcon.position().z > 0.065);
    CHECK(std::hypot(falcon.position().x, falcon.position().y) < 0.075);
  }
  falcon.hand.move({0, 0, 0.11}, 0.2);
  falcon.advance(1);
  CHECK(falcon.work().stops < 1e-9);
}

TEST_CASE("falcon mechanics: homing needs the bit, the mains, the way out and the way in") {
  FalconMechanics falcon({});
  const double true_counts = counts_of(DeltaMechanism().thigh(0));
  CHECK(std::abs(falcon.encoders()[0] - true_counts) > 1);  // a zero of its own
  falcon.set_homing(true);
  falcon.hand.move({0, 0, 0.080}, 0.3);
  falcon.advance(1);
  CHECK(falcon.homed() == 0);  // pushed only
  falcon.set_mains(false);
  home(falcon);
  CHECK(falcon.homed() == 0);
  falcon.set_mains(true);
  home(falcon);
  CHECK(falcon.homed() == 7);
  DeltaMechanism there;
  REQUIRE(there.move_to(falcon.position()));
  for (int i = 0; i < 3; ++i)
    CHECK(falcon.encoders()[static_cast<std::size_t>(i)] == std::lround(counts_of(there.thigh(i))));
  falcon.set_homing(false);
  CHECK(falcon.homed() == 0);
}

TEST_CASE("falcon mechanics: the references come one by one, and each makes its encoder jump") {
  FalconMechanics falcon({.seed = 5});
  falcon.set_homing(true);
  falcon.hand.move({0, 0, 0.172}, 0.2);
  falcon.advance(1);
  CHECK(falcon.homed() == 0);
  falcon.hand.move({0, 0, 0.080}, 0.5);
  unsigned seen = 0;
  int jumps = 0;
  for (auto last = falcon.encoders(); falcon.time() < 3;) {
    falcon.advance(0.001);
    const auto now = falcon.encoders();
    for (std::size_t i = 0; i < 3; ++i) jumps += std::abs(now[i] - last[i]) > 60 ? 1 : 0;
    if (falcon.homed() == 1 || falcon.homed() == 3) seen |= falcon.homed();
    last = now;
  }
  CHECK(seen == 3);
  CHECK(jumps == 3);
}

TEST_CASE("falcon mechanics: the same seed gives the same run") {
  FalconMechanics a({.seed = 9}), b({.seed = 9}), c({.seed = 10});
  CHECK(a.encoders() == b.encoders());
  CHECK(a.encoders() != c.encoders());
  for (FalconMechanics* falcon : {&a, &b}) {
    falcon->hand.tremor = 0.002;
    falcon->set_dac({500, -300, 4000});
    falcon->advance(0.5);
  }
  CHECK(a.position().x == b.position().x);
  CHECK(a.position().z == b.position().z);
  CHECK(a.work().hand == b.work().hand);
}

TEST_CASE("hand: a minimum-jerk path, moves in a row, a tremor") {
  Hand hand;
  hand.move({0, 0, 0.1}, 0);
  CHECK(hand.target().z == 0.1);
  CHECK(hand.at_rest());
  hand.move({0, 0, 0.2}, 1);
  hand.then({0, 0.1, 0.2}, 1);
  hand.advance(0.5);
  CHECK(hand.target().z == Approx(0.15));
  CHECK(hand.target_velocity().z == Approx(0.1 * 1.875));
  const double before = hand.target().z, slope = hand.target_velocity().z;
  hand.advance(1e-6);
  CHECK((hand.target().z - before) / 1e-6 == Approx(slope).epsilon(1e-4));
  hand.advance(0.5);
  hand.advance(0.5);
  CHECK(hand.target().y == Approx(0.05));
  CHECK_FALSE(hand.at_rest());
  hand.advance(0.6);
  CHECK(hand.at_rest());
  hand.damping = 0;
  hand.tremor = 0.001;
  CHECK(norm(hand.force(hand.target(), {})) > 0);
}
