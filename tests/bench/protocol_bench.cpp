// Bytes on the wire and back.
#include <vector>

#include "protocol/auth.h"
#include "protocol/codec.h"
#include "protocol/replay_window.h"
#include "tests/bench/bench.h"
#include "tests/bench/palpation.h"

namespace palpate::bench {
using namespace protocol;

namespace {

constexpr std::size_t kMessages = 64;

/// A few messages, each another.
template <class M>
std::vector<Message> messages_of() {
  std::vector<Message> messages;
  for (Palpation hand; messages.size() < kMessages;) {
    hand.next();
    if constexpr (std::is_same_v<M, ToolState>) {
      messages.emplace_back(hand.tool());
    } else if (hand.arrived() != nullptr) {
      messages.emplace_back(*hand.arrived());
    }
  }
  return messages;
}

struct Encoded {
  std::array<std::byte, kMaxDatagram> bytes;
  std::size_t size = 0;
  std::span<const std::byte> used() const { return {bytes.data(), size}; }
};

std::vector<Encoded> encoded(const std::vector<Message>& messages, Fnv1a& hash) {
  std::vector<Encoded> all(messages.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].size = encode({7, i + 1}, messages[i], all[i].bytes);
    hash.add(all[i].bytes.data(), all[i].size);
  }
  return all;
}

template <class M>
void run_encode(benchmark::State& state) {
  const std::vector<Message> messages = messages_of<M>();
  Fnv1a hash;
  encoded(messages, hash);
  show(state, hash.value());
  Encoded out;
  std::uint64_t sequence = 0;
  for (auto _ : state) {
    ++sequence;
    out.size = encode({7, sequence}, messages[sequence % kMessages], out.bytes);
    benchmark::DoNotOptimize(out.bytes.data());
    benchmark::ClobberMemory();
  }
}

/// The label is the hash of what was decoded, encoded again.
template <class M>
void run_decode(benchmark::State& state) {
  Fnv1a sent, received;
  const std::vector<Encoded> datagrams = encoded(messages_of<M>(), sent);
  Datagram datagram;
  Encoded again;
  for (const Encoded& in : datagrams) {
    if (decode(in.used(), datagram) != Verdict::kAccepted)
      return state.SkipWithError("a datagram was refused");
    again.size = encode(datagram.header, datagram.message, again.bytes);
    received.add(again.bytes.data(), again.size);
  }
  show(state, received.value());
  std::size_t i = 0;
  for (auto _ : state) {
    Verdict verdict = decode(datagrams[i++ % kMessages].used(), datagram);
    benchmark::DoNotOptimize(verdict);
    benchmark::DoNotOptimize(datagram);
  }
}

/// A sample with two tangents, all the way with a key: encoded, sealed, found authentic, decoded.
void run_sealed(benchmark::State& state) {
  ForceSample sample{.number = 1};
  sample.flags = ForceSample::kHasTangent | ForceSample::kHasAhead;
  const Key key = direction_key({.number = 1}, Direction::kToClient, Nonce{1}, Nonce{2});
  Encoded out;
  Datagram datagram;
  std::uint64_t sequence = 0;
  for (auto _ : state) {
    ++sequence;
    out.size = seal(out.bytes, encode({7, sequence}, sample, out.bytes), key);
    const bool good = authentic(out.used(), key) && decode(out.used(), datagram) == Verdict::kAccepted;
    if (!good) return state.SkipWithError("a datagram was refused");
    benchmark::DoNotOptimize(datagram);
  }
}

/// In order, but for two of 16 that change places and one that comes twice.
void run_window(benchmark::State& state) {
  static constexpr std::array<std::uint64_t, 16> kOrder{1, 2,  3,  4,  5,  6,  8,  7,
                                                        9, 10, 11, 11, 13, 14, 15, 16};
  ReplayWindow window(100);
  LinkStats stats;
  std::uint64_t i = 0;
  time_calls(state, 4096, [&] {
    const std::uint64_t sequence = i / kOrder.size() * kOrder.size() + kOrder[i % kOrder.size()];
    ++i;
    benchmark::DoNotOptimize(stats);  // or nobody would count
    return window.accept(sequence, stats);
  });
}

}  // namespace

void add_protocol_rows() {
  add("encode/tool_state", run_encode<ToolState>);
  add("encode/force_sample", run_encode<ForceSample>);
  add("decode/tool_state", run_decode<ToolState>);
  add("decode/force_sample", run_decode<ForceSample>);
  add("encode_seal_open_decode/two_tangents", run_sealed);
  add("replay_window", run_window);
}

}  // namespace palpate::bench
