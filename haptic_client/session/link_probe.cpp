#include "haptic_client/session/link_probe.h"

#include <algorithm>
#include <cmath>

#include "common/clock.h"
#include "common/realtime.h"

namespace palpate::client {
using protocol::Direction;

namespace {
constexpr Time kInTransit = std::chrono::seconds(1);  // a Hello that is younger at the end is not lost
}  // namespace

LinkProbe::LinkProbe(const protocol::Endpoint& server, const protocol::Key& key)
    : server_(server),
      socket_(protocol::Endpoint{.v6 = server.v6}),
      nonce_(protocol::random_value<protocol::Nonce>()),
      up_(direction_key(key, Direction::kToServer, nonce_, {})),
      down_(direction_key(key, Direction::kToClient, nonce_, {})) {}

void LinkProbe::start() {
  thread_ = std::jthread([this] {
    take_role(ThreadRole::kNetwork, "palpate-probe");
    Doorbell bell;
    socket_.run(bell, kBetweenHellos,
                {.on_datagram = [this](auto bytes, const auto& from) { take(bytes, from); },
                 .on_doorbell = [] {},
                 .on_timer = [this] { say_hello(); }});
  });
}

void LinkProbe::stop() {
  if (!thread_.joinable()) return;
  socket_.stop();
  thread_.join();
  // What the table still holds is lost, unless it is young.
  const Time old = now() - kInTransit;
  for (const Time said : said_) figures_.lost += said > Time{} && said < old ? 1 : 0;
}

void LinkProbe::say_hello() {
  const std::uint64_t attempt = figures_.sent + 1;
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  const std::size_t size = protocol::seal(
      bytes, protocol::encode({}, protocol::Hello{.nonce = nonce_, .attempt = attempt}, bytes), up_);
  if (const auto failed = socket_.send({bytes.data(), size}, server_)) {
    figures_.unsendable = failed.value();
    return;
  }
  ++figures_.sent;
  figures_.bytes_up += size;
  Time& said = said_[attempt % kStored];
  if (said > Time{}) ++figures_.lost;  // that of 13 s ago
  said = now();
}

void LinkProbe::take(std::span<const std::byte> bytes, const protocol::Endpoint& from) {
  const Time t = socket_.arrived();
  protocol::Datagram datagram;
  if (from != server_ || protocol::decode(bytes, datagram) != protocol::Verdict::kAccepted) return;
  const auto* challenge = std::get_if<protocol::Challenge>(&datagram.message);
  if (challenge == nullptr || challenge->nonce != nonce_ || !authentic(bytes, down_)) return;
  if (challenge->attempt > figures_.sent || figures_.sent - challenge->attempt >= kStored) return;
  Time& said = said_[challenge->attempt % kStored];
  if (said == Time{}) return;  // doubled
  const auto took = static_cast<double>((t - said).count());
  said = Time{};
  figures_.reordered += challenge->attempt < newest_answered_ ? 1 : 0;
  newest_answered_ = std::max(newest_answered_, challenge->attempt);
  if (figures_.round_trip_ns.count() > 0)
    figures_.jitter_ns += (std::abs(took - before_ns_) - figures_.jitter_ns) / 16;
  before_ns_ = took;
  figures_.round_trip_ns.add(static_cast<std::int64_t>(took));
}

}  // namespace palpate::client
