#ifdef PALPATE_WITH_CAPTURE
#include "protocol/recorder.h"

#include <fstream>
#include <thread>

#include "common/clock.h"
#include "common/error.h"
#include "protocol/session.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

const Endpoint kHere{.address = {10, 0, 0, 1}, .port = 1}, kThere{.address = {10, 0, 0, 2}, .port = 2};

void note(Recorder& recorder, std::uint64_t sequence) {
  std::array<std::byte, kMaxDatagram> bytes;
  const std::size_t size = encode({7, sequence}, ToolState{.tick = sequence}, bytes);
  recorder.note(Time{1s} + Time{static_cast<Time::rep>(sequence)}, kHere, kThere, {bytes.data(), size});
}

/// All that was noted goes to disk.
void finish(Recorder& recorder) {
  std::jthread thread([&](const std::stop_token& stop) { recorder.run(stop); });
}

std::vector<std::uint64_t> ticks_in(const std::filesystem::path& file) {
  std::vector<std::uint64_t> ticks;
  CaptureReader reader(file);
  Datagram datagram;
  for (CapturedDatagram captured; reader.next(captured);) {
    REQUIRE(decode(captured.bytes, datagram) == Verdict::kAccepted);
    ticks.push_back(std::get<ToolState>(datagram.message).tick);
  }
  return ticks;
}

}  // namespace

TEST_CASE("a recording goes on in new files at its size, nothing is lost between, and ten are kept",
          "[threads]") {
  const test::TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return folder.path() / name; };
  Recorder recorder(path("F.pcap"), 2000);
  // A tool state is 137 bytes, 181 with its frames: 11 of them, and the 24 of the file's header, are above
  // 2000.
  for (std::uint64_t k = 1; k <= 150; ++k) note(recorder, k);
  finish(recorder);
  CHECK(recorder.stats().files == 14);
  CHECK(recorder.stats().packets == 150);
  CHECK(recorder.stats().dropped == 0);
  for (const char* expired : {"F.pcap", "F-2.pcap", "F-3.pcap", "F-4.pcap"})
    CHECK_FALSE(std::filesystem::exists(path(expired)));
  std::uint64_t next = 45;
  for (int file = 5; file <= 14; ++file) {
    for (const std::uint64_t tick : ticks_in(path("F-" + std::to_string(file) + ".pcap")))
      CHECK(tick == next++);
  }
  CHECK(next == 151);
}

TEST_CASE("a recording keeps what had its name, unless it is to be overwritten, also through a link") {
  const test::TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return folder.path() / name; };
  const auto read = [&](const std::string& name) {
    std::ifstream file(path(name));
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  folder.write("F.pcap", "of before");
  folder.write("F-2.pcap", "its second part");
  {
    Recorder nobody_came(path("F.pcap"), 2000);
    finish(nobody_came);
  }
  CHECK(read("F.pcap") == "of before");
  Recorder recorder(path("F.pcap"), 2000);
  for (std::uint64_t k = 1; k <= 15; ++k) note(recorder, k);
  finish(recorder);
  CHECK(read("F.pcap.~1~") == "of before");
  CHECK(read("F-2.pcap.~1~") == "its second part");
  CHECK(ticks_in(path("F.pcap")).size() == 11);
  CHECK(ticks_in(path("F-2.pcap")).size() == 4);

  folder.write("real.pcap", "behind a link");
  std::filesystem::create_symlink("real.pcap", path("link.pcap"));
  Recorder linked(path("link.pcap"));
  note(linked, 1);
  finish(linked);
  CHECK(std::filesystem::is_symlink(path("link.pcap")));
  CHECK(read("link.pcap.~1~") == "behind a link");
  CHECK(ticks_in(path("real.pcap")).size() == 1);

  folder.write("G.pcap", "of before");
  Recorder over(path("G.pcap"), {}, true);
  note(over, 1);
  finish(over);
  CHECK_FALSE(std::filesystem::exists(path("G.pcap.~1~")));
  CHECK(ticks_in(path("G.pcap")).size() == 1);
}

TEST_CASE("a flood of what is refused leaves a few datagrams a second in a recording") {
  const test::TemporaryFolder folder;
  Recorder recorder(folder.path() / "F.pcap");
  note(recorder, 1);
  const std::array<std::byte, 4> garbage{};
  for (Time t = 10s; t < 20s; t += 1ms) recorder.note_refused(t, kHere, kThere, garbage);
  finish(recorder);
  CHECK(recorder.stats().packets <= 1 + 100 + 201);
  CHECK(recorder.stats().packets + recorder.stats().refused == 1 + 10000);
}

TEST_CASE("a compressed capture is refused with the command that unpacks it") {
  const test::TemporaryFolder folder;
  const auto file = folder.write("F.pcap.gz", "\x1f\x8b\x08 and so on, long enough for a header");
  CHECK_THROWS_WITH(CaptureReader(file), Catch::Contains("gunzip -k"));
  CHECK_THROWS_WITH(CaptureReader(folder.write("F.xz",
                                               "\xfd"
                                               "7zXZ and so on, long enough for a header")),
                    Catch::Contains("unxz"));
}
#endif
