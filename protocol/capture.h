#pragma once
/// Captures: files of packets as Wireshark, tcpdump and dumpcap write and read them. Built without them
/// (PALPATE_CAPTURE=OFF), both constructors throw an `Error` that says so.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "common/time.h"
#include "protocol/session.h"

namespace palpate::protocol {

/// Writes datagrams to a pcap file: nanosecond stamps, raw IP, at most 65535 bytes a packet. The same calls
/// give the same bytes. One thread at a time. A call costs a copy of the datagram and, every 32 kB, a write
/// that may wait for the disk: not for the haptic thread.
class CaptureWriter {
 public:
  /// Makes the file, or empties it. Throws `Error` when it cannot be opened for writing.
  explicit CaptureWriter(const std::filesystem::path& path);
  ~CaptureWriter();  ///< flushes and closes

  /// Adds one datagram. `since_1970`: ns; times outside the 32-bit seconds of the format are clamped.
  /// `length`: of the payload as sent, bytes, at least payload.size(); more says that the rest was not kept.
  /// False when this or anything before could not be written, or no UDP datagram has this length; stays false
  /// from then on.
  bool write(Time since_1970, const Endpoint& from, const Endpoint& to, std::span<const std::byte> payload,
             std::size_t length) noexcept;

  /// Hands everything to the system. False as for `write`. After a failure a regular file is cut behind the
  /// last packet that was flushed, and the counters fall back to it.
  bool flush() noexcept;

  std::uint64_t packets() const noexcept { return written_.packets; }
  std::uint64_t bytes() const noexcept { return written_.bytes; }  ///< of the file

 private:
  struct File;
  struct Count {
    std::uint64_t packets = 0, bytes = 0;
  };
  bool give_up() noexcept;

  std::unique_ptr<File> file_;
  Count written_, flushed_;
  bool failed_ = false;
};

/// A UDP datagram of a capture.
struct CapturedDatagram {
  Time t{};  ///< since 1970, ns; 0 where the file has no stamp
  Endpoint from, to;
  std::span<const std::byte> bytes;  ///< what was captured; valid until the next call of `next`
  std::size_t length = 0;            ///< as sent, bytes; above bytes.size() when the capture cut it
};

/// Reads the UDP datagrams of a capture, a packet at a time: memory does not grow with the file. Reads pcap
/// (us and ns, either order of bytes) and pcapng; its frames are those of protocol/link_frames.h. One thread
/// at a time.
class CaptureReader {
 public:
  /// Opens the file and reads its header and first packet. Throws `Error` when there is no such file, or it
  /// is a folder, empty, no capture, or one with frames we do not know.
  explicit CaptureReader(const std::filesystem::path& path);
  ~CaptureReader();

  /// The next UDP datagram, past everything else; false at the end, and always from then on.
  bool next(CapturedDatagram& out) noexcept;

  /// Why the reading ended early, as what a sentence says of the file ("ends in the middle of a packet;
  /// ..."); empty while it did not.
  std::string trouble() const { return trouble_; }

  /// Packets that held no whole UDP datagram.
  struct Skipped {
    std::uint64_t other = 0, fragments = 0, malformed = 0;
  };
  const Skipped& skipped() const noexcept { return skipped_; }
  std::uint64_t packets() const noexcept { return packets_; }  ///< of any kind, so far

  /// Returns the fraction of the file that was read, 0 to 1; 0 for a pipe until it ends.
  double fraction() const noexcept;

 private:
  struct File;
  void end(int reason) noexcept;

  std::unique_ptr<File> file_;
  std::string trouble_;
  Skipped skipped_;
  std::uint64_t packets_ = 0;
  bool ended_ = false;
};

}  // namespace palpate::protocol
