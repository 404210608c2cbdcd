#include "protocol/earlier_ticks.h"

#include <random>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;

namespace {

constexpr Header kEarlierHeader{.session = 77, .sequence = 5};

/// A hand that presses at 500 Hz, with the filtered velocity of a client, and ticks some us late.
std::vector<ToolState> pressing_hand(std::size_t count) {
  std::mt19937 random(3);
  std::vector<ToolState> ticks(count);
  for (std::size_t i = 0; i < count; ++i) {
    ToolState& s = ticks[i];
    s = {.tick = 1000 + i, .newest_sample = 60 + i / 16};
    s.flags = ToolState::kRequestsTangent | ToolState::kRequestsSurface | ToolState::kRequestsErrors;
    s.pages_taken = i / 3;
    s.t_ns = 1'500'000'000 + static_cast<std::int64_t>(2'000'000 * i + random() % 20'000);
    const double t = 1e-9 * static_cast<double>(s.t_ns);
    s.p_W = {0.0125 + 0.01 * std::sin(5 * t), 0.0625 * std::cos(3 * t), -0.03125 + 0.004 * std::sin(9 * t)};
    if (i == 0) continue;
    const double dt = 1e-9 * static_cast<double>(s.t_ns - ticks[i - 1].t_ns);
    s.v_W = ticks[i - 1].v_W + dt / (dt + 0.005) * ((s.p_W - ticks[i - 1].p_W) / dt - ticks[i - 1].v_W);
  }
  return ticks;
}

std::vector<std::byte> bytes_of(const ToolState& state) {
  std::vector<std::byte> bytes(kMaxDatagram);
  bytes.resize(encode(kEarlierHeader, state, bytes));
  return bytes;
}

/// The ticks after a journey; empty: refused.
std::vector<ToolState> sent_and_read(std::span<const ToolState> ticks) {
  std::array<std::byte, kMaxDatagram> bytes{};
  const std::size_t size = encode_ticks(kEarlierHeader, ticks, bytes);
  Datagram datagram;
  if (decode({bytes.data(), size}, datagram) != Verdict::kAccepted) return {};
  return ticks_of(datagram);
}

void check_equal_bits(std::span<const ToolState> sent, std::span<const ToolState> read) {
  REQUIRE(read.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) CHECK(bytes_of(read[i]) == bytes_of(sent[i]));
}

}  // namespace

TEST_CASE("earlier ticks: each tick of a hand comes out bit by bit, in a third of its bytes") {
  const std::vector<ToolState> all = pressing_hand(800);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < all.size(); i += 8) {
    const std::span<const ToolState> ticks(&all[i], 8);
    check_equal_bits(ticks, sent_and_read(ticks));
    std::array<std::byte, kMaxDatagram> out{};
    bytes += encode_ticks(kEarlierHeader, ticks, out);
  }
  // 28 bytes of IPv4 and UDP for each datagram; 500 ticks a second, 62.5 datagrams.
  const double kbit_s = 8e-3 * 500 * (static_cast<double>(bytes) + 28.0 * 100) / 800;
  CAPTURE(kbit_s);
  CHECK(kbit_s < 220);
}

TEST_CASE("earlier ticks: whatever the fields hold comes out bit by bit") {
  std::mt19937_64 random(11);
  const auto any = [&] { return std::uniform_real_distribution<double>(-1e9, 1e9)(random); };
  for (int round = 0; round < 200; ++round) {
    std::vector<ToolState> ticks(4);
    for (ToolState& s : ticks) {
      s = {.tool = 3, .tick = random() | 1, .newest_sample = random()};
      s.t_ns = static_cast<std::int64_t>(random() >> 3) - (std::int64_t{1} << 60);
      s.p_W = {any(), -0.0, 1e-310};
      s.v_W = {0.0, any(), -any()};
      if (random() % 2 == 0) s.q_W = {0, 0.6, 0, -0.8};
      s.buttons = static_cast<std::uint16_t>(random());
      s.flags = static_cast<std::uint16_t>(random()) & ~ToolState::kHasEarlierTicks;
      if ((s.flags & ToolState::kRequestsAhead) != 0) s.lead_ns = static_cast<std::int64_t>(random() >> 32);
      if ((s.flags & ToolState::kRequestsSurface) != 0) s.pages_taken = random();
      if ((s.flags & ToolState::kAsksPages) == 0) continue;
      s.surface_version = static_cast<std::uint32_t>(random());
      for (std::uint32_t& page : s.pages) page = static_cast<std::uint32_t>(random());
      s.pages.back() = ToolState::kNoPage;
    }
    check_equal_bits(ticks, sent_and_read(ticks));
  }
  std::vector<ToolState> at_rest(3);
  for (std::size_t i = 0; i < at_rest.size(); ++i) at_rest[i].tick = i + 1;
  at_rest[1].p_W[1] = at_rest[0].v_W[2] = at_rest[1].q_W[3] = -0.0;
  check_equal_bits(at_rest, sent_and_read(at_rest));
}

TEST_CASE("earlier ticks: ticks that do not fit are not sent, and none goes beyond the longest datagram") {
  std::array<std::byte, kMaxDatagram> out{};
  const std::vector<ToolState> all = pressing_hand(kMostEarlierTicks + 1);
  CHECK(encode_ticks(kEarlierHeader, all, out) == 0);
  const std::size_t size = encode_ticks(kEarlierHeader, std::span(all).first(30), out);
  CHECK(size > 0);
  CHECK(size <= kMaxDatagram - kTagBytes);
}

TEST_CASE("earlier ticks: a reader of before takes the newest tick, and damaged ticks are refused") {
  const std::vector<ToolState> ticks = pressing_hand(6);
  std::array<std::byte, kMaxDatagram> bytes{};
  const std::size_t size = encode_ticks(kEarlierHeader, ticks, bytes);
  Datagram datagram;
  REQUIRE(decode({bytes.data(), size}, datagram) == Verdict::kAccepted);
  CHECK(std::get<ToolState>(datagram.message).tick == ticks.back().tick);
  const std::size_t newest = bytes_of(ticks.back()).size();
  bytes[newest] = std::byte{kMostEarlierTicks + 1};
  CHECK(decode({bytes.data(), size}, datagram) == Verdict::kValue);
  bytes[newest] = std::byte{6};  // one more than there are
  CHECK(decode({bytes.data(), size}, datagram) == Verdict::kValue);
}
