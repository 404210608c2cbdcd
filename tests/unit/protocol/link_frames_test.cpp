#include "protocol/link_frames.h"

#include <fmt/core.h>
#include <string>
#include <vector>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/hex.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::protocol;
using palpate::test::Bytes;
using palpate::test::bytes;
using palpate::test::hex;

namespace {

// Port 4660 to 45130, "pal", in IPv4 from 192.168.0.1 to 192.168.0.199 and in IPv6 from 2001:db8::1 to ::2.
const std::string kUdp = "1234 b04a 000b 0000 70616c ";
const std::string kAddresses4 = "c0a80001 c0a800c7 ", kIp4 = "4500001f 00004000 40110000 " + kAddresses4;
const std::string kAddresses6 = "20010db8000000000000000000000001 20010db8000000000000000000000002 ";
const std::string kIp6 = "60000000 000b1140 " + kAddresses6;
const std::string kV4 = kIp4 + kUdp, kV6 = kIp6 + kUdp;

const std::string kEthernet = "ffffffffffff 020000000001 ";
const std::string kCooked = "0000 0001 0006 0200000000010000 ";
const std::string kCooked2 = " 0000 00000002 0001 00 06 0200000000010000 ";  // behind the EtherType

constexpr auto kDatagram = FrameVerdict::kDatagram;
constexpr auto kOther = FrameVerdict::kOtherTraffic;
constexpr auto kFragment = FrameVerdict::kFragment;
constexpr auto kMalformed = FrameVerdict::kMalformed;

Endpoint v4(std::uint8_t last, std::uint16_t port) {
  return {.address = {192, 168, 0, last}, .port = port};
}
Endpoint v6(std::uint8_t last, std::uint16_t port) {
  return {.address = {0x20, 1, 0x0d, 0xb8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, last}, .port = port, .v6 = true};
}

struct Frame {
  LinkType link;
  std::string text;
  bool v6;
};

FrameVerdict verdict(LinkType link, const std::string& text) {
  UdpFrame frame;
  return parse_frame(link, bytes(text), frame);
}
FrameVerdict verdict_ip(const std::string& text) {
  return verdict(LinkType::kRaw, text);
}

/// The frame holds "pal" between the endpoints above.
void check_pal(const Frame& frame) {
  CAPTURE(static_cast<int>(frame.link), frame.text);
  const Bytes data = bytes(frame.text);
  UdpFrame found;
  REQUIRE(parse_frame(frame.link, data, found) == kDatagram);
  CHECK(found.from == (frame.v6 ? v6(1, 4660) : v4(1, 4660)));
  CHECK(found.to == (frame.v6 ? v6(2, 45130) : v4(199, 45130)));
  CHECK(hex(found.payload) == "70616c");
  CHECK(found.length == 3);
}

/// One for every link type, VLAN tags and both versions of IP, with nothing behind the datagram.
std::vector<Frame> one_of_each() {
  std::vector<Frame> frames;
  for (const bool v6 : {false, true}) {
    const std::string ip = v6 ? kV6 : kV4, type = v6 ? "86dd" : "0800";
    for (const std::string& tags :
         {std::string(), std::string("8100 0001 "), std::string("88a8 0002 8100 0001 "),
          std::string("9100 0003 8100 0002 8100 0001 8100 0000 ")}) {
      frames.push_back({LinkType::kEthernet, kEthernet + tags + type + ip, v6});
      frames.push_back({LinkType::kCooked, kCooked + tags + type + ip, v6});
      const std::string first = (tags + type).substr(0, 4), rest = (tags + type).substr(4);
      frames.push_back({LinkType::kCooked2, first + kCooked2 + rest + ip, v6});
    }
    for (const LinkType raw : {LinkType::kRaw, LinkType::kRawLinux, LinkType::kRawOpenBsd}) {
      frames.push_back({raw, ip, v6});
    }
    frames.push_back({v6 ? LinkType::kIpv6 : LinkType::kIpv4, ip, v6});
    for (const LinkType loopback : {LinkType::kNull, LinkType::kLoop}) {
      for (const char* family : {"0a", "18", "1c", "1e"}) {
        const std::string number = v6 ? family : "02";
        frames.push_back({loopback, number + "000000" + ip, v6});
        frames.push_back({loopback, "000000" + number + ip, v6});
      }
    }
  }
  return frames;
}

}  // namespace

TEST_CASE("the same datagram is found behind every link type and up to four VLAN tags", "[capture]") {
  for (const Frame& frame : one_of_each()) check_pal(frame);
}

TEST_CASE("a frame with five VLAN tags, or of no IP protocol, is other traffic", "[capture]") {
  const std::string tag = "8100 0001 ";
  CHECK(verdict(LinkType::kEthernet, kEthernet + tag + tag + tag + tag + "0800" + kV4) == kDatagram);
  CHECK(verdict(LinkType::kEthernet, kEthernet + tag + tag + tag + tag + tag + "0800" + kV4) == kOther);
  const std::string arp = "0001 0800 06 04 0001 020000000001 c0a80001 000000000000 c0a800c7";
  CHECK(verdict(LinkType::kEthernet, kEthernet + "0806" + arp) == kOther);
  CHECK(verdict(LinkType::kEthernet, kEthernet + "0026 424203 000000") == kOther);  // a length: 802.3
  CHECK(verdict(LinkType::kCooked, kCooked + "0806" + arp) == kOther);
  CHECK(verdict(LinkType::kCooked2, "0806" + kCooked2 + arp) == kOther);
  CHECK(verdict(LinkType::kNull, "07000000" + kV4) == kOther);
  CHECK(verdict(LinkType::kNull, "02000002" + kV4) == kOther);
  CHECK(verdict_ip("50000000" + kV4) == kOther);
}

TEST_CASE("a datagram within VXLAN, GRE, IP in IP or PPPoE is found, however these are stacked",
          "[capture]") {
  const auto length = [](const std::string& text) { return bytes(text).size(); };
  const auto number = [](std::size_t value) { return fmt::format("{:04x}", value); };
  const auto within_ip4 = [&](const std::string& protocol, const std::string& inner) {
    return "4500" + number(20 + length(inner)) + "00004000 40" + protocol + "0000 0a000001 0a000002 " + inner;
  };
  const auto within_ip6 = [&](const std::string& next, const std::string& inner) {
    return "60000000" + number(length(inner)) + next + "40" + kAddresses6 + inner;
  };
  const auto within_vxlan = [&](const std::string& frame) {
    const std::string header = "0800000000002a00 ";
    return within_ip4("11", "d903 12b5 " + number(16 + length(frame)) + " 0000" + header + frame);
  };
  for (const bool v6 : {false, true}) {
    const std::string ip = v6 ? kV6 : kV4, type = v6 ? "86dd" : "0800";
    const std::string frame = kEthernet + type + ip, ppp = v6 ? "0057" : "0021";
    const std::string pppoe = kEthernet + "8864 1100 0001" + number(2 + length(ip)) + ppp + ip;
    check_pal({LinkType::kEthernet, pppoe, v6});
    check_pal({LinkType::kEthernet, kEthernet + "0800" + within_vxlan(frame), v6});
    check_pal({LinkType::kRaw, within_vxlan(pppoe), v6});
    check_pal({LinkType::kRaw, within_ip4("2f", "0000" + type + ip), v6});
    check_pal({LinkType::kRaw, within_ip4("2f", "2000 6558 00000007" + frame), v6});
    check_pal({LinkType::kRaw, within_ip4("2f", "b000" + type + "aaaa0000 00000007 00000001" + ip), v6});
    check_pal({LinkType::kRaw, within_ip6("2f", "0000" + type + ip), v6});
    check_pal({LinkType::kRaw, within_ip4(v6 ? "29" : "04", ip), v6});
    check_pal({LinkType::kRaw, within_ip6(v6 ? "29" : "04", ip), v6});
    const auto once_more = [&](const std::string& inner) { return within_ip4("04", inner); };
    const std::string two = once_more(once_more(within_vxlan(frame)));
    check_pal({LinkType::kRaw, two, v6});
    CHECK(verdict_ip(once_more(two)) == kOther);
  }
  CHECK(verdict_ip(within_ip4("2f", "0001 880b 00000000" + kV4)) == kOther);  // PPTP
  CHECK(verdict_ip(within_ip4("2f", "20")) == kMalformed);
  CHECK(verdict(LinkType::kEthernet, kEthernet + "8864 1100 0001 0004 c021 01") == kOther);  // of PPP itself
  // What comes to that port without the header is a datagram of its own.
  CHECK(verdict_ip(within_ip4("11", "d903 12b5 000b 0000 70616c")) == kDatagram);
  CHECK(verdict_ip("4500 0030 0000 2000 40 2f 0000" + kAddresses4 + "0000 0800" + kV4) == kFragment);
}

TEST_CASE("TCP, ICMP and ICMPv6 are other traffic, whole or in fragments", "[capture]") {
  for (const std::string protocol : {"01", "06"}) {
    CHECK(verdict_ip("4500001f 00004000 40" + protocol + "0000" + kAddresses4 + kUdp) == kOther);
    CHECK(verdict_ip("4500001f 00002000 40" + protocol + "0000" + kAddresses4 + kUdp) == kOther);
  }
  for (const std::string next : {"06", "3a", "3b"}) {
    CHECK(verdict_ip("60000000 000b" + next + "40" + kAddresses6 + kUdp) == kOther);
    CHECK(verdict_ip("60000000 0013 2c40" + kAddresses6 + next + "00 0001 00000007" + kUdp) == kOther);
  }
}

TEST_CASE("IPv4 options are skipped, and padding behind the datagram is no payload", "[capture]") {
  const std::string options = "94040000 01010101 ";
  check_pal({LinkType::kRaw, "47000027 00004000 40110000" + kAddresses4 + options + kUdp, false});
  check_pal({LinkType::kEthernet, kEthernet + "0800" + kV4 + "000000000000000000000000000000", false});
  check_pal({LinkType::kEthernet, kEthernet + "86dd" + kV6 + "00000000000000", true});
  // Inside IP's length but behind UDP's.
  check_pal({LinkType::kRaw, "45000021 00004000 40110000" + kAddresses4 + kUdp + "eeee", false});
  // IP's length ends before the bytes do: what lies behind it is no part of the packet.
  CHECK(verdict_ip("4500001e 00004000 40110000" + kAddresses4 + kUdp) == kMalformed);
}

TEST_CASE("fragments of UDP are told apart from whole datagrams", "[capture]") {
  const auto with_flags4 = [](const char* flags) {
    return verdict_ip(std::string("4500001f 0000") + flags + "40110000" + kAddresses4 + kUdp);
  };
  CHECK(with_flags4("2000") == kFragment);  // the first of several
  CHECK(with_flags4("2001") == kFragment);
  CHECK(with_flags4("0001") == kFragment);  // the last
  CHECK(with_flags4("1000") == kFragment);
  CHECK(with_flags4("0000") == kDatagram);
  CHECK(with_flags4("8000") == kDatagram);  // the reserved bit says nothing
  const auto with_fragment6 = [](const std::string& next, const std::string& offset) {
    return verdict_ip("60000000 0013 2c40" + kAddresses6 + next + "00" + offset + "00000007" + kUdp);
  };
  CHECK(with_fragment6("11", "0001") == kFragment);
  CHECK(with_fragment6("11", "0008") == kFragment);
  CHECK(with_fragment6("11", "fff8") == kFragment);
  CHECK(with_fragment6("3c", "0001") == kFragment);  // destination options, then who knows
  CHECK(with_fragment6("11", "0000") == kDatagram);  // atomic
  CHECK(with_fragment6("11", "0006") == kDatagram);  // reserved bits
}

TEST_CASE("IPv6 extension headers are skipped, whatever their length", "[capture]") {
  const std::string pad8 = "00 010400000000 ", pad16 = "01 010c000000000000000000000000 ";
  const auto packet = [](const char* length, const char* first, const std::string& headers) {
    return std::string("60000000") + length + first + "40" + kAddresses6 + headers + kUdp;
  };
  check_pal({LinkType::kRaw, packet("0013", "00", "11" + pad8), true});            // hop-by-hop
  check_pal({LinkType::kRaw, packet("001b", "3c", "11" + pad16), true});           // destination options
  check_pal({LinkType::kRaw, packet("0013", "2b", "11" + pad8), true});            // routing
  check_pal({LinkType::kRaw, packet("0013", "2c", "1100 0000 00000007 "), true});  // atomic fragment
  const std::string all = "2b" + pad8 + "2c" + pad16 + "3c00 0000 00000007 " + "11" + pad8;
  check_pal({LinkType::kRaw, packet("0033", "00", all), true});
  CHECK(verdict_ip(packet("0013", "33", "1100 000000000000")) == kOther);  // authentication header
  CHECK(verdict_ip(packet("0013", "00", "11ff 000000000000")) == kMalformed);
  // The declared length ends within the header.
  CHECK(verdict_ip(packet("0004", "00", "11" + pad8)) == kMalformed);
  CHECK(verdict_ip(packet("000b", "00", "11" + pad8)) == kMalformed);
}

TEST_CASE("lengths that do not add up are malformed", "[capture]") {
  CHECK(verdict_ip("4400001f 00004000 40110000" + kAddresses4 + kUdp) == kMalformed);  // four words of header
  CHECK(verdict_ip("45000013 00004000 40110000" + kAddresses4 + kUdp) == kMalformed);  // total below header
  CHECK(verdict_ip("4f00001f 00004000 40110000" + kAddresses4 + kUdp) == kMalformed);  // header beyond packet
  CHECK(verdict_ip(kIp4 + "1234 b04a 0007 0000 70616c") == kMalformed);
  CHECK(verdict_ip(kIp4 + "1234 b04a 0000 0000 70616c") == kMalformed);
  CHECK(verdict_ip(kIp4 + "1234 b04a 000c 0000 70616c") == kMalformed);
  CHECK(verdict_ip(kIp6 + "1234 b04a 000c 0000 70616c") == kMalformed);
  CHECK(verdict(LinkType::kEthernet, kEthernet + "0800" + kV6) == kMalformed);
  CHECK(verdict(LinkType::kEthernet, kEthernet + "86dd" + kV4 + kV4) == kMalformed);
  CHECK(verdict(LinkType::kIpv4, kV6) == kMalformed);
  CHECK(verdict(LinkType::kIpv6, kV4 + kV4) == kMalformed);
}

TEST_CASE("every truncation: malformed within the headers, a cut payload behind them", "[capture]") {
  for (const Frame& frame : one_of_each()) {
    const Bytes entire = bytes(frame.text);
    for (std::size_t size = 0; size < entire.size(); ++size) {
      CAPTURE(static_cast<int>(frame.link), frame.text, size);
      // A copy of exactly this size, so that a sanitizer sees a read beyond it.
      const Bytes cut(entire.begin(), entire.begin() + static_cast<std::ptrdiff_t>(size));
      UdpFrame found;
      const FrameVerdict got = parse_frame(frame.link, cut, found);
      REQUIRE(got == (size + 3 < entire.size() ? kMalformed : kDatagram));
      CHECK(found.length == (got == kDatagram ? 3 : 0));
      CHECK(found.payload.size() == (got == kDatagram ? size + 3 - entire.size() : 0));
    }
  }
}

TEST_CASE("a changed byte never leads beyond the frame, and only a datagram writes the result", "[capture]") {
  test::Random random(7);
  for (const Frame& frame : one_of_each()) {
    const Bytes entire = bytes(frame.text);
    for (int i = 0; i < 2000; ++i) {
      const auto size = static_cast<std::ptrdiff_t>(random.bits() % (entire.size() + 1));
      Bytes changed(entire.begin(), entire.begin() + size);
      for (int n = 0; n < 3 && !changed.empty(); ++n) {
        changed[random.bits() % changed.size()] = static_cast<std::byte>(random.bits());
      }
      UdpFrame found;
      found.length = 12345;
      if (parse_frame(frame.link, changed, found) != kDatagram) {
        REQUIRE(found.length == 12345);
        continue;
      }
      REQUIRE(found.payload.size() <= found.length);
      REQUIRE(found.length <= 65527);
      REQUIRE(found.payload.data() >= changed.data());
      REQUIRE(found.payload.data() + found.payload.size() <= changed.data() + changed.size());
    }
  }
}

TEST_CASE("ten link types are supported, and the others are other traffic", "[capture]") {
  int known = 0;
  for (int link = -1; link < 400; ++link) {
    known += supported(LinkType{link}) ? 1 : 0;
    if (!supported(LinkType{link})) CHECK(verdict(LinkType{link}, kV4) == kOther);
    if (supported(LinkType{link})) CHECK(verdict(LinkType{link}, "") == kMalformed);
  }
  CHECK(known == 10);
}

TEST_CASE("parsing and building frames do not allocate", "[capture]") {
  const std::vector<Frame> frames = one_of_each();
  std::vector<Bytes> texts;
  for (const Frame& frame : frames) texts.push_back(bytes(frame.text));
  Bytes out(2000);
  UdpFrame found;
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      parse_frame(frames[i].link, texts[i], found);
      build_frame(found.from, found.to, found.payload, found.length, out);
    }
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
