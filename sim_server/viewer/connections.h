#pragma once
/// Connections to the port of the page: who may open one more, and who has to go for it. No clock, no socket:
/// time is an argument. One thread.
#include <optional>
#include <string>
#include <vector>

#include "common/time.h"

namespace palpate::sim {

/// Bounds connections, of each address and in all. A connection is *silent* while it owes a request: since it
/// was opened, or since the answer to its last request. Where there is no room, the one that has been silent
/// for longest goes, so that nobody keeps a page out by connections that say nothing.
class Connections {
 public:
  using Id = const void*;

  /// Adds a connection from `address` (without its port). Returns the silent one that has to go for it: of
  /// the same address if that has `kMostOfAddress`, else of any; `id` itself where all others are busy. The
  /// caller closes that one.
  std::optional<Id> open(Id id, const std::string& address, Time now);
  /// Marks it as served: a request came, which is being answered, or it is a page.
  void serve(Id id) noexcept;
  /// Marks it as silent from `now` on: its request is answered.
  void answered(Id id, Time now) noexcept;
  void closed(Id id) noexcept;
  /// Removes and returns one that has been silent for longer than `kSilence`; the caller closes it.
  std::optional<Id> take_silent(Time now) noexcept;

  static constexpr std::size_t kMost = 48;           ///< 16 pages, and browsers that fetch files
  static constexpr std::size_t kMostOfAddress = 24;  ///< 16 pages, and a browser that fetches over six
  static constexpr Time kSilence = std::chrono::seconds(5);

 private:
  struct Connection {
    Id id;
    std::string address;
    std::optional<Time> silent_since;  // none: busy
  };
  Connection* find(Id id) noexcept;

  std::vector<Connection> all_;
};

}  // namespace palpate::sim
