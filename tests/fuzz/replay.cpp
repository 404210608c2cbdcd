// A capture of anything, as far as the force.
#include "haptic_client/evaluation/resampler.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "tests/fuzz/file_fuzzer.h"

using namespace palpate;

namespace {

void replay(const std::string& file) {
  const auto found = client::survey(file, [](double) {});
  for (std::size_t run = 0; run < std::min<std::size_t>(found.runs.size(), 4); ++run) {
    if (!(found.runs[run].ticks_hz() >= 0)) std::abort();
    client::Pipeline pipeline(client::extrapolators()[run % client::extrapolators().size()].make(), {}, {});
    client::CapturedSession session(file, run);
    for (client::CapturedTick tick; session.next(tick);) {
      const auto result = pipeline.render(tick.state, tick.arrived ? &*tick.arrived : nullptr);
      if (!result.f_D.allFinite() || result.f_D.norm() > 8.001) std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return palpate::test::fuzz_file(data, size, ".pcap", &replay);
}
