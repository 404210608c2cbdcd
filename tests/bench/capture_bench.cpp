// Captures: writing, reading, sorting into sessions. Bytes a second are those of the file.
#include <filesystem>

#include "haptic_client/evaluation/captured_session.h"
#include "tests/bench/bench.h"
#include "tests/bench/palpation.h"
#include "tests/support/temporary_folder.h"

namespace palpate::bench {
using namespace protocol;

namespace {

constexpr std::uint64_t kTicks = 8192;  // 16 s

const Endpoint kClient{.address = {10, 0, 0, 1}, .port = 5000},
    kServer{.address = {10, 0, 0, 2}, .port = 45130};

struct Encoded {
  std::array<std::byte, kMaxDatagram> bytes;
  std::size_t size;
  Encoded(std::uint64_t sequence, const Message& message) : size(encode({7, sequence}, message, bytes)) {}
  std::span<const std::byte> used() const { return {bytes.data(), size}; }
};

/// A capture of a palpation; made once, gone with the program.
struct Recorded {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "palpation.pcap";
  std::int64_t bytes = 0;

  Recorded() {
    CaptureWriter capture(file);
    Palpation hand;
    for (std::uint64_t i = 1; i <= kTicks; ++i) {
      hand.next();
      const Time t{hand.tool().t_ns};
      const Encoded up(i, hand.tool());
      capture.write(t, kClient, kServer, up.used(), up.size);
      if (hand.arrived() == nullptr) continue;
      const Encoded down(hand.arrived()->number, *hand.arrived());
      capture.write(t, kServer, kClient, down.used(), down.size);
    }
    if (!capture.flush()) fail_at_run_time("{}: could not be written", file.string());
    bytes = static_cast<std::int64_t>(capture.bytes());
  }
};
const Recorded& recorded() {
  static const Recorded once;
  return once;
}

std::uint64_t read(const std::filesystem::path& file, Fnv1a* hash) {
  CaptureReader reader(file);
  CapturedDatagram captured;
  std::uint64_t bytes = 0;
  while (reader.next(captured)) {
    bytes += captured.length;
    if (hash != nullptr) hash->add(captured.bytes.data(), captured.bytes.size());
  }
  return bytes;
}

void run_read(benchmark::State& state) {
  const Recorded& capture = recorded();
  Fnv1a hash;
  read(capture.file, &hash);
  show(state, hash.value());
  for (auto _ : state) {
    std::uint64_t bytes = read(capture.file, nullptr);
    benchmark::DoNotOptimize(bytes);
  }
  state.SetBytesProcessed(state.iterations() * capture.bytes);
}

/// The label is the hash of the run that was found.
void run_survey(benchmark::State& state) {
  const Recorded& capture = recorded();
  const auto survey = [&] { return client::survey(capture.file, [](double) {}).runs.at(0); };
  const client::CapturedRun run = survey();
  Fnv1a hash;
  for (const std::uint64_t n : {run.ticks, run.samples, run.first_tick, run.newest_tick})
    hash.add(&n, sizeof(n));
  show(state, hash.value());
  for (auto _ : state) {
    client::CapturedRun found = survey();
    benchmark::DoNotOptimize(found);
  }
  state.SetBytesProcessed(state.iterations() * capture.bytes);
}

/// One datagram at a time, to where bytes go to die. The label is the hash of a whole capture.
void run_write(benchmark::State& state) {
  show(state, hash_of(recorded().file));
  Palpation hand;
  hand.next();
  const Encoded datagram(1, hand.tool());
  CaptureWriter capture("/dev/null");
  std::int64_t t = 0;
  for (auto _ : state) {
    bool written = capture.write(Time{++t}, kClient, kServer, datagram.used(), datagram.size);
    benchmark::DoNotOptimize(written);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(capture.bytes()));
}

}  // namespace

void add_capture_rows() {
  add("capture/write", run_write);
  add("capture/read", run_read);
  add("capture/survey", run_survey);
}

}  // namespace palpate::bench
