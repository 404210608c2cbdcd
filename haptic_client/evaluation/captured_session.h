#pragma once
/// What a capture holds of our sessions, tick by tick.
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/capture.h"
#include "protocol/replay_window.h"

namespace palpate::client {

/// The datagrams of one direction, by their sequence numbers.
struct CapturedDirection {
  protocol::LinkStats stats{};
  protocol::ReplayWindow window{};
  std::uint64_t lowest = 0;        ///< number seen in the newest session; 0: none
  std::uint64_t not_captured = 0;  ///< numbers before the lowest, in the sessions before

  /// False for one that the capture holds already.
  bool accept(std::uint64_t sequence);
  void begin_session();
  /// Between those that were captured: what came before the capture began is not lost.
  std::uint64_t lost() const;
};

/// One run of a client, through all its sessions (a server that was started again gives a new one).
struct CapturedRun {
  protocol::Endpoint client;
  std::uint64_t session = 0;                      ///< the last one
  std::uint64_t ticks = 0, samples = 0;           ///< tool states and force samples, without duplicates
  std::uint64_t first_tick = 0, newest_tick = 0;  ///< numbers
  Time first{}, newest{};                         ///< client clock
  CapturedDirection up{}, down{};                 ///< as the capturing machine saw them

  /// Ticks a second; 0 with less than two.
  double ticks_hz() const;
};

/// Sorts datagrams of a capture into runs: by the address of the client, and within one address by tick
/// numbers that start again in a new session. Drops what the capture holds twice (`-i any` sees loopback
/// twice). Memory: a few hundred bytes a run; what comes after 1000 runs is left out.
class CaptureSorter {
 public:
  /// Which run (from 0) a datagram belongs to, if it is a tool state or force sample of ours that did not
  /// come before; `datagram` is decoded into.
  std::optional<std::size_t> sort(const protocol::CapturedDatagram& captured, protocol::Datagram& datagram);

  const std::vector<CapturedRun>& runs() const { return runs_; }
  std::uint64_t ours() const { return ours_; }        ///< accepted datagrams of any kind
  std::uint64_t refused() const { return refused_; }  ///< with our magic, but not acceptable
  std::optional<int> other_version() const { return other_version_; }

 private:
  /// Null when there are too many.
  CapturedRun* run_of(const protocol::Endpoint& client, std::uint64_t session, std::uint64_t tick);
  std::optional<std::size_t> sort_state(const protocol::ToolState& state, const protocol::Header& header,
                                        const protocol::Endpoint& client);

  std::vector<CapturedRun> runs_;
  std::uint64_t ours_ = 0, refused_ = 0;
  std::optional<int> other_version_;
};

/// What a first reading of a capture found.
struct CaptureSurvey {
  std::vector<CapturedRun> runs;
  std::uint64_t packets = 0, ours = 0, refused = 0, other = 0;
  std::string trouble;  ///< why the reading ended early; empty if it did not
};

using ReadingProgress = std::function<void(double share)>;

/// Reads a capture through once. Throws `Error` when it cannot be read or holds nothing to replay. Time grows
/// with the file, memory does not.
CaptureSurvey survey(const std::filesystem::path& file, const ReadingProgress& progress);

/// One tick as the client had it.
struct CapturedTick {
  protocol::ToolState state;
  std::optional<protocol::ForceSample> arrived;  ///< the sample this tick was the first to use
};

/// Reads the ticks of one run in their own order, though the network may have shuffled them.
class CapturedSession {
 public:
  /// `run`: index into `CaptureSurvey::runs` of the same file.
  CapturedSession(const std::filesystem::path& file, std::size_t run);

  /// False at the end.
  bool next(CapturedTick& out);

  /// What is not there, so that the replay cannot be exact.
  struct Missing {
    std::uint64_t ticks = 0;      ///< numbers skipped
    std::uint64_t samples = 0;    ///< used by a tick, but not in the file
    std::uint64_t backwards = 0;  ///< ticks left out: their time is not after the one before
  };
  const Missing& missing() const { return missing_; }
  double share() const { return reader_.share(); }

 private:
  struct Numbered {
    std::uint64_t place;  // in the file
    protocol::ToolState state;
  };
  struct NumberedSample {
    std::uint64_t place;
    protocol::ForceSample sample;
  };
  void fill();
  const protocol::ForceSample* find_sample(std::uint64_t number, std::uint64_t place) const;

  protocol::CaptureReader reader_;
  CaptureSorter sorter_;
  std::size_t run_;
  std::vector<Numbered> waiting_;       // by tick, newest first
  std::deque<NumberedSample> samples_;  // the last ones, oldest first
  std::uint64_t place_ = 0, newest_tick_ = 0, newest_sample_ = 0;
  Time newest_t_{-1};
  bool ended_ = false;
  Missing missing_;
};

}  // namespace palpate::client
