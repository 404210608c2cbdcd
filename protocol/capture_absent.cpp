/// Stands in for capture.cpp in a build without libpcap (PALPATE_CAPTURE=OFF): nothing can be made, so
/// nothing is ever called.
#include "common/error.h"
#include "protocol/capture.h"

namespace palpate::protocol {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
  fail(
      "captures were left out of this build (PALPATE_CAPTURE=OFF); build with it, and libpcap-dev, to read "
      "or "
      "write {}",
      path.string());
}

}  // namespace

struct CaptureWriter::File {};
CaptureWriter::CaptureWriter(const std::filesystem::path& path) {
  refuse(path);
}
CaptureWriter::~CaptureWriter() = default;
bool CaptureWriter::write(Time, const Endpoint&, const Endpoint&, std::span<const std::byte>,
                          std::size_t) noexcept {
  return false;
}
bool CaptureWriter::flush() noexcept {
  return false;
}

struct CaptureReader::File {};
CaptureReader::CaptureReader(const std::filesystem::path& path) {
  refuse(path);
}
CaptureReader::~CaptureReader() = default;
bool CaptureReader::next(CapturedDatagram&) noexcept {
  return false;
}
double CaptureReader::fraction() const noexcept {
  return 0;
}

}  // namespace palpate::protocol
