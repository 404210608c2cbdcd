#include "protocol/capture.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>
#include <vector>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/hex.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::protocol;
using palpate::test::Bytes;
using palpate::test::bytes;
using palpate::test::hex;
using palpate::test::TemporaryFolder;

namespace {

const Endpoint kFrom{.address = {192, 168, 0, 1}, .port = 4660};
const Endpoint kTo{.address = {192, 168, 0, 199}, .port = 45130};

std::filesystem::path write_file(const TemporaryFolder& folder, const Bytes& content) {
  return folder.write("a.pcap", std::string(reinterpret_cast<const char*>(content.data()), content.size()));
}

Bytes read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto all = std::as_bytes(std::span(text));
  return {all.begin(), all.end()};
}

template <class Capture>
std::string error_of(const std::filesystem::path& path) {
  try {
    const Capture capture(path);
  } catch (const Error& e) {
    CHECK(e.exit_code() == 2);
    return e.what();
  }
  return "no error";
}

}  // namespace

#ifndef PALPATE_WITH_CAPTURE

TEST_CASE("a build without captures says so", "[capture]") {
  const std::string expected =
      "captures were left out of this build (PALPATE_CAPTURE=OFF); build with it, and libpcap-dev, to read "
      "or "
      "write x.pcap";
  CHECK(error_of<CaptureReader>("x.pcap") == expected);
  CHECK(error_of<CaptureWriter>("x.pcap") == expected);
}

#else

namespace {

/// "pal" from kFrom to kTo, raw IPv4: 31 bytes.
const std::string kPal = "4500001f 00004000 4011b8b5 c0a80001 c0a800c7 1234b04a 000bdede 70616c";
const std::string kPcapLittle = "d4c3b2a1 0200 0400 00000000 00000000 ffff0000 65000000 ";
const std::string kPcapBig = "a1b2c3d4 0002 0004 00000000 00000000 0000ffff 00000065 ";
const std::string kNanoLittle = "4d3cb2a1 0200 0400 00000000 00000000 ffff0000 65000000 ";
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

struct Content {
  std::vector<Time> times;
  std::vector<std::string> payloads;
  std::vector<std::size_t> lengths;
  CaptureReader::Skipped skipped;
  std::uint64_t packets = 0;
  std::string trouble;
};

Content read_all(const std::filesystem::path& path) {
  CaptureReader reader(path);
  Content content;
  CapturedDatagram datagram;
  double share = 0;
  while (reader.next(datagram)) {
    CHECK(reader.share() >= share);
    share = reader.share();
    content.times.push_back(datagram.t);
    content.payloads.push_back(hex(datagram.bytes));
    content.lengths.push_back(datagram.length);
  }
  CHECK(reader.share() == 1);
  CHECK_FALSE(reader.next(datagram));
  content.skipped = reader.skipped();
  content.packets = reader.packets();
  content.trouble = reader.trouble();
  return content;
}

Content read_all(const std::string& text) {
  const TemporaryFolder folder;
  return read_all(write_file(folder, bytes(text)));
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

bool pal(CaptureWriter& writer, Time t) {
  const Bytes payload = bytes("70616c");
  return writer.write(t, kFrom, kTo, payload, payload.size());
}

constexpr Time kMicro{1'700'000'000'123'456'000}, kNano{1'700'000'000'123'456'789};

}  // namespace

TEST_CASE("golden bytes of a capture of one datagram", "[capture]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "one.pcap";
  {
    CaptureWriter writer(path);
    CHECK(pal(writer, kNano));
    CHECK(writer.packets() == 1);
    CHECK(writer.bytes() == 71);
  }
  CHECK(hex(read_file(path)) == hex(bytes(kNanoLittle + "00f15365 15cd5b07 1f000000 1f000000" + kPal)));
}

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

TEST_CASE("seconds past 2038 are read and written, and what the format cannot hold is clamped", "[capture]") {
  check_pal(kPcapLittle + "ffffffff 00000000 1f000000 1f000000" + kPal, std::chrono::seconds(0xffffffff));
  check_pal(kPcapBig + "80000000 00000000 0000001f 0000001f" + kPal, std::chrono::seconds(0x80000000));
  const TemporaryFolder folder;
  const auto path = folder.path() / "times.pcap";
  {
    CaptureWriter writer(path);
    for (const Time t : {Time{-5}, Time{0}, kNano, Time{std::chrono::seconds(0x80000000)}, Time::max()}) {
      CHECK(pal(writer, t));
    }
  }
  CHECK(read_all(path).times == std::vector<Time>{Time{0}, Time{0}, kNano, std::chrono::seconds(0x80000000),
                                                  Time{4294967295'999'999'999}});
}

TEST_CASE("what is written is read again, IPv4 and IPv6, cut and whole", "[capture]") {
  const TemporaryFolder folder;
  test::Random random(3);
  const Endpoint six{.address = {0x20, 1, 0x0d, 0xb8, 1}, .port = 99, .v6 = true};
  std::vector<Bytes> payloads;
  for (std::size_t i = 0; i < 500; ++i) {
    Bytes payload(i % 7 == 0 ? 60000 : random.bits() % 1200);
    for (std::byte& b : payload) b = static_cast<std::byte>(random.bits());
    payloads.push_back(payload);
  }
  for (const char* name : {"a.pcap", "b.pcap"}) {
    CaptureWriter writer(folder.path() / name);
    for (std::size_t i = 0; i < payloads.size(); ++i) {
      const Endpoint& to = i % 2 == 0 ? kTo : six;
      REQUIRE(
          writer.write(kNano + Time(i), i % 2 == 0 ? kFrom : six, to, payloads[i], payloads[i].size() + i));
    }
    CHECK(writer.flush());
    CHECK(writer.bytes() == std::filesystem::file_size(folder.path() / name));
  }
  CHECK((read_file(folder.path() / "a.pcap") == read_file(folder.path() / "b.pcap")));
  CaptureReader reader(folder.path() / "a.pcap");
  CapturedDatagram got;
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    REQUIRE(reader.next(got));
    REQUIRE(got.t == kNano + Time(i));
    REQUIRE(got.from == (i % 2 == 0 ? kFrom : six));
    REQUIRE(got.to == (i % 2 == 0 ? kTo : six));
    REQUIRE(hex(got.bytes) == hex(payloads[i]));
    REQUIRE(got.length == payloads[i].size() + i);
  }
  CHECK_FALSE(reader.next(got));
  CHECK(reader.trouble().empty());
}

TEST_CASE("the longest datagrams are cut to the snap length", "[capture]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.pcap";
  const Endpoint six{.address = {1}, .port = 1, .v6 = true};
  const Bytes longest(65527);
  {
    CaptureWriter writer(path);
    CHECK(writer.write(kNano, kFrom, kTo, std::span(longest).first(65507), 65507));
    CHECK(writer.write(kNano, six, six, longest, 65527));
  }
  const Content content = read_all(path);
  CHECK(content.lengths == std::vector<std::size_t>{65507, 65527});
  REQUIRE(content.payloads.size() == 2);
  CHECK(content.payloads[1].size() == 2 * 65487);
  CHECK(content.trouble.empty());
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
  const Bytes whole = bytes(kPcapLittle + packet + packet);
  for (std::size_t size = 1; size < whole.size(); ++size) {
    CAPTURE(size);
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
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
  const Bytes whole = bytes(kSection + kInterface + packet + packet);
  for (std::size_t size = 1; size < whole.size(); ++size) {
    CAPTURE(size);
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
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

TEST_CASE("a file that cannot be opened for writing is named", "[capture]") {
  const TemporaryFolder folder;
  const std::string advice = "; name a file in a folder you may write to";
  const std::string none = (folder.path() / "none" / "a.pcap").string();
  CHECK(error_of<CaptureWriter>(none) == none + ": No such file or directory" + advice);
  CHECK(error_of<CaptureWriter>(folder.path()) == folder.path().string() + ": Is a directory" + advice);
}

TEST_CASE("a full disk is told at once when asked, at the latest after 32 kB, and for ever", "[capture]") {
  CaptureWriter asked("/dev/full");
  CHECK(pal(asked, kNano));
  CHECK_FALSE(asked.flush());
  CHECK_FALSE(pal(asked, kNano));
  CHECK_FALSE(asked.flush());
  CHECK(asked.packets() == 0);
  CaptureWriter not_asked("/dev/full");
  int written = 0;
  while (written < 10000 && pal(not_asked, kNano)) ++written;
  CHECK(written == (32 * 1024 - 24) / 47);
  CHECK_FALSE(pal(not_asked, kNano));
}

TEST_CASE("a file that may not grow ends with a whole packet", "[capture]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.pcap";
  std::uint64_t packets = 0, size = 0;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  {
    CaptureWriter writer(path);
    const auto old = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{100'001, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    while (packets++ < 10000 && pal(writer, kNano)) {
    }
    setrlimit(RLIMIT_FSIZE, &before);  // as if space had come back before the file is closed
    std::signal(SIGXFSZ, old);
    packets = writer.packets();
    size = writer.bytes();
  }
  CHECK(size > 60'000);
  CHECK(size <= 100'001);
  CHECK(std::filesystem::file_size(path) == size);
  const Content content = read_all(path);
  CHECK(content.packets == packets);
  CHECK(content.payloads.size() == packets);
  CHECK(content.trouble.empty());
}

TEST_CASE("what no datagram can be is not written, and what came before stays", "[capture]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.pcap";
  CaptureWriter writer(path);
  CHECK(pal(writer, kNano));
  CHECK_FALSE(writer.write(kNano, kFrom, kTo, Bytes(3), 2));
  CHECK_FALSE(pal(writer, kNano));
  CHECK(writer.packets() == 1);
  CHECK(read_all(path).payloads.size() == 1);
}

#endif
