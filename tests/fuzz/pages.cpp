// Any pages of a surface, and samples that tell of it, through the law that uses them: the force is finite
// and within its limit.
#include <cstdlib>
#include <vector>

#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "protocol/codec.h"

using namespace palpate;
using namespace palpate::protocol;

namespace {

const client::ExtrapolatorRow& law() {
  for (const auto& row : client::extrapolators()) {
    if (row.name == "local_contact") return row;
  }
  std::abort();
}

}  // namespace

/// Datagrams, one behind the other, each behind its length in two bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  client::Pipeline pipeline(law().make(), {}, {});
  std::span rest = std::as_bytes(std::span(data, size));
  ToolState tool{.tick = 1, .t_ns = 1'000'000'000};
  while (rest.size() >= 2) {
    const std::size_t length = std::min(
        std::to_integer<std::size_t>(rest[0]) + 256 * std::to_integer<std::size_t>(rest[1]), rest.size() - 2);
    Datagram datagram;
    const bool read = decode(rest.subspan(2, length), datagram) == Verdict::kAccepted;
    rest = rest.subspan(2 + length);
    ++tool.tick;
    tool.t_ns += 2'000'000;
    std::vector<SurfacePage> pages;
    if (const auto* page = std::get_if<SurfacePage>(&datagram.message); read && page != nullptr)
      pages.push_back(*page);
    auto* const sample = read ? std::get_if<ForceSample>(&datagram.message) : nullptr;
    if (sample != nullptr) {
      sample->tool_t_ns = tool.t_ns - 1'000'000;
      tool.p_W = sample->p_W;
    }
    const auto result = pipeline.render(tool, sample, pages);
    if (!result.f_D.allFinite() || result.f_D.norm() > 8.001) std::abort();
  }
  return 0;
}
