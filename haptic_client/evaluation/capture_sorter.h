#pragma once
/// Which datagrams of a capture belong together.
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "protocol/capture.h"
#include "protocol/replay_window.h"

namespace palpate::client {

/// Largest distance, in datagrams, by which a datagram of a capture may be out of order.
constexpr std::size_t kShuffled = 64;
/// Times of a client's clock that make sense: from 0 to 73 years.
constexpr bool sensible(Time t) {
  return t >= Time::zero() && t <= Time{Time::rep{1} << 61};
}

/// The datagrams of one direction of a session, by their sequence numbers.
struct CapturedDirection {
  protocol::LinkStats stats{};
  protocol::ReplayWindow window{std::numeric_limits<std::uint64_t>::max()};  // a capture may have gaps
  bool begun = false;

  /// False for one that the capture holds already.
  bool accept(std::uint64_t sequence);
  /// Between those that were captured: what came before the capture began is not lost.
  std::uint64_t lost() const { return stats.lost; }
};

/// Session of a run, as the capturing machine saw it.
struct CapturedLink {
  std::uint64_t session = 0;
  std::optional<protocol::ScenePrint> scene{};  ///< of which its forces are, if its Welcome tells
  CapturedDirection up{}, down{};
};

/// Run of a client, through all its sessions. A server that was restarted starts a new session.
struct CapturedRun {
  protocol::Endpoint client;  ///< the newest, where its address changed
  std::vector<CapturedLink> links{};
  std::uint64_t ticks = 0, samples = 0;           ///< tool states and force samples, without duplicates
  std::uint64_t first_tick = 0, newest_tick = 0;  ///< numbers; 0: none yet
  Time first{}, newest{};                         ///< client clock

  /// Ticks a second; 0 with less than two.
  double ticks_hz() const;
  std::uint64_t lost() const, reordered() const, duplicated() const;
};

/// Sorts datagrams of a capture into runs, by their session, whose client may change its address. A new
/// session belongs to the newest run of its client's address, unless its tick numbers start again. Drops what
/// the capture holds twice (`-i any` sees loopback twice). Memory: some hundred bytes a session; what comes
/// after 1000 runs, or 1000 sessions of one, is left out.
class CaptureSorter {
 public:
  /// Which run (from 0) a datagram belongs to, if it is a tool state, force sample or page of a surface of
  /// ours that did not come before; `datagram` is decoded into.
  std::optional<std::size_t> sort(const protocol::CapturedDatagram& captured, protocol::Datagram& datagram);

  const std::vector<CapturedRun>& runs() const { return runs_; }
  std::uint64_t ours() const { return ours_; }        ///< accepted datagrams of any kind
  std::uint64_t refused() const { return refused_; }  ///< with our magic, but not acceptable
  std::uint64_t omitted() const { return omitted_; }  ///< of too many runs or sessions
  std::optional<int> other_version() const { return other_version_; }

 private:
  struct Place {
    CapturedRun* run = nullptr;
    CapturedLink* link = nullptr;
  };
  Place known(const protocol::Endpoint& client, std::uint64_t session);
  CapturedRun* newest_run(const protocol::Endpoint& client);
  CapturedRun* start_run(const protocol::Endpoint& client);
  Place place_of(const protocol::ToolState& state, const protocol::Endpoint& client, std::uint64_t session);
  std::optional<std::size_t> sort_states(std::span<const protocol::ToolState> ticks,
                                         const protocol::Header& header, const protocol::Endpoint& client);
  CapturedLink& add_link(CapturedRun& run, std::uint64_t session);
  void welcome(const protocol::Welcome& welcome, const protocol::Header& header,
               const protocol::Endpoint& client);
  static void add_tick(CapturedRun& run, const protocol::ToolState& tick);
  std::optional<std::size_t> sort_sample(const protocol::Header& header, const protocol::Endpoint& client,
                                         bool is_sample);

  std::vector<CapturedRun> runs_;
  std::uint64_t ours_ = 0, refused_ = 0, omitted_ = 0;
  std::optional<int> other_version_;
  std::map<std::uint64_t, std::optional<protocol::ScenePrint>> scenes_;  // by session
};

}  // namespace palpate::client
