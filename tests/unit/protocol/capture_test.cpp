#include "protocol/capture.h"

#include <fstream>
#include <map>
#include <sys/stat.h>

#include "protocol/codec.h"
#include "tests/support/captures.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace palpate::test;

#ifndef PALPATE_WITH_CAPTURE

TEST_CASE("a build without captures says so", "[capture]") {
  const std::string expected =
      "captures were left out of this build (PALPATE_CAPTURE=OFF); build with it, and libpcap-dev, to "
      "read or write x.pcap";
  CHECK(error_of<CaptureReader>("x.pcap") == expected);
  CHECK(error_of<CaptureWriter>("x.pcap") == expected);
}

#else

namespace {

const std::string kPcapLittle = "d4c3b2a1 0200 0400 00000000 00000000 ffff0000 65000000 ";
const std::string kPcapBig = "a1b2c3d4 0002 0004 00000000 00000000 0000ffff 00000065 ";
const std::string kNanoBig = "a1b23c4d 0002 0004 00000000 00000000 0000ffff 00000065 ";
// 1700000000 s = 0x6553f100, 123456 us = 0x1e240, 123456789 ns = 0x75bcd15.
const std::string kSection = "0a0d0d0a 1c000000 4d3c2b1a 0100 0000 ffffffffffffffff 1c000000 ";
const std::string kInterface = "01000000 14000000 6500 0000 00000400 14000000 ";
// Times of pcapng: 1700000000123456 us and 1700000000123456789 ns.
const std::string kStampUs = "240a0600 40222018", kStampNs = "fe9c9717 15cd853d";

/// An enhanced packet block of 64 bytes; `stamp`: the high word of the time, then the low one.
std::string enhanced(const std::string& stamp) {
  return "06000000 40000000 00000000 " + stamp + " 1f000000 1f000000 " + kPal + "00 40000000 ";
}

std::string refusal(const Bytes& content) {
  const TemporaryFolder folder;
  const std::filesystem::path file = write_file(folder, content);
  return error_of<CaptureReader>(file).substr(file.string().size());
}

void check_pal(const std::string& text, Time expected) {
  const Content content = read_all(text);
  CHECK(content.payloads == std::vector<std::string>{"70616c"});
  CHECK(content.times == std::vector<Time>{expected});
  CHECK(content.lengths == std::vector<std::size_t>{3});
  CHECK(content.trouble.empty());
  CHECK(content.packets == 1);
}

}  // namespace

TEST_CASE("pcap is read with us and ns, in either order of bytes", "[capture]") {
  check_pal(kPcapLittle + "00f15365 40e20100 1f000000 1f000000" + kPal, kMicro);
  check_pal(kPcapBig + "6553f100 0001e240 0000001f 0000001f" + kPal, kMicro);
  check_pal(kNanoLittle + "00f15365 15cd5b07 1f000000 1f000000" + kPal, kNano);
  check_pal(kNanoBig + "6553f100 075bcd15 0000001f 0000001f" + kPal, kNano);
}

TEST_CASE("pcapng is read with its own resolution of time", "[capture]") {
  const std::string micro = enhanced(kStampUs);
  check_pal(kSection + kInterface + micro, kMicro);
  const std::string nano = enhanced(kStampNs);
  // Option 9, one byte: 10^-9 s.
  check_pal(kSection + "01000000 20000000 6500 0000 00000400 0900 0100 09000000 00000000 20000000 " + nano,
            kNano);
}

TEST_CASE("seconds past 2038 are read", "[capture]") {
  check_pal(kPcapLittle + "ffffffff 00000000 1f000000 1f000000" + kPal, std::chrono::seconds(0xffffffff));
  check_pal(kPcapBig + "80000000 00000000 0000001f 0000001f" + kPal, std::chrono::seconds(0x80000000));
}

TEST_CASE("the share of the file that was read is that of its bytes", "[capture]") {
  const std::string packet = "00f15365 40e20100 1f000000 1f000000" + kPal;
  const TemporaryFolder folder;
  CaptureReader reader(write_file(folder, bytes(kPcapLittle + packet + packet)));
  CapturedDatagram datagram;
  REQUIRE(reader.next(datagram));
  CHECK(reader.fraction() == 71.0 / 118);
  REQUIRE(reader.next(datagram));
  CHECK_FALSE(reader.next(datagram));
  CHECK(reader.fraction() == 1);
}

TEST_CASE("other traffic, fragments and damaged packets are skipped and counted", "[capture]") {
  const std::string stamp = "00f15365 40e20100 ";
  const Content content =
      read_all(kPcapLittle + stamp + "1f000000 1f000000" + kPal + stamp + "14000000 14000000" +
               "45000014 00004000 40060000 c0a80001 c0a800c7" + stamp + "1f000000 1f000000" +
               "4500001f 00002000 40110000 c0a80001 c0a800c7 1234b04a 000b0000 70616c" + stamp +
               "04000000 1f000000" + "4500001f" + stamp + "00000000 00000000" + stamp + "1d000000 1f000000" +
               "4500001f 00004000 40110000 c0a80001 c0a800c7 1234b04a 000b0000 70");
  CHECK(content.payloads == std::vector<std::string>{"70616c", "70"});
  CHECK(content.lengths == std::vector<std::size_t>{3, 3});
  CHECK(content.skipped.other == 1);
  CHECK(content.skipped.fragments == 1);
  CHECK(content.skipped.malformed == 2);
  CHECK(content.packets == 6);
  CHECK(content.trouble.empty());
}

TEST_CASE("a capture cut at any byte: refused within its header, else read up to the cut", "[capture]") {
  const std::string packet = "00f15365 40e20100 1f000000 1f000000" + kPal;
  const Bytes entire = bytes(kPcapLittle + packet + packet);
  for (std::size_t size = 1; size < entire.size(); ++size) {
    CAPTURE(size);
    const Bytes cut(entire.begin(), entire.begin() + static_cast<std::ptrdiff_t>(size));
    if (size < 24) {
      CHECK(refusal(cut).starts_with(": is not a capture ("));
      continue;
    }
    const TemporaryFolder folder;
    const Content content = read_all(write_file(folder, cut));
    const std::size_t before = (size - 24) / 47;
    CHECK(content.payloads.size() == before);
    CHECK(content.trouble ==
          ((size - 24) % 47 == 0
               ? ""
               : fmt::format("ends in the middle of a packet; the {} packets before it were "
                             "used",
                             before)));
  }
}

TEST_CASE("a pcapng cut at any byte is refused or read up to the cut", "[capture]") {
  const std::string packet = enhanced(kStampUs);
  const Bytes entire = bytes(kSection + kInterface + packet + packet);
  for (std::size_t size = 1; size < entire.size(); ++size) {
    CAPTURE(size);
    const Bytes cut(entire.begin(), entire.begin() + static_cast<std::ptrdiff_t>(size));
    if (size < 48) {
      CHECK(refusal(cut).starts_with(": is not a capture ("));
      continue;
    }
    const TemporaryFolder folder;
    const Content content = read_all(write_file(folder, cut));
    CHECK(content.payloads.size() == (size - 48) / 64);
    CHECK(content.trouble.empty() == ((size - 48) % 64 == 0));
  }
}

TEST_CASE("a damaged packet ends the reading with what libpcap says of it", "[capture]") {
  const Content content = read_all(kPcapLittle + "00f15365 40e20100 1f000000 1f000000" + kPal +
                                   "00f15365 40e20100 ffffff7f ffffff7f" + kPal);
  CHECK(content.payloads.size() == 1);
  CHECK(content.trouble.starts_with("is damaged (invalid packet capture length 2147483647"));
  CHECK(content.trouble.ends_with("); the 1 packets before it were used"));
}

TEST_CASE("what is no capture is refused with what to do", "[capture]") {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  CHECK(error_of<CaptureReader>(folder.path() / "none") == path + "/none: no such file");
  CHECK(error_of<CaptureReader>(folder.path()) == path + ": is a folder; name a capture file in it");
  CHECK(error_of<CaptureReader>("-") == "-: no such file");
  REQUIRE(mkfifo((folder.path() / "pipe").c_str(), 0600) == 0);  // would wait for a writer
  CHECK(error_of<CaptureReader>(folder.path() / "pipe") ==
        path + "/pipe: is no file, but a pipe or a device; write what it gives to a file first");
  const std::string read = "pcap and pcapng files are read; `editcap -F pcap IN OUT` converts many others";
  CHECK(refusal({}) == ": is empty (0 bytes), so no capture; " + read);
  CHECK(refusal(bytes("68656c6c6f2c20776f726c64210a")) ==
        ": is not a capture (unknown file format); " + read);
}

TEST_CASE("an unknown link type is named, with those that are known", "[capture]") {
  const std::string packet = "00f15365 40e20100 1f000000 1f000000" + kPal;
  CHECK(
      refusal(bytes("d4c3b2a1 0200 0400 00000000 00000000 ffff0000 69000000 " + packet)) ==
      ": link type 105 (IEEE802_11) is not supported; capture on one of these: Ethernet, Linux cooked (SLL, "
      "SLL2), raw IP, BSD loopback (NULL, LOOP)");
  CHECK(refusal(bytes("d4c3b2a1 0200 0400 00000000 00000000 ffff0000 0f270000 " + packet))
            .starts_with(": link type 9999 (no name) is not supported"));
}

TEST_CASE("a pcapng that mixes interfaces is refused, or read up to where it does", "[capture]") {
  const std::string packet = enhanced(kStampUs);
  const std::string ethernet = "01000000 14000000 0100 0000 00000400 14000000 ";
  CHECK(refusal(bytes(kSection + kInterface + ethernet + packet)).starts_with(": mixes interfaces"));
  const Content content = read_all(kSection + kInterface + packet + ethernet + packet);
  CHECK(content.payloads.size() == 1);
  CHECK(content.trouble.starts_with("mixes interfaces"));
  CHECK(content.trouble.ends_with("; the 1 packets before it were used"));
}

// Which of these the dissector refuses stands in limits.txt: scripts/wireshark/check.
TEST_CASE("the codec refuses the values that the dissector refuses, and no others", "[capture]") {
  const std::string folder = source_dir() + "/tests/wireshark/";
  CaptureReader reader(folder + "limits.pcap");
  std::ifstream expected(folder + "limits.txt");
  CapturedDatagram captured;
  std::string line;
  std::map<Verdict, int> verdicts;
  while (reader.next(captured)) {
    REQUIRE(std::getline(expected, line));
    Datagram datagram;
    const Verdict verdict = decode(captured.bytes, datagram);
    CAPTURE(line, name_of(verdict));
    CHECK(verdict == (line.starts_with("refused") ? Verdict::kValue : Verdict::kAccepted));
    ++verdicts[verdict];
  }
  CHECK_FALSE(std::getline(expected, line));
  CHECK(verdicts[Verdict::kValue] > 200);
  CHECK(verdicts[Verdict::kAccepted] > 300);
}

#endif
