#pragma once
/// The ticks of a captured session.
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "haptic_client/evaluation/capture_sorter.h"

namespace palpate::client {

/// Result of a first reading of a capture.
struct CaptureSurvey {
  std::vector<CapturedRun> runs;
  std::uint64_t packets = 0, ours = 0, refused = 0, omitted = 0, other = 0;
  std::string trouble;  ///< why the reading ended early; empty if it did not
};

using ReadingProgress = std::function<void(double fraction)>;

/// Reads a capture through once. Throws `Error` when it cannot be read or holds nothing to replay. Time grows
/// with the file, memory does not.
CaptureSurvey survey(const std::filesystem::path& file, const ReadingProgress& progress);

/// Tick as the client had it.
struct CapturedTick {
  protocol::ToolState state;
  std::optional<protocol::ForceSample> arrived;  ///< the sample this tick was the first to use
  std::vector<protocol::SurfacePage> pages;      ///< of the surface, that this tick was the first to have
};

/// Reads the ticks of one run in their own order, though the network may have shuffled them.
class CapturedSession {
 public:
  /// `run`: index into `CaptureSurvey::runs` of the same file.
  CapturedSession(const std::filesystem::path& file, std::size_t run);

  /// Returns false at the end; then `missing` is complete.
  bool next(CapturedTick& out);

  /// Data that are missing, so that the replay cannot be exact.
  struct Missing {
    std::uint64_t ticks = 0;     ///< numbers skipped, with datagrams that are not in the file
    std::uint64_t left_out = 0;  ///< numbers skipped that never travelled, as at the level sparse of a link
    std::uint64_t samples = 0;   ///< used by a tick, but not in the file
    std::uint64_t pages = 0;     ///< of the surface that a tick knew, but not in the file
    std::uint64_t undated =
        0;  ///< pages that came while ticks did not tell which they had: levels lean, sparse
    std::uint64_t backwards = 0;  ///< ticks left out: their time jumps out of the row, back or ahead
  };
  const Missing& missing() const { return missing_; }
  double fraction() const { return reader_.fraction(); }

 private:
  struct Numbered {
    std::uint64_t place;     // in the file
    std::uint64_t sequence;  // of its datagram
    protocol::ToolState state;
  };
  struct NumberedSample {
    std::uint64_t place;
    protocol::ForceSample sample;
  };
  void fill();
  bool out_of_row(Time t) const;
  void note_gap(const Numbered& tick);
  void hand_over_pages(const protocol::ToolState& state, CapturedTick& out);
  const protocol::ForceSample* find_sample(std::uint64_t number, std::uint64_t place) const;

  protocol::CaptureReader reader_;
  CaptureSorter sorter_;
  std::size_t run_;
  std::vector<Numbered> waiting_;            // by tick, newest first
  std::deque<NumberedSample> samples_;       // the last ones, oldest first
  std::deque<protocol::SurfacePage> pages_;  // that no tick has had, oldest first
  std::uint64_t place_ = 0, newest_tick_ = 0, newest_sample_ = 0, pages_taken_ = 0, sequence_ = 0;
  bool tells_pages_ = true;  // the tick before did
  Time newest_t_{-1};
  bool ended_ = false;
  Missing missing_;
};

}  // namespace palpate::client
