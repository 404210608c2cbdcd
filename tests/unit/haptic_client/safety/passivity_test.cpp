#include "haptic_client/safety/passivity.h"

#include "common/text.h"
#include "haptic_client/device/simulated_operator.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/catch.h"
#include "tests/support/closed_loop.h"

using namespace palpate;
using namespace palpate::client;

namespace {

constexpr double kTick = 1e-3;  // s

/// Writes down what the motors do to the hand, from where it really is.
class Ledger : public Device {
 public:
  explicit Ledger(Device& device) : device_(device) {}
  DeviceReading read(Time now) noexcept override {
    const DeviceReading reading = device_.read(now);
    if (reads_++ > 0) work_ += force_.dot(reading.p_D - place_);
    place_ = reading.p_D;
    return reading;
  }
  void write(const Vec3& f_D) noexcept override {
    force_ = f_D;
    device_.write(f_D);
  }
  double work() const { return work_; }
  const Vec3& place() const { return place_; }

 private:
  Device& device_;
  Vec3 place_ = Vec3::Zero(), force_ = Vec3::Zero();
  double work_ = 0;
  int reads_ = 0;
};

struct Hand {
  const char* name;
  OperatorSettings settings;
};
const Hand kHands[] = {
    {"light", {.mass = 0.1, .device_damping = 1, .hand_stiffness = 200, .hand_damping = 5}},
    {"typical", {.mass = 0.3, .device_damping = 2, .hand_stiffness = 300, .hand_damping = 10}},
    {"heavy, loose", {.mass = 0.6, .device_damping = 1, .hand_stiffness = 100, .hand_damping = 5}}};

struct Press {
  double work;   // J that the motors gave in the end
  double speed;  // m/s, RMS, of the last three of eight seconds
};

/// A hand presses against a wall with 1.5 N and holds.
Press press(const OperatorSettings& hand, const char* law, double stiffness, bool passivity) {
  const double target = -1.5 / stiffness - 1.5 / hand.hand_stiffness;
  SimulatedOperator person(hand,
                           Trajectory({0, 2, 3}, {Vec3(0, 0.01, 0), Vec3(0, 0.01, 0), Vec3(0, target, 0)}));
  Ledger ledger(person);
  Pipeline pipeline(find_row(extrapolators(), law, "method", "test").make(), {}, {}, {.enabled = passivity});
  test::ClosedLoop loop(ledger, pipeline, test::served(test::wall(stiffness)), {});
  double squares = 0;
  int count = 0;
  while (loop.seconds() < 8) {
    const Vec3 before = ledger.place();
    loop.tick();
    if (loop.seconds() < 5) continue;
    squares += ((ledger.place() - before) / kTick).squaredNorm();
    ++count;
  }
  return {ledger.work(), std::sqrt(squares / count)};
}

}  // namespace

TEST_CASE("credit is used up first, then the share falls with the square of what is owed") {
  Passivity passivity({.debt = 2e-3, .allowance = 0});
  CHECK(passivity.share(kTick) == 1);
  passivity.wrote({0, 2, 0});
  passivity.moved({0.5, -0.003, 0}, kTick);  // 6 mJ put in; sideways costs nothing
  CHECK(passivity.share(kTick) == 1);
  passivity.moved({0, 0.003, 0}, kTick);  // and given back
  CHECK(passivity.share(kTick) == Approx(1));
  passivity.moved({0, 0.001, 0}, kTick);  // 2 mJ too much
  CHECK(passivity.share(kTick) == Approx(std::exp(-1)));
  passivity.moved({0, 0.001, 0}, kTick);
  CHECK(passivity.share(kTick) == Approx(std::exp(-4)));
  CHECK(passivity.counts().largest_debt_j == Approx(4e-3));
  passivity.moved({0, -0.1, 0}, kTick);
  CHECK(passivity.share(kTick) == Approx(std::exp(-4) + 0.01));  // all again within 100 ms
  CHECK(passivity.counts().reduced == 3);
}

TEST_CASE("debt is forgiven at the allowance, where nothing pushes credit goes at once, debt within 0.3 s") {
  Passivity passivity({.debt = 1e-3, .allowance = 1e-2});
  const auto owed = [&] { return std::sqrt(-std::log(passivity.share(10))) * 1e-3; };
  passivity.wrote({0, 1, 0});
  passivity.moved({0, 0.002, 0}, 0);  // no time, no change
  CHECK(passivity.share(10) == 1);
  passivity.moved({0, 0.00201, 0}, kTick);
  CHECK(owed() == Approx(2e-3));
  passivity.moved({0, 0, 0}, 0.05);
  CHECK(owed() == Approx(1.5e-3));
  passivity.wrote(Vec3::Zero());
  passivity.moved({0, 1, 0}, 0.1);
  CHECK(owed() == Approx(0.5e-3 * std::exp(-1.0 / 3)));
  passivity.moved({0, 1, 0}, 1);
  CHECK(passivity.share(10) == 1);
  passivity.wrote({0, 1, 0});
  passivity.moved({0, -0.01, 0}, kTick);  // 10 mJ of credit
  passivity.wrote(Vec3::Zero());
  passivity.moved({0, 0, 0}, kTick);  // gone
  passivity.wrote({0, 1, 0});
  passivity.moved({0, 0.00101, 0}, kTick);
  CHECK(owed() == Approx(1e-3));
  passivity.forgive();
  CHECK(passivity.share(10) == 1);
}

TEST_CASE("what is not finite does not spoil the account") {
  Passivity passivity({});
  passivity.wrote({0, 1, 0});
  passivity.moved({0, std::numeric_limits<double>::infinity(), 0}, kTick);
  passivity.moved({0, std::nan(""), 0}, kTick);
  CHECK(passivity.share(kTick) == 1);
}

TEST_CASE("walls of 100 N/m to 20 kN/m at 30 Hz and 35 ms, three hands: the motors give next to nothing") {
  const Passivity::Settings settings;
  for (const Hand& hand : kHands) {
    for (const char* law : {"constant", "linear_time", "linear_position", "linear_position_signed"}) {
      for (const double stiffness : {100.0, 300.0, 1e3, 3e3, 1e4, 2e4}) {
        CAPTURE(hand.name, law, stiffness);
        const Press felt = press(hand.settings, law, stiffness, true);
        CHECK(felt.work <= settings.allowance * 8 + 2 * settings.debt);
        CHECK(felt.speed < 0.03);  // m/s; without it up to 0.8
      }
    }
  }
}

TEST_CASE("without passivity a stiff wall throws the hand about, and it changes nothing where all is well") {
  const Press wild = press(kHands[0].settings, "constant", 2e4, false);
  CHECK(wild.work > 1);
  CHECK(wild.speed > 0.1);
  const Press soft = press(kHands[1].settings, "constant", 100, true),
              same = press(kHands[1].settings, "constant", 100, false);
  CHECK(soft.work == same.work);
}
