// Any order of datagrams, time and sealed ones at both ends of a session: nothing breaks, and with a key only
// what the other end sealed reaches the simulation or the haptic loop.
#include "protocol/session.h"

#include <cstdint>
#include <cstdlib>
#include <vector>

using namespace palpate;
using namespace palpate::protocol;

namespace {

const Endpoint kClient{.address = {10, 0, 0, 1}, .port = 1000},
    kStranger{.address = {10, 0, 0, 9}, .port = 9};
const Key kKey{.number = 1, .bytes = {1, 2, 3}};

struct Pair {
  explicit Pair(bool is_keyed)
      : keyed(is_keyed),
        client(Nonce{42}, is_keyed ? kKey : Key{}),
        server(30, {0.005}, {7}, is_keyed ? std::vector<Key>{kKey} : std::vector<Key>{}) {}

  /// `ours`: one of the two ends made it.
  void to_server(std::span<const std::byte> bytes, const Endpoint& from, bool ours) {
    Datagram datagram;
    if (decode(bytes, datagram) != Verdict::kAccepted) return;
    ++fresh;
    const auto outcome = server.receive(datagram, from, now, {fresh, {fresh, 1}}, stats);
    if (keyed && !ours && (outcome.tool_state != nullptr || outcome.departed != nullptr)) std::abort();
    if (!outcome.answer || from != kClient) return;
    std::vector<std::byte> answer(kMaxDatagram);
    answer.resize(seal(answer, encode(outcome.answer->first, outcome.answer->second, answer), outcome.key));
    if (answer.size() > bytes.size() && std::get_if<Welcome>(&outcome.answer->second) == nullptr)
      std::abort();
    to_client(answer, true);
  }
  void to_client(std::span<const std::byte> bytes, bool ours) {
    Datagram datagram;
    if (decode(bytes, datagram) != Verdict::kAccepted) return;
    if (client.receive(datagram, now, stats) != nullptr && keyed && !ours) std::abort();
  }
  void say(const Message& message) {
    std::vector<std::byte> bytes(kMaxDatagram);
    bytes.resize(client.write(message, bytes));
    to_server(bytes, kClient, true);
  }
  void step(std::uint8_t what, std::span<const std::byte> bytes) {
    switch (what % 8) {
      case 0:
        return to_server(bytes, kClient, false);
      case 1:
        return to_server(bytes, kStranger, false);
      case 2:
        return to_client(bytes, false);
      case 3:
        while (const auto hello = client.poll(now)) say(*hello);
        return;
      case 4:
        if (client.welcomed()) say(ToolState{.tick = ++tick});
        return;
      case 5:
        return force();
      case 6:
        now += std::chrono::milliseconds(50);
        return;
      default:
        server.expire(now);
        return;
    }
  }
  void force() {
    auto* const member = server.holder(0);
    if (member == nullptr) return;
    std::vector<std::byte> bytes(kMaxDatagram);
    bytes.resize(ServerSessions::write(*member, ForceSample{.number = ++number}, bytes));
    to_client(bytes, true);
  }

  bool keyed;
  ClientSession client;
  ServerSessions server;
  LinkStats stats;
  Time now = std::chrono::seconds(100);
  std::uint64_t fresh = 0, tick = 0, number = 0;
};

}  // namespace

/// The first byte says whether there is a key; then steps, each a byte that says what, one of how many bytes
/// follow (times five), and these.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Pair pair((data[0] & 1) != 0);
  std::span rest = std::as_bytes(std::span(data, size)).subspan(1);
  while (rest.size() >= 2) {
    const auto what = std::to_integer<std::uint8_t>(rest[0]);
    const std::size_t length =
        std::min<std::size_t>(5 * std::to_integer<std::size_t>(rest[1]), rest.size() - 2);
    pair.step(what, rest.subspan(2, length));
    rest = rest.subspan(2 + length);
  }
  return 0;
}
