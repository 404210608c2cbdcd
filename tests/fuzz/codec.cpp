// Any bytes as a datagram: refused, or a message that encodes again.
#include <cstdlib>

#include "protocol/earlier_ticks.h"

using namespace palpate::protocol;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Datagram datagram;
  if (decode({reinterpret_cast<const std::byte*>(data), size}, datagram) != Verdict::kAccepted) return 0;
  std::array<std::byte, kMaxDatagram> bytes;
  Datagram again;
  const std::size_t written = encode(datagram.header, datagram.message, bytes);
  if (decode({bytes.data(), written}, again) != Verdict::kAccepted) std::abort();
  const std::vector<ToolState> ticks = ticks_of(datagram);
  if (ticks.empty()) return 0;
  const std::size_t packed = encode_ticks(datagram.header, ticks, bytes);
  if (packed == 0) return 0;  // another writer packs them otherwise
  if (decode({bytes.data(), packed}, again) != Verdict::kAccepted) std::abort();
  if (ticks_of(again).size() != ticks.size()) std::abort();
  return 0;
}
