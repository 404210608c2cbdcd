// The states of the Falcon over a port that says what a test wants.
#include "haptic_client/device/falcon_machine.h"

#include <deque>
#include <vector>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

namespace {

using Packet = std::vector<std::byte>;

/// Two status bytes and what firmware answers; both ways have the same bytes, but for the flags.
Packet reply(bool homed) {
  Packet packet{std::byte{0x01}, std::byte{0x60}};
  const auto bytes = encode_falcon({.homing = false});
  packet.insert(packet.end(), bytes.begin(), bytes.end());
  if (homed) packet[kFtdiStatus + 13] = std::byte{0x41 + 0x70};
  return packet;
}

struct Port : UsbTransport {
  std::deque<Packet> incoming;
  bool flood = false, lost = false;
  const char* why = "";
  int written = 0;

  bool open(Time) noexcept override {
    lost = false;
    return true;
  }
  void close() noexcept override { lost = false; }
  void control(const UsbRequest&) noexcept override {}
  bool write(std::span<const std::byte>) noexcept override {
    ++written;
    return true;
  }
  std::size_t read(std::span<std::byte> out) noexcept override {
    if (flood) return kFtdiStatus;
    if (incoming.empty()) return 0;
    const Packet packet = incoming.front();
    incoming.pop_front();
    std::ranges::copy(packet, out.begin());
    return packet.size();
  }
  State state() const noexcept override { return lost ? State::kLost : State::kIdle; }
  const char* trouble() const noexcept override { return why; }
};

struct Desk {
  Port port;
  FalconMachine machine{{}};
  int tick = 0;
  void poll(int times = 1) {
    for (const int end = tick + times; tick < end; ++tick) machine.poll(port, from_seconds(1 + tick * 1e-3));
  }
  std::string says() const { return machine.message(); }
};

}  // namespace

TEST_CASE("Falcon: an answer of another session, before anything was asked, is none") {
  Desk desk;
  desk.poll();
  desk.port.incoming.push_back(reply(true));
  desk.poll();
  CHECK(desk.machine.phase() == FalconPhase::kProbe);
  CHECK(desk.port.written == 1);
  for (int i = 0; i < 2; ++i) {
    desk.port.incoming.push_back(reply(true));
    desk.poll();
  }
  CHECK(desk.machine.phase() == FalconPhase::kReady);
}

TEST_CASE("Falcon: a flood of packets ends the tick all the same") {
  Desk desk;
  desk.poll();
  desk.port.flood = true;
  desk.poll(10);
  CHECK(desk.machine.phase() == FalconPhase::kProbe);
}

TEST_CASE("Falcon: without an image it says so once, and goes on trying in silence") {
  Desk desk;
  std::vector<std::string> said;
  for (int i = 0; i < 20'000; ++i) {
    desk.poll();
    if (said.empty() || said.back() != desk.says()) said.push_back(desk.says());
  }
  REQUIRE(said.size() == 2);
  CHECK(said[0] == "looking for a Falcon");
  CHECK(said[1].find("no firmware yet") != std::string::npos);
}

TEST_CASE("Falcon: a failed transfer is told as such, a Falcon that is gone as unplugged") {
  Desk desk;
  desk.poll();
  desk.port.lost = true;
  desk.port.why = "a USB transfer failed";
  desk.poll();
  CHECK(desk.says() == "a USB transfer failed");
  desk.port.why = "";
  desk.poll(100);  // it is taken up again within 20 ms: it may still push
  desk.port.lost = true;
  desk.poll();
  CHECK(desk.says().find("unplugged") != std::string::npos);
}
