#include <string>
#include <vector>

#include "protocol/link_frames.h"
#include "tests/support/catch.h"
#include "tests/support/hex.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::protocol;
using palpate::test::Bytes;
using palpate::test::bytes;
using palpate::test::hex;

namespace {

const std::string kAddresses4 = "c0a80001 c0a800c7 ";
const std::string kIp6 =
    "60000000 000b1140 20010db8000000000000000000000001 20010db8000000000000000000000002 ";

Endpoint v4(std::uint8_t last, std::uint16_t port) {
  return {.address = {192, 168, 0, last}, .port = port};
}
Endpoint v6(std::uint8_t last, std::uint16_t port) {
  return {.address = {0x20, 1, 0x0d, 0xb8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, last}, .port = port, .v6 = true};
}

/// RFC 1071, over bytes, without the code under test.
std::uint16_t ones_complement_sum(const Bytes& data) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    sum += std::to_integer<std::uint64_t>(data[i]) << (i % 2 == 0 ? 8 : 0);
  }
  while (sum >> 16 != 0) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint16_t>(sum);
}

Bytes built(const Endpoint& from, const Endpoint& to, const Bytes& payload, std::size_t length) {
  Bytes out(payload.size() + kMaxFrameHeaders);
  out.resize(build_frame(from, to, payload, length, out));
  return out;
}

/// The sum over the pseudo header and the datagram; 0xffff when its checksum is right.
std::uint16_t udp_sum(const Bytes& frame, bool v6) {
  const std::size_t ip = v6 ? 40 : 20;
  Bytes summed = bytes(fmt::format("0011{:08x}", frame.size() - ip));
  summed.insert(summed.end(), frame.begin() + (v6 ? 8 : 12), frame.end());
  return ones_complement_sum(summed);
}

}  // namespace

TEST_CASE("the independent checksum of these tests agrees with RFC 1071, section 3", "[capture]") {
  CHECK(ones_complement_sum(bytes("0001 f203 f4f5 f6f7")) == 0xddf2);
}

TEST_CASE("golden frames: headers and checksums as published or worked out elsewhere", "[capture]") {
  // The header of Wikipedia, "Internet checksum" (2024): b861.
  const Bytes known = built(v4(1, 4660), v4(199, 45130), Bytes(87), 87);
  CHECK(hex(known).substr(0, 40) == "45000073000040004011b861c0a80001c0a800c7");
  const Bytes pal = bytes("70616c");
  CHECK(hex(built(v4(1, 4660), v4(199, 45130), pal, 3)) ==
        hex(bytes("4500001f 00004000 4011b8b5" + kAddresses4 + "1234 b04a 000b dede 70616c")));
  CHECK(hex(built(v6(1, 4660), v6(2, 45130), pal, 3)) == hex(bytes(kIp6 + "1234 b04a 000b 0583 70616c")));
}

TEST_CASE("built frames parse to what they were built from, and their checksums hold", "[capture]") {
  test::Random random(11);
  for (int i = 0; i < 400; ++i) {
    const bool six = i % 2 == 1;
    Endpoint ends[2];
    for (Endpoint& end : ends) {
      for (std::size_t n = 0; n < (six ? 16 : 4); ++n)
        end.address[n] = static_cast<std::uint8_t>(random.bits());
      end.port = static_cast<std::uint16_t>(random.bits());
      end.v6 = six;
    }
    Bytes payload(i < 4 ? static_cast<std::size_t>(i) : random.bits() % 1300);
    for (std::byte& b : payload) b = static_cast<std::byte>(random.bits());
    const Bytes frame = built(ends[0], ends[1], payload, payload.size());
    REQUIRE(frame.size() == payload.size() + (six ? 48 : 28));
    REQUIRE(udp_sum(frame, six) == 0xffff);
    if (!six) REQUIRE(ones_complement_sum({frame.begin(), frame.begin() + 20}) == 0xffff);
    UdpFrame found;
    REQUIRE(parse_frame(LinkType::kRaw, frame, found) == FrameVerdict::kDatagram);
    REQUIRE(found.from == ends[0]);
    REQUIRE(found.to == ends[1]);
    REQUIRE(hex(found.payload) == hex(payload));
    REQUIRE(found.length == payload.size());
  }
}

TEST_CASE("a checksum that comes out as 0 is written as ffff", "[capture]") {
  Bytes payload = bytes("0000");
  const Bytes frame = built(v4(1, 4660), v4(199, 45130), payload, 2);
  payload = {frame[26], frame[27]};  // adding the checksum itself makes the sum ffff
  CHECK(hex(built(v4(1, 4660), v4(199, 45130), payload, 2)).substr(52, 4) == "ffff");
}

TEST_CASE("a cut payload keeps its length and has no UDP checksum", "[capture]") {
  for (const bool six : {false, true}) {
    const Endpoint from = six ? v6(1, 1) : v4(1, 1), to = six ? v6(2, 2) : v4(2, 2);
    const Bytes frame = built(from, to, bytes("70616c"), 1000);
    const std::size_t ip = six ? 40 : 20;
    REQUIRE(frame.size() == ip + 8 + 3);
    CHECK(hex(frame).substr(2 * ip + 8, 8) == "03f00000");
    UdpFrame found;
    REQUIRE(parse_frame(LinkType::kRaw, frame, found) == FrameVerdict::kDatagram);
    CHECK(found.length == 1000);
    CHECK(found.payload.size() == 3);
  }
}

TEST_CASE("an IPv4 end that talks to an IPv6 one is mapped", "[capture]") {
  const Bytes frame = built(v4(1, 4660), v6(2, 45130), bytes("70"), 1);
  UdpFrame found;
  REQUIRE(parse_frame(LinkType::kRaw, frame, found) == FrameVerdict::kDatagram);
  CHECK(hex(frame).substr(16, 32) == "00000000000000000000ffffc0a80001");
  CHECK(found.from.port == 4660);
  CHECK(found.to == v6(2, 45130));
}

TEST_CASE("what is no datagram, or does not fit, is not built", "[capture]") {
  const Bytes payload(10);
  Bytes out(10 + 28);
  CHECK(build_frame(v4(1, 1), v4(2, 2), payload, 10, out) == 38);
  CHECK(build_frame(v4(1, 1), v4(2, 2), payload, 9, out) == 0);
  CHECK(build_frame(v4(1, 1), v4(2, 2), payload, 65507, out) == 38);
  CHECK(build_frame(v4(1, 1), v4(2, 2), payload, 65508, out) == 0);
  CHECK(build_frame(v6(1, 1), v6(2, 2), payload, 10, out) == 0);
  CHECK(build_frame(v4(1, 1), v4(2, 2), payload, 10, std::span(out).first(37)) == 0);
  out.resize(58);
  CHECK(build_frame(v6(1, 1), v6(2, 2), payload, 65527, out) == 58);
  CHECK(build_frame(v6(1, 1), v6(2, 2), payload, 65528, out) == 0);
}
