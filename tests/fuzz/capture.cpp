#include "protocol/capture.h"

#include "protocol/link_frames.h"
#include "tests/fuzz/file_fuzzer.h"

/// The bytes as one frame of every link type, then as a file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate::protocol;
  for (const int link : {0, 1, 12, 14, 101, 108, 113, 228, 229, 276}) {
    UdpFrame frame;
    parse_frame(LinkType{link}, std::as_bytes(std::span(data, size)), frame);
  }
  return palpate::test::fuzz_file(data, size, ".pcap", [](const std::string& file) {
    CaptureReader reader(file);
    CapturedDatagram datagram;
    while (reader.next(datagram)) {
      // Touched, so that the sanitizer sees a span that is not the packet's.
      std::size_t sum = 0;
      for (const std::byte b : datagram.bytes) sum += std::to_integer<std::size_t>(b);
      if (sum > 255 * datagram.length || reader.fraction() > 1) __builtin_trap();
    }
  });
}
