#include "tests/emulation/usb_device.h"

#include <cerrno>
#include <nlohmann/json.hpp>

#include "tests/emulation/falcon.h"
#include "tests/emulation/spacemouse.h"
#include "tests/support/catch.h"

using namespace palpate::emulation;

namespace {

/// An I/O packet to a Falcon whose firmware runs, and its reply.
FalconPacket exchange(Falcon& falcon, const FalconPacket& request) {
  falcon.request({0x40, 9, 1, 0, 0}, {}, 0);
  falcon.request({0x40, 3, 2, 0, 0}, {}, 0);
  falcon.write(0x02, encode(request), 0);
  const auto in = falcon.read(0x81, 64, 0);
  REQUIRE(in);
  FalconPacketParser parser;
  for (std::size_t i = 2; i < in->data.size(); ++i) parser.feed(in->data[i]);
  const auto reply = parser.next();
  REQUIRE(reply);
  return *reply;
}

bool holds(const std::string& text, const std::string& part) {
  CAPTURE(text, part);
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("usb device: standard requests come from the descriptors, all lengths are right") {
  Falcon falcon({});
  SpaceMouse two(SpaceMouse::Layout::kTwoReports), one(SpaceMouse::Layout::kOneReport),
      receiver(SpaceMouse::Layout::kReceiver);
  for (UsbDevice* device : {static_cast<UsbDevice*>(&falcon), static_cast<UsbDevice*>(&two),
                            static_cast<UsbDevice*>(&one), static_cast<UsbDevice*>(&receiver)}) {
    const Bytes all = device->descriptors();
    std::size_t end = 0;
    while (end < all.size()) end += all[end];
    CHECK(end == all.size());
    CHECK(18u + all[20] + 256u * all[21] == all.size());  // wTotalLength
    CHECK(device->control({0x80, 6, 0x0100, 0, 18}, {}, 0).data == Bytes(all.begin(), all.begin() + 18));
    CHECK(device->control({0x80, 6, 0x0200, 0, 9}, {}, 0).data.size() == 9);
    CHECK(device->control({0x80, 6, 0x0302, 0, 255}, {}, 0).data[1] == 3);
    CHECK(device->control({0x80, 6, 0x0307, 0, 255}, {}, 0).status == -EPIPE);
    CHECK(device->control({0x80, 8, 0, 0, 1}, {}, 0).data == Bytes{1});
    CHECK(device->control({0x40, 77, 0, 0, 0}, {}, 0).status == -EPIPE);
    CHECK(device->write(0x05, {1}, 0) == -EPIPE);
    CHECK_THROWS_AS(device->command("dance", {}, 0), CommandError);
    CHECK_THROWS_AS(device->command("fault", {"nonsense"}, 0), CommandError);
    CHECK_THROWS_AS(device->command("fault", {"busy", "x"}, 0), CommandError);
    device->command("fault", {"busy"}, 0);
    CHECK(device->busy());
  }
  const auto report = two.control({0x81, 6, 0x2200, 0, 255}, {}, 0);
  CHECK(report.data.size() == two.descriptors()[18 + 9 + 9 + 7]);
}

TEST_CASE("falcon: virtual time moves with the packets, and counts what came before homing") {
  Falcon falcon({.loaded = true});
  exchange(falcon, {{0, 100, -3000}, kHomingBit | kRedBit, 0});
  exchange(falcon, {{0, 0, 0}, kHomingBit | kGreenBit, 0});
  falcon.command("homing", {"now"}, 0);
  exchange(falcon, {{5000, 0, 0}, kHomingBit, 0});
  const std::string state = falcon.state(55);
  CHECK(holds(state, "\"packets\":3,"));
  CHECK(holds(state, "\"time\":0.003}"));
  CHECK(holds(state, "\"largest_dac\":5000,"));
  CHECK(holds(state, "\"largest_dac_unhomed\":3000,"));
  CHECK(holds(state, "\"dac\":[4096,0,0],\"wished_dac\":[5000,0,0]"));
}

TEST_CASE("falcon: buttons, references and frozen encoders in the reply") {
  Falcon falcon({.loaded = true, .homed = true});
  falcon.command("buttons", {"5"}, 0);
  const auto reply = exchange(falcon, {{}, kHomingBit, 0});
  CHECK(reply.flags == 0x75);
  CHECK(reply.numbers == std::array<std::int16_t, 3>{-516, -516, -516});
  falcon.command("fault", {"freeze"}, 0);
  falcon.command("hand", {"place", "0.01", "0.02", "0.12"}, 0);
  CHECK(exchange(falcon, {{}, kHomingBit, 0}).numbers == reply.numbers);
  falcon.command("fault", {"freeze", "0"}, 0);
  CHECK(exchange(falcon, {{}, kHomingBit, 0}).numbers != reply.numbers);
  CHECK_THROWS_AS(falcon.command("hand", {"place", "0", "0", "0.29"}, 0), CommandError);
  CHECK(exchange(falcon, {}).flags == 5);  // without the homing bit
}

TEST_CASE("falcon: commands that wait for a packet run at that packet, in order") {
  Falcon falcon({.loaded = true, .homed = true});
  falcon.command("at", {"3", "buttons", "2"}, 0);
  falcon.command("at", {"5", "buttons", "9"}, 0);
  for (const int expected : {0, 0, 0, 2, 2, 9, 9})
    CHECK((exchange(falcon, {{}, kHomingBit, 0}).flags & 15) == expected);
}

TEST_CASE("falcon: garbage stands before the reply, stale bytes wait for the next open") {
  Falcon falcon({.loaded = true});
  falcon.command("fault", {"garbage", "7"}, 0);
  falcon.command("fault", {"stale", "5"}, 0);
  falcon.opened(0);
  falcon.request({0x40, 9, 1, 0, 0}, {}, 0);
  CHECK(falcon.read(0x81, 64, 0)->data.size() == 7);
  falcon.request({0x40, 3, 2, 0, 0}, {}, 0);
  falcon.write(0x02, encode({}), 0);
  const Bytes in = falcon.read(0x81, 64, 0)->data;
  REQUIRE(in.size() == 2 + 7 + 16);
  CHECK(in[9] == '<');
}

TEST_CASE("falcon: power-up loses firmware and references, the mains take force and homing") {
  Falcon falcon({.loaded = true, .homed = true});
  falcon.command("power", {"off"}, 0);
  exchange(falcon, {{1000, 1000, 1000}, kHomingBit, 0});
  CHECK(holds(falcon.state(0), "\"force\":[0,0,0]"));
  falcon.command("power", {"on"}, 0);
  CHECK_FALSE(holds(falcon.state(0), "\"force\":[0,0,0]"));
  falcon.power_up(0);
  CHECK(holds(falcon.state(0), "\"homed\":0,"));
  CHECK(holds(falcon.state(0), "\"loaded\":false,"));
}

TEST_CASE("falcon: on the wall clock time passes without packets") {
  Falcon falcon({.wall = true, .loaded = true});
  falcon.power_up(10);
  falcon.command("hand", {"target", "0.02", "0", "0.12"}, 10);
  for (int i = 1; i <= 50; ++i) falcon.advance(10 + 0.02 * i);
  const auto state = nlohmann::json::parse(falcon.state(11));
  CHECK(state["position"][0].get<double>() == Approx(0.02).margin(1e-3));
  CHECK(state["time"].get<double>() == Approx(1));
}

TEST_CASE("spacemouse: reports every 8 ms while deflected, zeros once when released, then nothing") {
  SpaceMouse mouse(SpaceMouse::Layout::kTwoReports);
  CHECK_FALSE(mouse.read(0x81, 64, 1));
  CHECK(mouse.wake_at(1) == UsbDevice::kNever);
  mouse.command("mouse", {"350", "-350", "1", "0", "0", "2"}, 1);
  CHECK(mouse.read(0x81, 64, 1)->data == Bytes{1, 0x5e, 0x01, 0xa2, 0xfe, 1, 0});
  CHECK(mouse.read(0x81, 64, 1)->data == Bytes{2, 0, 0, 0, 0, 2, 0});
  CHECK_FALSE(mouse.read(0x81, 64, 1.0079));
  CHECK(mouse.wake_at(1) == Approx(1.008));
  CHECK(mouse.read(0x81, 64, 1.0081));
  CHECK(mouse.read(0x81, 64, 1.0081));
  mouse.command("mouse", {"0", "0", "0", "0", "0", "0"}, 1);
  CHECK(mouse.read(0x81, 64, 1.017)->data == Bytes{1, 0, 0, 0, 0, 0, 0});
  CHECK(mouse.read(0x81, 64, 1.017)->data == Bytes{2, 0, 0, 0, 0, 0, 0});
  CHECK_FALSE(mouse.read(0x81, 64, 1.1));
  CHECK(mouse.wake_at(1.1) == UsbDevice::kNever);
  CHECK_THROWS_AS(mouse.command("mouse", {"1"}, 1), CommandError);
}
