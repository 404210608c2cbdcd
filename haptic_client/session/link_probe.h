#pragma once
#include <array>
#include <thread>

#include "common/doorbell.h"
#include "common/histogram.h"
#include "protocol/auth.h"
#include "protocol/udp_socket.h"

namespace palpate::client {

/// Measures the way to a server and back, beside any session: says Hello without a cookie, which every server
/// answers at once with a Challenge and forgets, and takes the time. 284 bytes there and 68 back (16 more
/// each with a key, 28 for IPv4 and UDP): at most 12.5 kbit/s there, 5 % of a link of 256 kbit/s, so that it
/// does not spoil what it measures. 48 round trips in 10 s give a median and a largest; p99 is that.
class LinkProbe {
 public:
  static constexpr Time kBetweenHellos = std::chrono::milliseconds(210);

  /// Opens a socket. Throws `Error`.
  LinkProbe(const protocol::Endpoint& server, const protocol::Key& key);
  ~LinkProbe() { stop(); }

  void start();
  void stop();

  struct Figures {
    Histogram round_trip_ns;
    double jitter_ns =
        0;  ///< mean change from one round trip to the next, smoothed (RFC 3550, section 6.4.1)
    std::uint64_t sent = 0, lost = 0, reordered = 0;
    std::uint64_t bytes_up = 0;  ///< of UDP's payload
    int unsendable = 0;          ///< `errno` of the newest Hello that the system would not send
  };
  /// When it has stopped. A Hello of the last second that nobody answered counts as on its way.
  const Figures& figures() const { return figures_; }

 private:
  static constexpr std::size_t kStored = 64;  // Hellos: 13 s
  void say_hello();
  void take(std::span<const std::byte> bytes, const protocol::Endpoint& from);

  protocol::Endpoint server_;
  protocol::UdpSocket socket_;
  protocol::Nonce nonce_;
  protocol::Key up_, down_;
  std::array<Time, kStored> said_{};  // when, by attempt; 0: answered
  std::uint64_t newest_answered_ = 0;
  double before_ns_ = 0;
  Figures figures_;
  std::jthread thread_;
};

}  // namespace palpate::client
