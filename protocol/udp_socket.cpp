#include "protocol/udp_socket.h"

#include <algorithm>
#include <asio.hpp>
#include <charconv>
#include <poll.h>

#include "common/error.h"
#include "protocol/udp_ancillary.h"

namespace palpate::protocol {
namespace {

using asio::ip::udp;

udp::endpoint to_asio(const Endpoint& endpoint) {
  if (endpoint.v6) return {asio::ip::address_v6(endpoint.address, endpoint.scope), endpoint.port};
  asio::ip::address_v4::bytes_type bytes{};
  std::copy_n(endpoint.address.begin(), bytes.size(), bytes.begin());
  return {asio::ip::address_v4(bytes), endpoint.port};
}

Endpoint from_asio(const udp::endpoint& endpoint) {
  Endpoint result{.port = endpoint.port(), .v6 = endpoint.address().is_v6()};
  if (result.v6) {
    result.address = endpoint.address().to_v6().to_bytes();
    result.scope = static_cast<std::uint32_t>(endpoint.address().to_v6().scope_id());
  } else {
    const auto bytes = endpoint.address().to_v4().to_bytes();
    std::ranges::copy(bytes, result.address.begin());
  }
  return result;
}

/// Asks routers for expedited forwarding (RFC 3246): forces are few, and worth nothing when late. Not all
/// grant it.
void expedite(udp::socket& socket, bool v6) {
  constexpr int kExpedited = 46 << 2;  // DSCP 46, expedited forwarding (RFC 3246)
  std::error_code ignored;
  if (v6) {
    socket.set_option(asio::detail::socket_option::integer<IPPROTO_IPV6, IPV6_TCLASS>(kExpedited), ignored);
  } else {
    socket.set_option(asio::detail::socket_option::integer<IPPROTO_IP, IP_TOS>(kExpedited), ignored);
  }
}

}  // namespace

Endpoint resolve(const std::string& text, const std::string& where) {
  const std::size_t colon = text.rfind(':');
  std::string host = text.substr(0, colon);
  int port = -1;
  if (colon != std::string::npos) {
    const char *first = text.data() + colon + 1, *last = text.data() + text.size();
    const auto [end, error] = std::from_chars(first, last, port);
    if (error != std::errc{} || end != last || port > 65535) port = -1;
  }
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  if (port < 0 || host.empty()) {
    fail("{}: \"{}\" is no address; expected HOST:PORT such as 127.0.0.1:45130 or [::1]:45130", where, text);
  }
  asio::io_context context;
  std::error_code failed;
  const auto found = udp::resolver(context).resolve(host, "", failed);
  if (failed || found.empty())
    fail("{}: \"{}\": host \"{}\" is not known ({})", where, text, host, failed.message());
  const auto v4 = std::ranges::find_if(found, [](const auto& e) { return e.endpoint().address().is_v4(); });
  Endpoint endpoint = from_asio(v4 != found.end() ? v4->endpoint() : found.begin()->endpoint());
  endpoint.port = static_cast<std::uint16_t>(port);
  if (to_asio(endpoint).address().is_v6() && to_asio(endpoint).address().to_v6().is_link_local() &&
      endpoint.scope == 0) {
    fail(
        "{}: \"{}\": an fe80 address exists once on each network interface; say on which, such as "
        "[{}%eth0]:{} (`ip "
        "link` lists them)",
        where, text, host, port);
  }
  return endpoint;
}

std::string to_string(const Endpoint& endpoint) {
  const std::string host = to_asio(endpoint).address().to_string();
  return endpoint.v6 ? fmt::format("[{}]:{}", host, endpoint.port)
                     : fmt::format("{}:{}", host, endpoint.port);
}

struct UdpSocket::Asio {
  explicit Asio(std::shared_ptr<asio::io_context> loop) : shared(std::move(loop)) {}

  std::shared_ptr<asio::io_context> shared;  // by sockets that one thread serves
  asio::io_context& context = *shared;
  udp::socket socket{context};
  asio::steady_timer timer{context};
  asio::posix::stream_descriptor bell{context};
  std::array<std::byte, 2048> buffer{};
  Doorbell* doorbell = nullptr;
  Time period{};
  const Handlers* handlers = nullptr;
  Handlers own_handlers;    // of a socket that another one's loop serves
  bool everywhere = false;  // bound to all addresses
  Endpoint requested;
  Time arrived{};

  void receive() {
    socket.async_wait(udp::socket::wait_read, [this](std::error_code failed) {
      if (failed == asio::error::operation_aborted) return;
      // Take all that waits, so that the newest is what the mailboxes hold when this returns.
      for (int i = 0; i < 256; ++i) {
        std::error_code error;
        const auto datagram = protocol::receive(socket.native_handle(), buffer, error);
        if (error == std::errc::operation_would_block) break;
        if (!datagram) continue;  // an earlier one could not be delivered
        arrived = datagram->at;
        requested = everywhere ? datagram->to : Endpoint{};
        handlers->on_datagram({buffer.data(), datagram->size}, datagram->from);
      }
      receive();
    });
  }
  void listen_to_bell() {
    bell.async_wait(asio::posix::stream_descriptor::wait_read, [this](std::error_code failed) {
      if (failed) return;
      doorbell->answer();
      handlers->on_doorbell();
      listen_to_bell();
    });
  }
  void tick() {
    timer.expires_after(period);
    timer.async_wait([this](std::error_code failed) {
      if (failed) return;
      handlers->on_timer();
      tick();
    });
  }
};

UdpSocket::UdpSocket(const Endpoint& local)
    : asio_(std::make_unique<Asio>(std::make_shared<asio::io_context>())) {
  bind(local);
}

UdpSocket::UdpSocket(const Endpoint& local, UdpSocket& other,
                     std::function<void(std::span<const std::byte>, const Endpoint&)> on_datagram)
    : asio_(std::make_unique<Asio>(other.asio_->shared)) {
  bind(local);
  asio_->own_handlers.on_datagram = std::move(on_datagram);
  asio_->handlers = &asio_->own_handlers;
  asio_->receive();
}

void UdpSocket::bind(const Endpoint& local) {
  const udp::endpoint address = to_asio(local);
  std::error_code failed;
  asio_->socket.open(address.protocol(), failed);
  if (!failed) asio_->socket.bind(address, failed);
  if (failed == asio::error::address_in_use) {
    fail_at_run_time(
        "UDP address {} is in use; stop the other program or choose another with --listen ADDR:PORT",
        to_string(local));
  }
  if (failed) fail_at_run_time("cannot use UDP address {} ({})", to_string(local), failed.message());
  asio_->socket.non_blocking(true);
  expedite(asio_->socket, local.v6);
  request_ancillary(asio_->socket.native_handle(), local.v6);
  asio_->everywhere = local.address == Endpoint{}.address;
}

UdpSocket::~UdpSocket() = default;

Endpoint UdpSocket::local() const {
  return from_asio(asio_->socket.local_endpoint());
}

Endpoint UdpSocket::local_towards(const Endpoint& peer) const {
  Endpoint own = local();
  if (own.address != Endpoint{}.address) return own;
  udp::socket probe(asio_->context);
  std::error_code failed;
  probe.connect(to_asio(peer), failed);
  const udp::endpoint towards = probe.local_endpoint(failed);
  if (!failed) own.address = from_asio(towards).address;
  return own;
}

UdpSocket::Answer UdpSocket::answer_of(const Endpoint& peer, std::span<const std::byte> request,
                                       Time patience) {
  asio::io_context context;
  udp::socket probe(context);
  std::error_code failed;
  probe.connect(to_asio(peer), failed);
  if (failed) return {failed};
  probe.send(asio::buffer(request.data(), request.size()), 0, failed);
  pollfd answer{probe.native_handle(), POLLIN, 0};
  poll(&answer, 1, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(patience).count()));
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(probe.native_handle(), SOL_SOCKET, SO_ERROR, &error, &size);
  Answer got{{error, std::generic_category()}};
  if (error != 0 || answer.revents == 0) return got;
  got.bytes.resize(kMaxDatagram);
  const auto received = recv(probe.native_handle(), got.bytes.data(), got.bytes.size(), MSG_DONTWAIT);
  got.bytes.resize(received > 0 ? static_cast<std::size_t>(received) : 0);
  return got;
}

void UdpSocket::run(Doorbell& doorbell, Time timer_period, const Handlers& handlers) {
  asio_->doorbell = &doorbell;
  asio_->period = timer_period;
  asio_->handlers = &handlers;
  asio_->bell.assign(doorbell.descriptor());
  asio_->receive();
  asio_->listen_to_bell();
  asio_->tick();
  asio_->context.run();
  asio_->bell.release();  // the descriptor is the doorbell's to close
}

void UdpSocket::stop() {
  asio_->context.stop();
}

std::error_code UdpSocket::send(std::span<const std::byte> datagram, const Endpoint& to,
                                const Endpoint& from) noexcept {
  const int socket = asio_->socket.native_handle();
  const std::error_code failed = protocol::send(socket, datagram, to, from);
  return failed && from.port != 0 ? protocol::send(socket, datagram, to, {}) : failed;
}

const Endpoint& UdpSocket::requested() const noexcept {
  return asio_->requested;
}

Time UdpSocket::arrived() const noexcept {
  return asio_->arrived;
}

}  // namespace palpate::protocol
