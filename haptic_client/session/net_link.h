#pragma once
#include <atomic>

#include "haptic_client/session/haptic_loop.h"
#include "haptic_client/session/link_figures.h"
#include "haptic_client/session/link_pace.h"
#include "protocol/link_watcher.h"
#include "protocol/recorder.h"
#include "protocol/udp_socket.h"

namespace palpate::client {

/// The network thread of the client: tool states out, force samples in, the session kept alive.
class NetLink {
 public:
  /// `key`: that of the server, or none. `recorder`: gets every datagram; may be null.
  NetLink(protocol::UdpSocket& socket, const protocol::Endpoint& server, HapticMailboxes& mailboxes,
          const protocol::Key& key, protocol::Recorder* recorder);

  /// Serves until `stop`, then says Bye.
  void run();
  void stop() { socket_.stop(); }

  /// Read when `run` has returned.
  const protocol::LinkStats& stats() const { return stats_; }
  const LinkFigures& figures() const { return figures_; }
  const LinkPace& pace() const { return pace_; }
  /// Watcher of the link, for a watching thread.
  protocol::LinkWatcher watcher;
  const protocol::ClientSession& session() const { return session_; }

  /// True if a server ever admitted this client. The next one is the reason of the last server that did not
  /// (0: no answer). For a watching thread.
  std::atomic<bool> welcomed{false};
  std::atomic<int> refused{0};
  /// The version of the protocol that the server speaks, if that is not ours.
  std::atomic<int> other_version{0};
  /// The `protocol::KeyMismatch` of the newest answer that was not of who has our key; -1: none came.
  std::atomic<int> key_mismatch{-1};
  /// Level of the link, for a watching thread.
  std::atomic<LinkLevel> level{LinkLevel::kPacked};
  /// True while the way drops large datagrams (`LinkFigures::drops_large`).
  std::atomic<bool> drops_large{false};
  /// `errno` of the newest datagram, if the system would not send it: there is no way to the server.
  std::atomic<int> unsendable{0};

 private:
  void on_datagram(std::span<const std::byte> bytes, const protocol::Endpoint& from);
  void on_tool_states();
  void on_timer();
  void pass_on(const protocol::Message& message, Time t);
  void greet();
  void release();
  void send_ticks(std::span<const protocol::ToolState> ticks);
  void send(const protocol::Message& message);
  void send(std::span<const std::byte> bytes);

  protocol::UdpSocket& socket_;
  protocol::Endpoint server_, own_;
  protocol::Recorder* recorder_;
  HapticMailboxes& mailboxes_;
  protocol::Pointer pointer_{};  // the newest of a page
  std::uint64_t session_number_ = 0;
  protocol::ClientSession session_;
  bool ticking_ = false;  // tool states have come from the haptic loop
  int idle_timers_ = 0;   // looks at the session before that
  LinkPace pace_;
  std::uint16_t buttons_ = 0;                 // of the newest tick: another leaves at once
  std::vector<protocol::ToolState> waiting_;  // ticks that the next datagram takes along, oldest first
  protocol::LinkStats stats_;
  LinkFigures figures_;
};

}  // namespace palpate::client
