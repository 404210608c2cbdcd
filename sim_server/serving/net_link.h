#pragma once
#include <atomic>

#include "protocol/link_watcher.h"
#include "protocol/recorder.h"
#include "protocol/udp_socket.h"
#include "sim_server/serving/page_mailboxes.h"
#include "sim_server/serving/sim_loop.h"

namespace palpate::sim {

/// The network thread of the server: datagrams in, sessions kept, forces out.
class NetLink {
 public:
  /// `recorder`: gets every datagram; may be null. `page`: of those that watch; null: nobody can.
  NetLink(protocol::UdpSocket& socket, protocol::ServerSessions sessions, SimMailboxes& mailboxes,
          protocol::Recorder* recorder, PageMailboxes* page = nullptr);

  /// Serves until `stop`, then says Bye to every member.
  void run();
  void stop() { socket_.stop(); }

  /// Read when `run` has returned.
  const protocol::LinkStats& stats() const { return stats_; }

  /// Somebody's Hello that is not of who has our key. For a watching thread.
  struct Mismatch {
    protocol::KeyMismatch why{};
    protocol::Endpoint from{};
  };
  LatestValue<Mismatch> mismatch;

  /// Watcher of the link, for a watching thread.
  protocol::LinkWatcher watcher;

  /// Sessions of a tool: whether somebody holds it, and how many sessions held it so far. For a watching
  /// thread.
  struct ToolSessions {
    std::atomic<bool> held{false};
    std::atomic<int> so_far{0};
  };
  std::array<ToolSessions, kMaxTools> tools;

 private:
  void on_datagram(std::span<const std::byte> bytes, const protocol::Endpoint& from);
  void refuse(protocol::Verdict verdict, std::span<const std::byte> bytes, const protocol::Endpoint& to);
  void on_forces();
  void tell_uplink(protocol::ForceSample& sample) const;
  void send_pointers();
  void pass_on(std::uint64_t session, std::span<const protocol::ToolState> ticks);
  void send_pages(std::span<const protocol::ToolState> ticks, Time t);
  void note_holders();
  void report_peers();
  void on_timer();
  void tool_is_free(std::uint8_t tool);
  void send(protocol::ServerSessions::Member& member, const protocol::Message& message);
  void answer(const protocol::ServerSessions::Outcome& outcome, const protocol::Endpoint& to);
  void send(std::span<const std::byte> bytes, const protocol::Endpoint& to, const protocol::Endpoint& from,
            bool ours);
  enum class Direction { kIn, kOut };
  void record(Time t, const protocol::Endpoint& peer, Direction direction, std::span<const std::byte> bytes,
              bool ours);

  const protocol::Endpoint& own_towards(const protocol::Endpoint& peer);

  protocol::UdpSocket& socket_;
  protocol::Recorder* recorder_;
  protocol::Endpoint peer_, own_;  // whom we last talked to, and how he sees us
  protocol::ServerSessions sessions_;
  SimMailboxes& mailboxes_;
  PageMailboxes* page_;
  std::array<SessionInput, kMaxTools> inputs_;                     // of each tool, the newest
  std::vector<protocol::TokenBucket> page_buckets_;                // of each tool
  std::array<std::shared_ptr<SurfacePager>, kMaxTools> pagers_{};  // of each tool, the newest; null: none
  protocol::LinkStats stats_;
  std::array<protocol::Endpoint, kMaxTools>
      requested_;                              // which of our addresses the client of each tool asks
  std::array<PeerCounts, kMaxTools> peers_{};  // for pages
};

}  // namespace palpate::sim
