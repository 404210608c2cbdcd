#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <system_error>

#include "common/doorbell.h"
#include "common/time.h"
#include "protocol/session.h"

namespace palpate::protocol {

/// "HOST:PORT" -> endpoint; an IPv6 host stands in brackets. `where` (an option, or FILE:LINE) begins the
/// `Error` that says what is wrong with
/// `text`.
Endpoint resolve(const std::string& text, const std::string& where);

/// "1.2.3.4:567", "[::1]:567" or "[fe80::1%eth0]:567".
std::string to_string(const Endpoint& endpoint);

/// A UDP socket with the event loop of the one thread that serves it (the only file that knows Asio).
class UdpSocket {
 public:
  /// Called in the thread that runs `run`.
  struct Handlers {
    std::function<void(std::span<const std::byte>, const Endpoint&)> on_datagram;
    std::function<void()> on_doorbell;  ///< `doorbell` rang: a mailbox has something to send
    std::function<void()> on_timer;     ///< every `timer_period`
  };

  /// Binds to `local` (port 0: any). Throws `Error` (run time) naming the address when it is taken or not
  /// ours.
  explicit UdpSocket(const Endpoint& local);
  /// Binds to `local`, served by the loop of `other`, which outlives this: `on_datagram` is called in the
  /// thread that runs that loop. Call it before `other` runs, or in its thread.
  UdpSocket(const Endpoint& local, UdpSocket& other,
            std::function<void(std::span<const std::byte>, const Endpoint&)> on_datagram);
  ~UdpSocket();

  /// The address it is bound to, with the port the system chose.
  Endpoint local() const;

  /// The address of this machine that `peer` sees: `local`, with the interface the system would send from
  /// where it is bound to all of them. Asks the routing table; sends nothing.
  Endpoint local_towards(const Endpoint& peer) const;

  /// Answer to one datagram.
  struct Answer {
    std::error_code error{};         ///< of the network
    std::vector<std::byte> bytes{};  ///< of the peer; empty: none
  };
  /// Sends one datagram, and returns what answers it within `patience`. The network says that nothing listens
  /// at that port (ECONNREFUSED), that a firewall or router rejects it, or that there is no way; it says
  /// nothing where a datagram arrives, or is dropped.
  static Answer answer_of(const Endpoint& peer, std::span<const std::byte> request, Time patience);

  /// Returns when the kernel had the datagram that `on_datagram` is being called with. Thread of `run`.
  Time arrived() const noexcept;
  /// Returns the address of this machine to which that datagram was sent, where the socket is bound to all of
  /// them; else port 0.
  const Endpoint& requested() const noexcept;

  /// Serves until `stop`. One thread.
  void run(Doorbell& doorbell, Time timer_period, const Handlers& handlers);

  /// Ends `run`; any thread.
  void stop();

  /// Sends without waiting; says why where the system would not take it. `from`: which of our addresses, as
  /// `requested` told; port 0, or an address that is ours no more: as the routes go. Thread of `run`, or when
  /// none runs.
  std::error_code send(std::span<const std::byte> datagram, const Endpoint& to,
                       const Endpoint& from = {}) noexcept;

 private:
  void bind(const Endpoint& local);

  struct Asio;
  std::unique_ptr<Asio> asio_;
};

}  // namespace palpate::protocol
