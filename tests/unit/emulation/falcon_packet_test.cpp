#include "tests/emulation/falcon_packet.h"

#include <string>

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate::emulation;
using palpate::test::Random;

namespace {

Bytes bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

std::vector<FalconPacket> parse(const Bytes& stream) {
  FalconPacketParser parser;
  std::vector<FalconPacket> packets;
  for (const std::uint8_t byte : stream) {
    parser.feed(byte);
    while (const auto packet = parser.next()) packets.push_back(*packet);
  }
  return packets;
}

FalconPacket draw(Random& random) {
  FalconPacket packet;
  for (auto& number : packet.numbers) number = static_cast<std::int16_t>(random.bits());
  packet.flags = static_cast<std::uint8_t>(random.bits() & 0x7f);
  return packet;
}

}  // namespace

TEST_CASE("falcon packet: golden bytes, the lowest nibble first, two's complement") {
  CHECK(encode({{0, 0, 0}, 0, 0}) == bytes("<AAAAAAAAAAAAAA>"));
  CHECK(encode({{0x1234, -1, -1447}, kHomingBit | kRedBit, 0}) == bytes("<EDCBPPPPJFKPJA>"));
  const auto packets = parse(bytes("<JFKPAAAAAAAAAA>"));
  REQUIRE(packets.size() == 1);
  CHECK(packets[0].numbers[0] == -1447);
}

TEST_CASE("falcon packet: all three references make a byte beyond ASCII") {
  const Bytes reply = encode({{}, 0x7f, 0});
  CHECK(reply[13] == 0xc0);
  CHECK(parse(reply).at(0).flags == 0x7f);
}

TEST_CASE("falcon packet: random packets come back, through any garbage before and between them") {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<FalconPacket> sent;
    Bytes stream;
    for (int i = 0; i < 5; ++i) {
      for (auto k = random.bits() % 20; k > 0; --k) {
        const auto garbage = static_cast<std::uint8_t>(random.bits());
        if (garbage != '<') stream.push_back(garbage);
      }
      sent.push_back(draw(random));
      const Bytes packet = encode(sent.back());
      stream.insert(stream.end(), packet.begin(), packet.end());
    }
    CHECK(parse(stream) == sent);
  }
}

TEST_CASE("falcon packet: cut or wrong packets are skipped, and the next one is found") {
  const std::string good = "<BAAAAAAAAAAAAA>";
  for (const std::string bad :
       {"<", "<AAAA", "<AAAAAAAAAAAAAAA", "<AAAAZAAAAAAAAA>", "<AAAAAAAAAAAA!A>", "<<<<", ">"}) {
    CAPTURE(bad);
    const auto packets = parse(bytes(bad + good));
    REQUIRE(packets.size() == 1);
    CHECK(packets[0].numbers[0] == 1);
  }
}
