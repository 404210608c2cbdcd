#pragma once
#include <memory>
#include <string>

#include "sim_server/viewer/access.h"
#include "sim_server/viewer/encoding.h"
#include "sim_server/viewer/feed.h"

namespace palpate::sim {

/// The most pages at once; one more is turned away.
constexpr int kMostPages = 16;

/// Throws `Error` where that address cannot be listened on, as a port that another program has, or where this
/// build has no viewer.
void require_free(const ViewerAddress& address);

/// Serves the page and what it shows over HTTP and WebSocket, in a thread of its own (the only file that
/// knows libwebsockets). Holds 6 bytes a vertex for each page, and one message of it that is on its way.
class Viewer {
 public:
  /// Listens from now on. `token`: who has it may pause, point and choose; empty: nobody. `session`: what
  /// `/session` answers with, of a recording. All outlive this. Throws `Error` where the address cannot be
  /// had, or where this build has no viewer.
  Viewer(const ViewerAddress& address, std::string token, const SceneFacts& scene, ViewerFeed& feed,
         const Bytes* session = nullptr);
  ~Viewer();

  /// Returns the address, with the port that the system chose.
  const protocol::Endpoint& endpoint() const;

  /// Serves until `stop`. One thread.
  void run() noexcept;
  /// Any thread.
  void stop() noexcept;

  /// Something new stands in the feed. Any thread; a write to a descriptor, about 1 us; no lock of ours, no
  /// allocation.
  void ring() noexcept;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace palpate::sim
