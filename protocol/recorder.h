#pragma once
#include <atomic>
#include <filesystem>
#include <optional>
#include <stop_token>

#include "common/report.h"
#include "common/spsc_ring.h"
#include "protocol/capture.h"
#include "protocol/token_bucket.h"

namespace palpate::protocol {

/// 1e6 bytes a megabyte.
inline std::optional<std::uint64_t> bytes_of_mb(std::optional<double> mb) {
  return mb ? std::optional(static_cast<std::uint64_t>(1e6 * *mb)) : std::nullopt;
}

/// Writes the datagrams of a running program to a capture, without holding up whoever sends and receives
/// them: the network thread notes them in a ring, a thread of its own writes them to disk. A disk that is
/// full or too slow stops or thins the recording, never the session.
class Recorder {
 public:
  /// Makes the capture, beside `file`; it takes its name with the first datagram of a session, so that a run
  /// that nobody answers changes nothing. A file that was there is kept (`set_aside`), or, with `overwrite`,
  /// is lost then. Throws `Error`. Takes 10 MB: room for four seconds at 2000 datagrams a second.
  /// `most_bytes`: at this size a new file begins, F-2.pcap after F.pcap and so on, and of all these the ten
  /// newest are kept; absent: one file of any size.
  explicit Recorder(const std::filesystem::path& file, std::optional<std::uint64_t> most_bytes = {},
                    bool overwrite = false);

  /// Returns the file of a part of a recording, from 1: F.pcap, F-2.pcap, F-3.pcap ...
  static std::filesystem::path path_of(const std::filesystem::path& file, std::uint64_t number);

  /// Notes one datagram that was sent or received at `t` (monotonic clock of this machine). Network thread
  /// only; copies it, never waits. Bytes beyond the longest datagram of ours are not kept.
  void note(Time t, const Endpoint& from, const Endpoint& to, std::span<const std::byte> bytes) noexcept;

  /// Notes a datagram that belongs to no session (refused, doubled, a stranger's Hello or its answer). A few
  /// a second are stored, so that nobody can fill the disk.
  void note_refused(Time t, const Endpoint& from, const Endpoint& to,
                    std::span<const std::byte> bytes) noexcept;

  /// Writes until asked to stop, then writes what is left. In a thread of its own.
  void run(const std::stop_token& stop) noexcept;

  /// True if the disk no longer takes the recording; for a watching thread.
  std::atomic<bool> failed{false};

  struct Stats {
    std::uint64_t files = 1;    ///< that were begun
    std::uint64_t packets = 0;  ///< in them
    std::uint64_t bytes = 0;    ///< of them
    std::uint64_t dropped = 0;  ///< noted, but not in the file
    std::uint64_t refused = 0;  ///< of `note_refused`: not noted, as there were too many
  };
  /// Returns the memory of a recording while it runs, bytes.
  static constexpr std::size_t memory_bytes() { return kRoom * sizeof(Packet); }

  /// When `run` has returned.
  Stats stats() const;
  const std::filesystem::path& file() const { return path_; }
  static constexpr std::uint64_t kStoredFiles = 10;  // of a recording with a quota; the oldest goes

 private:
  struct Packet {
    Time t;
    Endpoint from, to;
    std::size_t length = 0, stored = 0;
    std::array<std::byte, kMaxDatagram> bytes;
  };
  static constexpr std::size_t kRoom = 8192;  // datagrams
  void write_all() noexcept;
  void name_it(const Packet& packet) noexcept;

  /// File of the recording.
  struct Part {
    explicit Part(const std::filesystem::path& path) : file(path, Contents::kCapture), capture(file.path()) {}
    AtomicFile file;
    CaptureWriter capture;
    bool named = false;
  };
  void start_next() noexcept;
  Stats written() const;

  std::filesystem::path path_;
  std::optional<std::uint64_t> most_bytes_;
  bool overwrite_;
  std::optional<Part> part_;  // none after one could not be begun
  Stats ended_{.files = 0};   // of the parts before
  SpscRing<Packet> ring_;
  Time epoch_;  // monotonic 0, since 1970
  std::uint64_t noted_ = 0, refused_ = 0;
  TokenBucket refused_bucket_{20, 100};  // datagrams: 24 kB/s at most
};

}  // namespace palpate::protocol
