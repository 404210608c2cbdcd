#ifdef PALPATE_WITH_CAPTURE
#include <csignal>
#include <fstream>
#include <sys/resource.h>

#include "protocol/capture.h"
#include "tests/support/captures.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace palpate::test;

namespace {

Bytes read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto all = std::as_bytes(std::span(text));
  return {all.begin(), all.end()};
}

bool pal(CaptureWriter& writer, Time t) {
  const Bytes payload = bytes("70616c");
  return writer.write(t, kFrom, kTo, payload, payload.size());
}

}  // namespace

TEST_CASE("golden bytes of a capture: a whole datagram and a cut one", "[capture]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "one.pcap";
  {
    CaptureWriter writer(path);
    CHECK(pal(writer, kNano));
    CHECK(writer.packets() == 1);
    CHECK(writer.bytes() == 71);
    CHECK(writer.write(kNano, kFrom, kTo, bytes("70"), 3));
  }
  CHECK(hex(read_file(path)) ==
        hex(bytes(kNanoLittle + "00f15365 15cd5b07 1f000000 1f000000" + kPal +
                  "00f15365 15cd5b07 1d000000 1f000000" +
                  "4500001f 00004000 4011b8b5 c0a80001 c0a800c7 1234b04a 000b0000 70")));
}

TEST_CASE("seconds past 2038 are written, and what the format cannot hold is clamped", "[capture]") {
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

TEST_CASE("a file that cannot be opened for writing is named", "[capture]") {
  const TemporaryFolder folder;
  const std::string advice = "; name a file in a folder you may write to";
  const std::string none = (folder.path() / "none" / "a.pcap").string();
  CHECK(error_of<CaptureWriter>(none) == none + ": No such file or directory" + advice);
  CHECK(error_of<CaptureWriter>(folder.path()) == folder.path().string() + ": Is a directory" + advice);
}

TEST_CASE("a full disk is told at once when asked, at the latest after 32 kB, and for ever", "[capture]") {
  CaptureWriter requested("/dev/full");
  CHECK(pal(requested, kNano));
  CHECK_FALSE(requested.flush());
  CHECK_FALSE(pal(requested, kNano));
  CHECK_FALSE(requested.flush());
  CHECK(requested.packets() == 0);
  CaptureWriter not_requested("/dev/full");
  int written = 0;
  while (written < 10000 && pal(not_requested, kNano)) ++written;
  CHECK(written == (32 * 1024 - 24) / 47);
  CHECK_FALSE(pal(not_requested, kNano));
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
  CHECK_FALSE(writer.flush());
  CHECK(writer.packets() == 1);
  CHECK(read_all(path).payloads.size() == 1);
}

#endif
