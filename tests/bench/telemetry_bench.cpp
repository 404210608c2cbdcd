// What the page costs the haptic thread: the telemetry of a tick, while nobody wants it, and while a page is
// open.
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/telemetry_maker.h"
#include "tests/bench/bench.h"

namespace palpate::bench {
namespace {

using namespace client;

/// Ticks of 1 kHz with the laws of the client files beside; one iteration is a second of them.
void run(benchmark::State& state, bool wanted) {
  constexpr int kTicks = 1000;
  Pipeline pipeline(find_row(extrapolators(), "constant", "law", "bench").make(), {}, {});
  const Observation observation(
      {"constant", "linear_time", "linear_position", "two_tangents", "local_contact"}, kTicks, "bench",
      Workspace{}, 0);
  TelemetryMaker maker("simulated", false, "constant", kTicks);
  maker.want(wanted);
  std::uint64_t tick = 0, messages = 0;
  const auto second = [&] {
    for (int i = 0; i < kTicks; ++i) {
      TickResult result;
      result.tool.t_ns = static_cast<std::int64_t>(++tick) * 1'000'000;
      messages += maker.tick(result, pipeline, observation, 0) != nullptr ? 1 : 0;
    }
  };
  second();
  show(state, messages);
  for (auto _ : state) second();
  benchmark::DoNotOptimize(messages);
}

}  // namespace

void add_telemetry_rows() {
  add("telemetry/nobody", [](benchmark::State& state) { run(state, false); });
  add("telemetry/wanted", [](benchmark::State& state) { run(state, true); });
}

}  // namespace palpate::bench
