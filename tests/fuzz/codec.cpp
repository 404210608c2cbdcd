// Any bytes as a datagram: refused, or a message that encodes again.
#include "protocol/codec.h"

#include <cstdlib>

using namespace palpate::protocol;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Datagram datagram;
  if (decode({reinterpret_cast<const std::byte*>(data), size}, datagram) != Verdict::kAccepted) return 0;
  std::array<std::byte, kMaxDatagram> bytes;
  Datagram again;
  const std::size_t written = encode(datagram.header, datagram.message, bytes);
  if (decode({bytes.data(), written}, again) != Verdict::kAccepted) std::abort();
  return 0;
}
