// Captures: writing, reading, sorting into sessions. Bytes a second are those of the file.
#include <filesystem>

#include "haptic_client/evaluation/captured_session.h"
#include "tests/bench/bench.h"
#include "tests/bench/palpation.h"
#include "tests/support/captured.h"
#include "tests/support/temporary_folder.h"

namespace palpate::bench {
using namespace protocol;

namespace {

constexpr std::uint64_t kTicks = 8192;  // 16 s

/// A capture of a palpation; made once, gone with the program.
struct Recorded {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "palpation.pcap";
  std::int64_t bytes = 0;

  Recorded() {
    test::CaptureOf capture(file);
    Palpation hand;
    for (std::uint64_t i = 1; i <= kTicks; ++i) {
      hand.next();
      capture.state(hand.tool(), i);
      if (hand.arrived() != nullptr) capture.sample(*hand.arrived(), hand.arrived()->number);
    }
    capture.close();
    bytes = static_cast<std::int64_t>(std::filesystem::file_size(file));
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

/// One datagram at a time, to where bytes go to die.
void run_write(benchmark::State& state) {
  Palpation hand;
  hand.next();
  std::array<std::byte, kMaxDatagram> bytes;
  const std::size_t size = encode({7, 1}, hand.tool(), bytes);
  Fnv1a hash;
  hash.add(bytes.data(), size);
  show(state, hash.value());
  CaptureWriter capture("/dev/null");
  const Endpoint client = test::CaptureOf::client(5000), server = test::CaptureOf::server();
  std::int64_t t = 0;
  for (auto _ : state) {
    bool written = capture.write(Time{++t}, client, server, {bytes.data(), size}, size);
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
