#pragma once
/// Client and server of one tool over a bad network, in virtual time.
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include "haptic_client/device/device.h"
#include "haptic_client/pipeline/pipeline.h"
#include "protocol/codec.h"
#include "protocol/link_simulator.h"
#include "protocol/session.h"
#include "protocol/token_bucket.h"

namespace palpate::test {

/// What the server's end asks of whatever computes forces. `session` tells one client from the next.
struct Served {
  std::function<std::optional<protocol::ForceSample>(std::uint64_t session, const protocol::ToolState&)> step;
  /// Each tool state that is newer than those before, as it comes.
  std::function<void(std::uint64_t session, const protocol::ToolState&)> heard = {};
  /// One page of the surface; false: there is none of that number.
  std::function<bool(std::uint32_t number, protocol::SurfacePage&)> page = {};
  std::uint32_t surface_version = 0;  ///< of the pages
};

/// The machines of both sessions with the whole tick of the client, as the two programs join them (`NetLink`,
/// `HapticLoop`, `SimLoop`), without socket, clock and thread. All that is said goes as bytes through a
/// simulated link each way. The two ends have clocks of their own.
class LinkedPair {
 public:
  struct Settings {
    double haptic_hz = 1000, sim_hz = 30;
    protocol::LinkConditions up{}, down{};  ///< client to server, server to client
    std::uint64_t seed = 1;
    double faults_end = 1e9;  ///< s: what is sent from then on takes only the delay, without jitter
    protocol::Key key{};      ///< of both ends
  };

  LinkedPair(client::Device& device, client::Pipeline& pipeline, Served served, const Settings& settings)
      : device_(device),
        pipeline_(pipeline),
        served_(std::move(served)),
        settings_(settings),
        random_(settings.seed),
        up_(settings.up, settings.seed),
        down_(settings.down, settings.seed + 1000),
        good_up_({.delay = settings.up.delay}, 1),
        good_down_({.delay = settings.down.delay}, 1),
        client_(drawn<protocol::Nonce>(), settings.key),
        server_(begun_server()) {}

  /// One tick of the client, and what the server does meanwhile.
  client::TickResult tick() {
    const client::DeviceReading reading = device_.read(client_time());
    receive_at_client();
    const client::TickResult result = pipeline_.tick(reading, arrived_ ? &*arrived_ : nullptr, pages_);
    arrived_.reset();
    pages_.clear();
    device_.write(result.f_D);
    if (ticks_ % kTimer == kTimer / 2) greet();
    if (client_.welcomed()) {
      protocol::ToolState state = result.tool;
      state.tool = client_.welcome().tool;
      say(state);
      if (!first_welcome_) first_welcome_ = seconds();
    }
    serve();
    return result;
  }
  /// The client's program stands still for `asleep` s; what comes meanwhile waits. Its clock goes on, or, as
  /// that of Linux does while a machine sleeps, stands still as well.
  void suspend(double asleep, bool clock_goes_on) {
    for (const double end = seconds() + asleep; seconds() < end;) serve();
    if (!clock_goes_on) client_clock_ -= asleep;
  }
  /// The server's program ends without a Bye and begins anew, with other secrets.
  void restart_server() {
    server_ = begun_server();
    newest_.reset();
  }

  /// Delivers a datagram in the name of the server, as one who knows the session and its keys can make it.
  void forge_to_client(const protocol::Header& header, const protocol::Message& message) {
    const protocol::ServerSessions::Member* const member = server_.holder(0);
    if (member == nullptr) return;
    const bool greets = std::holds_alternative<protocol::Welcome>(message);
    const protocol::Key of_hello =
        protocol::direction_key(settings_.key, protocol::Direction::kToClient, hello_.nonce, {});
    std::array<std::byte, protocol::kMaxDatagram> out;
    const std::size_t size = protocol::encode(header, message, out);
    take_at_client({out.data(), protocol::seal(out, size, greets ? of_hello : member->keys.out)});
  }
  /// Gives the server a datagram as the client of tool 0 would send it: with its key, of any number.
  void forge_to_server(const protocol::Header& header, const protocol::Message& message) {
    const protocol::ServerSessions::Member* const member = server_.holder(0);
    if (member == nullptr) return;
    std::array<std::byte, protocol::kMaxDatagram> out;
    const std::size_t size = protocol::encode(header, message, out);
    receive_at_server({out.data(), protocol::seal(out, size, member->keys.in)});
  }
  /// Returns session and sequence of the newest datagram of the server; 0: nobody holds the tool.
  protocol::Header newest_of_server() {
    const protocol::ServerSessions::Member* const member = server_.holder(0);
    return member == nullptr ? protocol::Header{} : protocol::Header{member->session, member->sent};
  }
  const protocol::Hello& newest_hello() const { return hello_; }

  double seconds() const { return static_cast<double>(ticks_) / settings_.haptic_hz; }
  const protocol::ClientSession& client() const { return client_; }
  const protocol::LinkStats& client_stats() const { return client_stats_; }
  const protocol::LinkStats& server_stats() const { return server_stats_; }
  const protocol::LinkCounts& down_counts() const { return down_.counts(); }
  /// s, from the beginning to the first Welcome.
  std::optional<double> first_welcome() const { return first_welcome_; }

 private:
  static constexpr std::uint64_t kTimer = 50;  // ticks between two looks at silent sessions, of either end

  Time link_time() const { return from_seconds(1 + seconds()); }
  Time client_time() const { return from_seconds(client_clock_ + seconds()); }
  Time server_time() const { return from_seconds(5000 + seconds()); }
  static protocol::Endpoint address() { return {.address = {127, 0, 0, 1}, .port = 45131, .v6 = false}; }

  template <class T>
  T drawn() {
    T value{};
    for (std::size_t i = 0; i < sizeof(T); ++i)
      reinterpret_cast<unsigned char*>(&value)[i] = static_cast<unsigned char>(random_());
    return value;
  }
  protocol::ServerSessions begun_server() {
    std::vector<protocol::Key> keys;
    if (settings_.key) keys.push_back(settings_.key);
    return {settings_.sim_hz, {0.005}, drawn<protocol::Cookies::Secret>(), keys};
  }

  void receive_at_client() {
    while (const auto bytes = down_.receive(link_time())) take_at_client(*bytes);
    while (const auto bytes = good_down_.receive(link_time())) take_at_client(*bytes);
  }
  void take_at_client(std::span<const std::byte> bytes) {
    protocol::Datagram datagram;
    if (protocol::decode(bytes, datagram) != protocol::Verdict::kAccepted) return;
    const protocol::Message* message = client_.receive(datagram, client_time(), client_stats_);
    if (message != nullptr) {
      if (const auto* sample = std::get_if<protocol::ForceSample>(message)) arrived_ = *sample;
      if (const auto* page = std::get_if<protocol::SurfacePage>(message)) pages_.push_back(*page);
    }
    greet();
  }
  void greet() {
    const auto hello = client_.poll(client_time());
    if (!hello) return;
    hello_ = *hello;
    say(*hello);
  }
  void say(const protocol::Message& message) {
    std::array<std::byte, protocol::kMaxDatagram> bytes;
    (faulty() ? up_ : good_up_).send({bytes.data(), client_.write(message, bytes)}, link_time());
  }
  bool faulty() const { return seconds() < settings_.faults_end; }

  /// The server until the next tick.
  void serve() {
    while (const auto bytes = up_.receive(link_time())) receive_at_server(*bytes);
    while (const auto bytes = good_up_.receive(link_time())) receive_at_server(*bytes);
    if (ticks_ % kTimer == 0) {
      for (const auto& removed : server_.expire(server_time()))
        if (newest_ && newest_->first == removed.session) newest_.reset();
    }
    if (static_cast<double>(steps_) / settings_.sim_hz <= seconds() + 1e-9) {
      ++steps_;
      step();
    }
    ++ticks_;
  }
  void receive_at_server(std::span<const std::byte> bytes) {
    protocol::Datagram datagram;
    if (protocol::decode(bytes, datagram) != protocol::Verdict::kAccepted) return;
    const protocol::ServerSessions::Fresh fresh{drawn<std::uint64_t>() | 1, drawn<protocol::Nonce>()};
    const auto outcome = server_.receive(datagram, address(), server_time(), fresh, server_stats_);
    if (outcome.answer) {
      std::array<std::byte, protocol::kMaxDatagram> out;
      const std::size_t size = protocol::encode(outcome.answer->first, outcome.answer->second, out);
      answer({out.data(), protocol::seal(out, size, outcome.key)});
    }
    if (outcome.asking != nullptr) send_pages(*outcome.asking);
    if (outcome.tool_state == nullptr) return;
    newest_ = {datagram.header.session, *outcome.tool_state};
    if (served_.heard) served_.heard(newest_->first, newest_->second);
    fresh_ = true;
  }
  void send_pages(const protocol::ToolState& state) {
    if (!served_.page || (state.flags & protocol::ToolState::kAsksPages) == 0 ||
        state.surface_version != served_.surface_version)
      return;
    protocol::SurfacePage page;
    for (const std::uint32_t number : state.pages)
      if (served_.page(number, page) && page_bucket_.take(server_time())) answer_member(page);
  }
  void step() {
    if (!newest_ || !std::exchange(fresh_, false)) return;
    if (const auto sample = served_.step(newest_->first, newest_->second)) answer_member(*sample);
  }
  void answer_member(const protocol::Message& message) {
    protocol::ServerSessions::Member* const member = server_.holder(0);
    if (member == nullptr) return;
    std::array<std::byte, protocol::kMaxDatagram> out;
    answer({out.data(), protocol::ServerSessions::write(*member, message, out)});
  }
  void answer(std::span<const std::byte> bytes) { (faulty() ? down_ : good_down_).send(bytes, link_time()); }

  client::Device& device_;
  client::Pipeline& pipeline_;
  Served served_;
  Settings settings_;
  std::mt19937_64 random_;
  protocol::LinkSimulator up_, down_, good_up_, good_down_;
  protocol::ClientSession client_;
  protocol::Hello hello_{};  // the newest
  protocol::ServerSessions server_;
  protocol::TokenBucket page_bucket_{2000, 32};
  protocol::LinkStats client_stats_, server_stats_;
  std::optional<std::pair<std::uint64_t, protocol::ToolState>> newest_;  // session, state
  bool fresh_ = false;
  std::uint64_t ticks_ = 0, steps_ = 0;
  double client_clock_ = 7;  // s, when it began
  std::optional<double> first_welcome_;
  std::optional<protocol::ForceSample> arrived_;
  std::vector<protocol::SurfacePage> pages_;
};

}  // namespace palpate::test
