#include "tests/emulation/ft232r.h"

#include <cerrno>

#include "tests/support/catch.h"

using namespace palpate::emulation;

namespace {

/// A chip with an echo on its line.
struct Bench {
  explicit Bench(bool wall = false) : chip(faults, line(), wall) {}

  Ft232r::Line line() {
    return {[](const Bytes& bytes, double) { return std::vector<Bytes>{bytes}; }, [](double) {},
            [this](bool high) { dtr = high ? 1 : 0; }, [] { return false; }};
  }
  int set(std::uint8_t request, std::uint16_t value) {
    return chip.request({0x40, request, value, 0, 0}, now).status;
  }
  /// The next transfer's payload, without the status bytes; a negative number is their absence.
  int payload(std::size_t room = 512) {
    const auto result = chip.read(room, now);
    return result ? static_cast<int>(result->data.size()) - 2 : -1;
  }
  FalconFaults faults;
  int dtr = -1;
  double now = 100;  // s
  Ft232r chip;
};

Bytes text(std::size_t size) {
  Bytes bytes;
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(i));
  return bytes;
}

}  // namespace

TEST_CASE("ft232r: baud rates of the divisors a Falcon needs") {
  CHECK(baud_of_divisor(0x4138) == 9600);
  CHECK(baud_of_divisor(0x0015) == Approx(142857.1));
  CHECK(baud_of_divisor(0x0002) == 1.5e6);
  CHECK(baud_of_divisor(0) == 3e6);
  CHECK(baud_of_divisor(0xc001 + 0x0f) == Approx(3e6 / 16.125));
}

TEST_CASE("ft232r: its memory tells the ids and names of a Falcon, with the checksum that libftdi asks for") {
  Bench bench;
  std::vector<unsigned> words;
  for (std::uint16_t index = 0; index < 64; ++index) {
    const auto word = bench.chip.request({0xc0, 0x90, 0, index, 2}, bench.now);
    REQUIRE(word.status == 0);
    REQUIRE(word.data.size() == 2);
    words.push_back(word.data[0] | static_cast<unsigned>(word.data[1]) << 8);
  }
  CHECK(words[1] == 0x0403);
  CHECK(words[2] == 0xcb48);
  CHECK(words[3] == 0x0600);
  unsigned checksum = 0xaaaa;  // libftdi, ftdi_eeprom_decode
  for (std::size_t i = 0; i < 63; ++i) {
    checksum ^= words[i];
    checksum = ((checksum << 1) | (checksum >> 15)) & 0xffff;
  }
  CHECK(checksum == words[63]);
  const auto text_at = [&](std::size_t entry) {  // word: place with bit 7, size of the descriptor
    std::string text;
    const unsigned at = words[entry] & 0x7f, size = words[entry] >> 8;
    for (unsigned i = 2; i < size; i += 2) {
      const unsigned byte = at + i;
      text.push_back(static_cast<char>(words[byte / 2] >> (byte % 2 * 8) & 0xff));
    }
    return text;
  };
  CHECK(text_at(7) == "FTDI");
  CHECK(text_at(8) == "FALCON HAPTIC");
  CHECK(bench.chip.request({0xc0, 0x90, 0, 64, 2}, bench.now).status == -EPIPE);
}

TEST_CASE("ft232r: two status bytes alone whenever the latency timer has run out") {
  Bench bench;
  REQUIRE(bench.set(9, 16) == 0);
  CHECK(bench.payload() == 0);
  CHECK(bench.payload() == -1);
  CHECK(bench.chip.wake_at() == Approx(bench.now + 0.016));
  bench.now += 0.0161;
  const auto status = bench.chip.read(64, bench.now);
  REQUIRE(status);
  CHECK(status->data == Bytes{0x01, 0x60});
}

TEST_CASE(
    "ft232r: with a timer of 1 ms data comes at once, with 16 ms when it has run out or 62 bytes are there") {
  Bench bench;
  bench.set(9, 1);
  bench.payload();
  bench.chip.write(text(4), bench.now);
  CHECK(bench.payload() == 4);
  bench.set(9, 16);
  bench.chip.write(text(4), bench.now);
  CHECK(bench.payload() == -1);
  bench.chip.write(text(58), bench.now);
  CHECK(bench.payload(64) == 62);
  bench.chip.write(text(4), bench.now);
  CHECK(bench.payload() == -1);
  bench.now += 0.0161;
  CHECK(bench.payload() == 4);
  CHECK(bench.chip.request({0xc0, 10, 0, 0, 1}, 0).data == Bytes{16});
}

TEST_CASE("ft232r: every 64 bytes begin with their own status") {
  Bench bench;
  bench.chip.write(text(100), bench.now);
  const auto result = bench.chip.read(512, bench.now);
  REQUIRE(result);
  CHECK(result->status == 0);
  REQUIRE(result->data.size() == 104);
  CHECK(result->data[1] == 0x60);
  CHECK(result->data[2] == 0);
  CHECK(result->data[63] == 61);
  CHECK(result->data[65] == 0x60);
  CHECK(result->data[66] == 62);
}

TEST_CASE("ft232r: a packet larger than the buffer overflows") {
  Bench bench;
  bench.chip.write(text(10), bench.now);
  const auto result = bench.chip.read(7, bench.now);
  REQUIRE(result);
  CHECK(result->status == -EOVERFLOW);
  CHECK(result->data.size() == 7);
}

TEST_CASE("ft232r: purge, modem lines, requests it does not know") {
  Bench bench;
  bench.chip.write(text(10), bench.now);
  CHECK(bench.set(0, 1) == 0);
  CHECK(bench.set(0, 2) == 0);
  CHECK(bench.chip.waiting() == 0);
  CHECK(bench.set(1, 0x0200) == 0);
  CHECK(bench.dtr == -1);  // the mask names RTS only
  bench.set(1, 0x0101);
  CHECK(bench.dtr == 1);
  bench.set(1, 0x0100);
  CHECK(bench.dtr == 0);
  CHECK(bench.set(2, 0) == 0);
  CHECK(bench.set(4, 8) == 0);
  CHECK(bench.set(99, 0) == -EPIPE);
  bench.faults.stall = 1;
  CHECK(bench.set(4, 8) == -EPIPE);
  CHECK(bench.set(4, 8) == 0);
}

TEST_CASE("ft232r: replies split, joined, after a flood of status, late, or of no bytes") {
  Bench bench;
  bench.set(9, 1);
  bench.faults.split = 1;
  bench.chip.write(text(16), bench.now);
  CHECK(bench.payload() == 14);
  CHECK(bench.payload() == 2);
  bench.faults = {};
  bench.faults.join = 1;
  bench.chip.write(text(16), bench.now);
  CHECK(bench.payload() == -1);
  bench.chip.write(text(16), bench.now);
  CHECK(bench.payload() == 32);
  bench.chip.write(text(16), bench.now);
  bench.now += 0.0031;  // the second never came
  CHECK(bench.payload() == 16);
  bench.faults = {};
  bench.faults.status_flood = 3;
  bench.chip.write(text(16), bench.now);
  for (int i = 0; i < 3; ++i) CHECK(bench.payload() == 0);
  CHECK(bench.payload() == 16);
  bench.faults = {};
  bench.faults.latency = 30;
  bench.chip.write(text(16), bench.now);
  CHECK(bench.payload() == -1);
  bench.now += 0.0301;
  CHECK(bench.payload() == 16);
  bench.faults.zero_in = 1;
  CHECK(bench.payload() == -2);
}

TEST_CASE("ft232r: on the wall clock bytes take their time on the line, and data its frame on the bus") {
  Bench bench(true);
  bench.set(9, 1);
  bench.set(3, 0x0002);
  bench.payload();
  bench.now += 0.0002;
  bench.chip.write(text(16), bench.now);
  CHECK(bench.payload() == -1);
  CHECK(bench.chip.wake_at() == Approx(100.001));
  bench.now = 100.0011;
  CHECK(bench.payload() == 16);
  bench.set(3, 0x4138);
  bench.chip.write(text(48), bench.now);  // 50 ms at 9600 baud, and 16 bytes of the echo
  for (int i = 0; i < 60; ++i, bench.now += 0.001) CHECK(bench.payload() <= 0);
  bench.now += 0.01;
  CHECK(bench.payload() == 48);
}
