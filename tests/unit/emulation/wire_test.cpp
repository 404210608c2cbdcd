#include "tests/emulation/wire.h"

#include <cerrno>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/emulation/spacemouse.h"
#include "tests/emulation/usb_bus.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate::emulation;
using palpate::test::Random;

namespace {

wire::Frame frame(wire::Kind kind, std::uint64_t id, const Bytes& payload = {}) {
  wire::Frame made;
  made.header.kind = kind;
  made.header.id = id;
  made.payload = payload;
  return made;
}

}  // namespace

TEST_CASE("wire: frames come out whole, wherever the stream is cut") {
  Random random(8);
  for (int round = 0; round < 100; ++round) {
    Bytes stream;
    std::vector<Bytes> payloads;
    for (std::uint64_t id = 0; id < 6; ++id) {
      payloads.emplace_back(random.bits() % 200, static_cast<std::uint8_t>(id));
      const Bytes one = wire::encode(frame(wire::Kind::kSubmit, id, payloads.back()));
      stream.insert(stream.end(), one.begin(), one.end());
    }
    wire::FrameReader reader;
    std::uint64_t next = 0;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t piece = std::min<std::size_t>(1 + random.bits() % 90, stream.size() - at);
      reader.feed(stream.data() + at, piece);
      at += piece;
      while (const auto got = reader.next()) {
        CHECK(got->header.id == next);
        CHECK(got->payload == payloads[next++]);
      }
    }
    CHECK(next == 6);
    CHECK_FALSE(reader.broken());
  }
}

TEST_CASE("wire: what is no frame breaks the reader for good") {
  wire::Frame wrong = frame(static_cast<wire::Kind>(200), 1);
  for (int i = 0; i < 2; ++i, wrong = frame(wire::Kind::kList, 1)) {
    Bytes bytes = wire::encode(wrong);
    if (i == 1) bytes[3] = 0x7f;  // a length of 2 GB
    wire::FrameReader reader;
    reader.feed(bytes.data(), bytes.size());
    CHECK_FALSE(reader.next());
    CHECK(reader.broken());
    const Bytes good = wire::encode(frame(wire::Kind::kList, 2));
    reader.feed(good.data(), good.size());
    CHECK_FALSE(reader.next());
  }
}

TEST_CASE("wire: a frame carries a file descriptor over a socket") {
  int link[2], pipe_ends[2];
  REQUIRE(socketpair(AF_UNIX, SOCK_STREAM, 0, link) == 0);
  REQUIRE(pipe(pipe_ends) == 0);
  CHECK(wire::send(link[0], frame(wire::Kind::kOpen, 3), pipe_ends[1]));
  wire::FrameReader reader;
  CHECK(reader.fill(link[1], true));
  CHECK(reader.next()->header.id == 3);
  const int received = reader.take_descriptor();
  CHECK(write(received, "x", 1) == 1);
  char byte = 0;
  CHECK(read(pipe_ends[0], &byte, 1) == 1);
  CHECK(byte == 'x');
  CHECK(reader.take_descriptor() == -1);
  close(link[0]);
  CHECK_FALSE(reader.fill(link[1], true));
  for (const int fd : {received, link[1], pipe_ends[0], pipe_ends[1]}) close(fd);
}

TEST_CASE("usb bus: ports, names, and commands that are wrong") {
  UsbBus bus;
  const auto mouse = [] { return std::make_unique<SpaceMouse>(SpaceMouse::Layout::kTwoReports); };
  for (const char* good : {"2-1", "2-3.4", "63-10.2.3"}) CHECK_NOTHROW(bus.add(good, mouse()));
  for (const char* bad : {"2-1", "2", "", "0-1", "2-0", "a-b", "2-1.", "2-1/4", "300-1", "2-1.1", "2-3"})
    CHECK_THROWS_AS(bus.add(bad, mouse()), CommandError);
  CHECK(bus.command("devices", 0) == "ok 2-1 2-3.4 63-10.2.3");
  CHECK(bus.command("unplug 2-1", 0) == "ok");
  CHECK(bus.command("unplug 2-1", 0) == "error it is not plugged in");
  CHECK(bus.command("devices", 0) == "ok 2-1(unplugged) 2-3.4 63-10.2.3");
  CHECK(bus.command("plug 2-1", 0) == "ok");
  CHECK(bus.command("state 7-7", 0) == "error no device \"7-7\"");
  CHECK(bus.command("", 0).rfind("error", 0) == 0);
  CHECK(bus.command("mouse 2-1 1 2 3 4 5 six", 0).rfind("error \"six\" is no number", 0) == 0);
  CHECK(bus.command("state 2-1", 0).rfind("ok {\"axes\":[", 0) == 0);
}

TEST_CASE("usb bus: a link without a device is told so, whatever it asks") {
  int ends[2];
  REQUIRE(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
  UsbBus bus;
  Link link(ends[0]);
  wire::FrameReader reader;
  const auto answer = [&](wire::Kind kind) {
    CHECK(bus.handle(link, frame(kind, 1), 0));
    CHECK(reader.fill(ends[1], true));
    return reader.next()->header.status;
  };
  CHECK(answer(wire::Kind::kOpen) == -ENODEV);
  for (const auto kind : {wire::Kind::kClaim, wire::Kind::kRelease, wire::Kind::kGetDriver})
    CHECK(answer(kind) == -ENODEV);
  CHECK(bus.handle(link, frame(wire::Kind::kSubmit, 2), 0));
  CHECK_FALSE(bus.handle(link, frame(wire::Kind::kAttached, 3), 0));
  close(ends[1]);
}
