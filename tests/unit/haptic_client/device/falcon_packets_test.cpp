#include "haptic_client/device/falcon_packets.h"

#include <string>
#include <vector>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;

namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes;
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}
std::string text_of(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) text += static_cast<char>(b);
  return text;
}
std::vector<FalconStatus> all_of(FalconStream& stream, const std::string& text) {
  std::vector<FalconStatus> found;
  stream.push(bytes_of(text), [&](const FalconStatus& status) { found.push_back(status); });
  return found;
}

// Nibbles 9, 5, A, F with the least first: 0xFA59 = -1447; 1; -1. Buttons 1 and 4, all three homed (flags
// 0x75).
const std::string kReply =
    "<JFKPBAAAPPPP\xb6"
    "A>";

}  // namespace

TEST_CASE("Falcon command: nibbles, least significant first, as letters") {
  CHECK(text_of(encode_falcon({})) == "<AAAAAAAAAAAABA>");  // homing on, nothing else
  CHECK(text_of(encode_falcon({.torque = {1, -1, 0x123}, .homing = false})) == "<BAAAPPPPDCBAAA>");
  CHECK(text_of(encode_falcon({.torque = {4096, -4096, 0}, .green = true, .blue = true, .red = true})) ==
        "<AAABAAAPAAAAPA>");
  CHECK(encode_falcon({.torque = {32767, -32768, 0}}) == encode_falcon({.torque = {4096, -4096, 0}}));
}

TEST_CASE("Falcon reply: encoders, buttons, homed flags") {
  FalconStream stream;
  const auto found = all_of(stream, kReply);
  REQUIRE(found.size() == 1);
  CHECK(found[0].encoder == std::array<std::int16_t, 3>{-1447, 1, -1});
  CHECK(found[0].buttons == 5);
  CHECK(found[0].all_homed());
  CHECK(stream.rubbish() == 0);
}

TEST_CASE("Falcon stream: split anywhere, joined, behind rubbish, cut short") {
  for (std::size_t at = 0; at <= kReply.size(); ++at) {
    FalconStream stream;
    CHECK(all_of(stream, kReply.substr(0, at)).size() + all_of(stream, kReply.substr(at)).size() == 1);
  }
  FalconStream stream;
  CHECK(all_of(stream, kReply + kReply + kReply).size() == 3);
  CHECK(all_of(stream, "rubbish<<><" + kReply).size() == 1);
  CHECK(stream.rubbish() == 11);
  for (std::size_t cut = 1; cut < kReply.size(); ++cut)
    CHECK(all_of(stream, kReply.substr(0, cut) + kReply).size() == 1);
}

TEST_CASE("Falcon stream: a byte that is none of a packet's spoils that packet only") {
  for (std::size_t at = 1; at < kReply.size() - 1; ++at) {
    std::string spoilt = kReply;
    spoilt[at] = at == 13 ? '\x40' : 'Q';
    FalconStream stream;
    CHECK(all_of(stream, spoilt + kReply).size() == (at == 14 ? 2u : 1u));  // byte 14 says nothing
  }
}

TEST_CASE("Falcon stream: random bytes give no harm and no memory") {
  test::Random random(5);
  FalconStream stream;
  std::array<std::byte, 64> bytes{};
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 20000; ++i) {
      for (std::byte& b : bytes) b = static_cast<std::byte>('<' + random.bits() % 24);
      stream.push(bytes, [](const FalconStatus&) {});
    }
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  // Fifteen bytes more than a packet: whatever half packet waits is over then.
  all_of(stream, std::string(16, 'x'));
  CHECK(all_of(stream, kReply).size() == 1);
}

TEST_CASE("FTDI status bytes go, two in front of every 64-byte packet") {
  std::string transfer;
  std::string payload;
  for (int i = 0; i < 150; ++i) payload += static_cast<char>('a' + i % 26);
  for (std::size_t at = 0; at < payload.size(); at += 62) transfer += "\x01\x60" + payload.substr(at, 62);
  std::vector<std::byte> out(transfer.size());
  out.resize(strip_ftdi_status(bytes_of(transfer), out));
  CHECK(text_of(out) == payload);
  for (const std::string& nothing : {std::string(), std::string("\x01"), std::string("\x01\x60")}) {
    std::vector<std::byte> none(64);
    CHECK(strip_ftdi_status(bytes_of(nothing), none) == 0);
  }
}
