#include "protocol/capture.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <pcap/pcap.h>
#include <stdio_ext.h>
#include <string_view>
#include <system_error>
#include <unistd.h>

#include "common/error.h"
#include "common/files.h"
#include "protocol/link_frames.h"

namespace palpate::protocol {
namespace {

constexpr int kSnapLength = 65535;                           // the largest IP packet
constexpr std::size_t kFileHeader = 24, kPacketHeader = 16;  // bytes, of the pcap format
constexpr std::size_t kChunk =
    32 * 1024;  // flushed together, so that the file always ends with a whole packet
constexpr std::size_t kBuffer = kChunk + kPacketHeader + kSnapLength + kFileHeader;
constexpr std::int64_t kSecond = 1'000'000'000, kSecondsEnd = std::int64_t{1} << 32;  // of the format

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
  void operator()(pcap_t* pcap) const { pcap_close(pcap); }
  void operator()(pcap_dumper_t* dumper) const { pcap_dump_close(dumper); }
};
template <class T>
using Owned = std::unique_ptr<T, Close>;

Owned<std::FILE> opened(const std::filesystem::path& path, const char* mode, const char* advice) {
  Owned<std::FILE> file(std::fopen(path.c_str(), mode));
  if (!file) fail("{}: {}; {}", path.string(), std::generic_category().message(errno), advice);
  return file;
}

Time time_of(const timeval& stamp) {
  // The format's seconds are unsigned, libpcap's are not: it gives those after 2038 as negative.
  const std::int64_t second = stamp.tv_sec + (stamp.tv_sec < 0 ? kSecondsEnd : 0);
  const std::int64_t ns = std::clamp<std::int64_t>(stamp.tv_usec, 0, kSecond - 1);
  return Time{std::clamp<std::int64_t>(second, 0, 9 * kSecond) * kSecond + ns};
}

}  // namespace

struct CaptureWriter::File {
  std::array<char, kBuffer> buffer{};  // of the stream, so it goes last
  std::array<std::byte, kSnapLength> frame{};
  Owned<pcap_t> format;
  Owned<pcap_dumper_t> dumper;
  bool regular = false;
};

CaptureWriter::CaptureWriter(const std::filesystem::path& path) : file_(std::make_unique<File>()) {
  Owned<std::FILE> stream = opened(path, "wbe", "name a file in a folder you may write to");
  std::setvbuf(stream.get(), file_->buffer.data(), _IOFBF, kBuffer);
  file_->format.reset(pcap_open_dead_with_tstamp_precision(DLT_RAW, kSnapLength, PCAP_TSTAMP_PRECISION_NANO));
  if (file_->format) file_->dumper.reset(pcap_dump_fopen(file_->format.get(), stream.release()));
  if (!file_->dumper) fail_at_run_time("{}: libpcap cannot begin a capture; free some memory", path.string());
  std::error_code ignored;
  file_->regular = std::filesystem::is_regular_file(path, ignored);
  written_.bytes = kFileHeader;
}

CaptureWriter::~CaptureWriter() {
  flush();
}

bool CaptureWriter::write(Time since_1970, const Endpoint& from, const Endpoint& to,
                          std::span<const std::byte> payload, std::size_t length) noexcept {
  if (failed_) return false;
  const auto stored = payload.first(std::min(payload.size(), kSnapLength - kMaxFrameHeaders));
  const std::size_t size = build_frame(from, to, stored, length, file_->frame);
  if (size == 0) {
    flush();  // what came before is good
    return give_up();
  }
  const std::int64_t ns = std::clamp<std::int64_t>(since_1970.count(), 0, kSecondsEnd * kSecond - 1);
  pcap_pkthdr header{};
  header.ts.tv_sec = ns / kSecond;
  header.ts.tv_usec = ns % kSecond;  // nanoseconds in a file of that precision
  header.caplen = static_cast<bpf_u_int32>(size);
  header.len = static_cast<bpf_u_int32>(size - stored.size() + length);
  pcap_dump(reinterpret_cast<u_char*>(file_->dumper.get()), &header,
            reinterpret_cast<const u_char*>(file_->frame.data()));
  ++written_.packets;
  written_.bytes += kPacketHeader + size;
  return written_.bytes - flushed_.bytes < kChunk || flush();
}

bool CaptureWriter::flush() noexcept {
  if (failed_) return false;
  if (pcap_dump_flush(file_->dumper.get()) != 0 || std::ferror(pcap_dump_file(file_->dumper.get())) != 0) {
    return give_up();
  }
  flushed_ = written_;
  return true;
}

bool CaptureWriter::give_up() noexcept {
  failed_ = true;
  written_ = flushed_;
  std::FILE* stream = pcap_dump_file(file_->dumper.get());
  __fpurge(stream);  // so that closing does not try again, whatever the C library
  if (file_->regular && ftruncate(fileno(stream), static_cast<off_t>(flushed_.bytes)) != 0) {
    // Then the file ends in the middle of a packet, which readers can live with.
  }
  return false;
}

struct CaptureReader::File {
  Owned<pcap_t> pcap;
  LinkType link{};
  std::uintmax_t size = 0;  // 0: not known
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  int ahead = 0;  // what the constructor's look at the first packet gave, until `next` takes it

  int fetch() {
    const int result = ahead != 0 ? ahead : pcap_next_ex(pcap.get(), &header, &bytes);
    ahead = 0;
    return result;
  }
  std::string_view libpcap_says() { return pcap_geterr(pcap.get()); }
};

namespace {

constexpr const char* kWhatIsRead =
    "pcap and pcapng files are read; `editcap -F pcap IN OUT` converts many others";

void check_file(const std::filesystem::path& path) {
  require_file(path, "a capture file");
  std::error_code failed;
  if (std::filesystem::file_size(path, failed) == 0 && !failed) {
    fail("{}: is empty (0 bytes), so no capture; {}", path.string(), kWhatIsRead);
  }
}

/// pcapng may mix interfaces, libpcap's reader may not.
bool mixes_interfaces(std::string_view libpcap_says) {
  return libpcap_says.find("different from the") != std::string_view::npos;
}

constexpr const char* kMixed =
    "mixes interfaces with different link types or snap lengths, which libpcap cannot read; if they differ "
    "only "
    "in snap length, `editcap -F pcap IN OUT` helps, else capture one interface at a time";

/// libpcap would only call it no capture.
void refuse_compressed(std::FILE* stream, const std::filesystem::path& path) {
  struct Packer {
    std::array<unsigned char, 2> begins;
    const char* unpack;
  };
  static constexpr std::array<Packer, 3> kPackers{
      {{{0x1f, 0x8b}, "gunzip -k"}, {{0x28, 0xb5}, "unzstd"}, {{0xfd, '7'}, "unxz -k"}}};
  std::array<unsigned char, 2> first{};
  const std::size_t read = std::fread(first.data(), 1, first.size(), stream);
  std::rewind(stream);
  for (const Packer& packer : kPackers) {
    if (read == first.size() && first == packer.begins)
      fail("{}: is compressed; `{} {}` unpacks it", path.string(), packer.unpack, path.string());
  }
}

}  // namespace

CaptureReader::CaptureReader(const std::filesystem::path& path) : file_(std::make_unique<File>()) {
  check_file(path);
  Owned<std::FILE> stream = opened(path, "rbe", "check its permissions");
  refuse_compressed(stream.get(), path);
  std::array<char, PCAP_ERRBUF_SIZE> said{};
  file_->pcap.reset(
      pcap_fopen_offline_with_tstamp_precision(stream.get(), PCAP_TSTAMP_PRECISION_NANO, said.data()));
  if (!file_->pcap) fail("{}: is not a capture ({}); {}", path.string(), said.data(), kWhatIsRead);
  (void)stream.release();  // libpcap's from now on
  const int link = pcap_datalink(file_->pcap.get());
  file_->link = LinkType{link};
  if (!supported(file_->link)) {
    const char* name = pcap_datalink_val_to_name(link);
    fail("{}: link type {} ({}) is not supported; capture on one of these: {}", path.string(), link,
         name != nullptr ? name : "no name", kLinkTypesRead);
  }
  std::error_code failed;
  file_->size = std::filesystem::file_size(path, failed);
  if (failed) file_->size = 0;
  file_->ahead = file_->fetch();
  if (file_->ahead == PCAP_ERROR && mixes_interfaces(file_->libpcap_says()))
    fail("{}: {}", path.string(), kMixed);
}

CaptureReader::~CaptureReader() = default;

bool CaptureReader::next(CapturedDatagram& out) noexcept {
  while (!ended_) {
    const int result = file_->fetch();
    if (result != 1) {
      end(result);
      break;
    }
    ++packets_;
    UdpFrame frame;
    switch (parse_frame(file_->link, std::as_bytes(std::span(file_->bytes, file_->header->caplen)), frame)) {
      case FrameVerdict::kOtherTraffic:
        ++skipped_.other;
        break;
      case FrameVerdict::kFragment:
        ++skipped_.fragments;
        break;
      case FrameVerdict::kMalformed:
        ++skipped_.malformed;
        break;
      case FrameVerdict::kDatagram:
        out = {time_of(file_->header->ts), frame.from, frame.to, frame.payload, frame.length};
        return true;
    }
  }
  return false;
}

void CaptureReader::end(int reason) noexcept {
  ended_ = true;
  if (reason == PCAP_ERROR_BREAK) return;  // the end of the file
  const std::string_view said = file_->libpcap_says();
  const std::string used = fmt::format("the {} packets before it were used", packets_);
  if (said.starts_with("truncated")) {
    trouble_ = fmt::format("ends in the middle of a packet; {}", used);
  } else if (mixes_interfaces(said)) {
    trouble_ = fmt::format("{}; {}", kMixed, used);
  } else {
    trouble_ = fmt::format("is damaged ({}); {}", said, used);
  }
}

double CaptureReader::fraction() const noexcept {
  if (ended_) return 1;
  const off_t at = ftello(pcap_file(file_->pcap.get()));
  if (file_->size == 0 || at < 0) return 0;
  return std::min(1.0, static_cast<double>(at) / static_cast<double>(file_->size));
}

}  // namespace palpate::protocol
