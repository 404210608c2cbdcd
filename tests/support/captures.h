#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "common/error.h"
#include "protocol/capture.h"
#include "tests/support/catch.h"
#include "tests/support/hex.h"
#include "tests/support/temporary_folder.h"

namespace palpate::test {

inline const protocol::Endpoint kFrom{.address = {192, 168, 0, 1}, .port = 4660};
inline const protocol::Endpoint kTo{.address = {192, 168, 0, 199}, .port = 45130};

/// "pal" from kFrom to kTo, raw IPv4: 31 bytes.
inline const std::string kPal = "4500001f 00004000 4011b8b5 c0a80001 c0a800c7 1234b04a 000bdede 70616c";
inline const std::string kNanoLittle = "4d3cb2a1 0200 0400 00000000 00000000 ffff0000 65000000 ";
inline constexpr Time kMicro{1'700'000'000'123'456'000}, kNano{1'700'000'000'123'456'789};

inline std::filesystem::path write_file(const TemporaryFolder& folder, const Bytes& content) {
  return folder.write("a.pcap", std::string(reinterpret_cast<const char*>(content.data()), content.size()));
}

template <class Capture>
inline std::string error_of(const std::filesystem::path& path) {
  try {
    const Capture capture(path);
  } catch (const Error& e) {
    CHECK(e.exit_code() == 2);
    return e.what();
  }
  return "no error";
}

struct Content {
  std::vector<Time> times;
  std::vector<std::string> payloads;
  std::vector<std::size_t> lengths;
  protocol::CaptureReader::Skipped skipped;
  std::uint64_t packets = 0;
  std::string trouble;
};

inline Content read_all(const std::filesystem::path& path) {
  protocol::CaptureReader reader(path);
  Content content;
  protocol::CapturedDatagram datagram;
  double fraction = 0;
  while (reader.next(datagram)) {
    CHECK(reader.fraction() >= fraction);
    fraction = reader.fraction();
    content.times.push_back(datagram.t);
    content.payloads.push_back(hex(datagram.bytes));
    content.lengths.push_back(datagram.length);
  }
  CHECK(reader.fraction() == 1);
  CHECK_FALSE(reader.next(datagram));
  content.skipped = reader.skipped();
  content.packets = reader.packets();
  content.trouble = reader.trouble();
  return content;
}

inline Content read_all(const std::string& text) {
  const TemporaryFolder folder;
  return read_all(write_file(folder, bytes(text)));
}

}  // namespace palpate::test
