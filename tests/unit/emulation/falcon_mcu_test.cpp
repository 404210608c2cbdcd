#include "tests/emulation/falcon_mcu.h"

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate::emulation;

namespace {

const Bytes kGreeting{0x0a, 0x43, 0x0d}, kAnswer{0x0a, 0x44, 0x2c, 0x0d};
constexpr double kGreetingBaud = 9600, kLoadingBaud = 142857, kRunningBaud = 1.5e6;

struct Board {
  FalconFaults faults;
  FalconMcu mcu{faults, [](const FalconPacket& request) {
                  return FalconPacket{{request.numbers[2], request.numbers[1], request.numbers[0]}, 5, 0};
                }};

  Bytes say(const Bytes& bytes, double baud) {
    Bytes all;
    for (const Bytes& message : mcu.receive(bytes, baud))
      all.insert(all.end(), message.begin(), message.end());
    return all;
  }
  void reset() {
    mcu.set_dtr(false);
    mcu.set_dtr(true);
  }
  /// The whole load; true if every echo was right.
  bool load(std::size_t size = 8192) {
    palpate::test::Random random(6);
    reset();
    if (say(kGreeting, kGreetingBaud) != kAnswer) return false;
    mcu.set_dtr(false);
    if (say({0x41}, kLoadingBaud) != Bytes{0x41}) return false;
    bool right = true;
    for (std::size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<std::uint8_t>(random.bits());
      right = say({byte}, kLoadingBaud) == Bytes{byte} && right;
    }
    mcu.set_baud(kRunningBaud);
    return right;
  }
};

}  // namespace

TEST_CASE("falcon microcontroller: greeting, echo of the image, then the firmware answers packets") {
  Board board;
  CHECK(board.say(encode({}), kRunningBaud).empty());
  CHECK_FALSE(board.mcu.ready());
  REQUIRE(board.load());
  CHECK(board.mcu.running());
  CHECK(board.mcu.image().size() == 8192);
  CHECK(board.say(encode({{1, 2, 3}, 0, 0}), kRunningBaud) == encode({{3, 2, 1}, 5, 0}));
}

TEST_CASE("falcon microcontroller: at the wrong baud rate it understands nothing") {
  Board board;
  CHECK(board.say(kGreeting, kLoadingBaud).empty());
  CHECK(board.say(kGreeting, 9500) == kAnswer);  // within what a UART forgives
  CHECK(board.mcu.ready());
  CHECK(board.say({0x41}, kGreetingBaud).empty());
  CHECK(board.say({0x41}, kLoadingBaud) == Bytes{0x41});
  board.mcu.start_firmware();
  CHECK(board.say(encode({}), kLoadingBaud).empty());
}

TEST_CASE("falcon microcontroller: DTR that rises, and power, lose the firmware, DTR that falls does not") {
  Board board;
  REQUIRE(board.load());
  board.mcu.set_dtr(false);
  CHECK(board.mcu.running());
  board.mcu.set_dtr(true);
  CHECK_FALSE(board.mcu.running());
  REQUIRE(board.load());
  board.mcu.power_up();
  CHECK_FALSE(board.mcu.running());
  CHECK(board.mcu.image().empty());
}

TEST_CASE("falcon microcontroller: half an image does not start") {
  Board board;
  CHECK(board.load(2000));
  CHECK_FALSE(board.mcu.running());
}

TEST_CASE("falcon microcontroller: a loader that fails as often as told, and then loads") {
  struct Case {
    int FalconFaults::*fault;
    int times;
  };
  for (const Case& one : {Case{&FalconFaults::loader_silent, 3},
                          {&FalconFaults::loader_fails, 2},
                          {&FalconFaults::echo_corrupt, 1}}) {
    Board board;
    board.faults.*one.fault = one.times;
    for (int i = 0; i < one.times; ++i) {
      CHECK_FALSE(board.load());
      CHECK_FALSE(board.mcu.running());
    }
    CHECK(board.load());
    CHECK(board.mcu.running());
  }
}

TEST_CASE("falcon microcontroller: the stray bytes that hosts have seen, and silence") {
  Board board;
  board.faults.loader_zero = board.faults.loader_xoff = 1;
  CHECK(board.say(kGreeting, kGreetingBaud) == Bytes{0, 0x0a, 0x44, 0x2c, 0x0d});
  CHECK(board.say({0x41}, kLoadingBaud) == Bytes{0x13, 0x41});
  board.faults.mute = 1;
  CHECK(board.say({1, 2, 3}, kLoadingBaud).empty());
}

TEST_CASE("falcon microcontroller: packets in pieces and in a row get one reply each") {
  Board board;
  board.mcu.start_firmware();
  const Bytes packet = encode({{7, 8, 9}, 0, 0}), reply = encode({{9, 8, 7}, 5, 0});
  CHECK(board.mcu.receive({packet.begin(), packet.begin() + 5}, kRunningBaud).empty());
  CHECK(board.mcu.receive({packet.begin() + 5, packet.end()}, kRunningBaud) == std::vector<Bytes>{reply});
  Bytes two = packet;
  two.insert(two.end(), packet.begin(), packet.end());
  CHECK(board.mcu.receive(two, kRunningBaud) == std::vector<Bytes>{reply, reply});
}
