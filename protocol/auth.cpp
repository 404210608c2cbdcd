#include "protocol/auth.h"

#include <algorithm>
#include <cstdlib>
#include <sodium.h>

#include "protocol/wire.h"

namespace palpate::protocol {
namespace {

constexpr std::int64_t kCookiePeriod = 10'000'000'000;  // ns

using Label = std::array<char, 24>;
constexpr Label kToServerLabel{"client to server"}, kToClientLabel{"server to client"}, kPageLabel{"page"};

/// Chooses the fastest code for this machine. Without libsodium's random numbers there is nothing to trust.
void begin() noexcept {
  static const bool ready = sodium_init() >= 0;
  if (!ready) std::abort();
}

const unsigned char* bytes_of(const std::byte* p) {
  return reinterpret_cast<const unsigned char*>(p);
}

template <std::size_t N>
std::array<std::uint8_t, N> hashed(std::span<const std::byte> message,
                                   const std::array<std::uint8_t, 32>& key) noexcept {
  begin();
  std::array<std::uint8_t, N> out;
  crypto_generichash(out.data(), N, bytes_of(message.data()), message.size(), key.data(), key.size());
  return out;
}

}  // namespace

Key direction_key(const Key& shared, Direction direction, const Nonce& client, const Nonce& server) noexcept {
  if (!shared) return {};
  std::array<std::byte, 64> message;
  Writer writer(message);
  for (const char c : direction == Direction::kToServer ? kToServerLabel : kToClientLabel)
    writer(static_cast<std::uint8_t>(c));
  writer(kProtocolVersion), writer(client), writer(server);
  return {shared.number, hashed<32>({message.data(), writer.size()}, shared.bytes)};
}

std::size_t seal(std::span<std::byte> out, std::size_t size, const Key& key) noexcept {
  if (!key) return size;
  out[kTagLengthAt] = std::byte{kTagBytes};
  out[kKeyNumberAt] = std::byte{key.number};
  const auto tag = hashed<kTagBytes>(out.first(size), key.bytes);
  std::ranges::copy(std::as_bytes(std::span(tag)), out.begin() + static_cast<std::ptrdiff_t>(size));
  return size + kTagBytes;
}

bool authentic(std::span<const std::byte> datagram, const Key& key) noexcept {
  if (!key) return true;
  if (datagram.size() < kHeaderBytes + kTagBytes || datagram[kTagLengthAt] != std::byte{kTagBytes} ||
      datagram[kKeyNumberAt] != std::byte{key.number})
    return false;
  const auto tag = hashed<kTagBytes>(datagram.first(datagram.size() - kTagBytes), key.bytes);
  return sodium_memcmp(tag.data(), datagram.last(kTagBytes).data(), kTagBytes) == 0;
}

bool is_tagged(std::span<const std::byte> datagram) noexcept {
  return datagram.size() > kTagLengthAt && datagram[kTagLengthAt] != std::byte{0};
}

std::array<std::uint8_t, 16> page_token(const Key& key) noexcept {
  return hashed<16>(std::as_bytes(std::span(kPageLabel)), key.bytes);
}

bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept {
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

Cookie Cookies::in_period(std::int64_t period, const Nonce& client, const Endpoint& from) const noexcept {
  std::array<std::byte, 64> message;
  Writer writer(message);
  writer(period), writer(renewals_), writer(from.address), writer(from.port),
      writer(static_cast<std::uint8_t>(from.v6));
  writer(client);
  const auto hash = hashed<16>({message.data(), writer.size()}, secret_);
  Cookie cookie;
  Reader reader(std::as_bytes(std::span(hash)));
  reader(cookie);
  return cookie;
}

Cookie Cookies::make(const Nonce& client, const Endpoint& from, Time now) const noexcept {
  return in_period(now.count() / kCookiePeriod, client, from);
}

bool Cookies::valid(const Cookie& cookie, const Nonce& client, const Endpoint& from,
                    Time now) const noexcept {
  const std::int64_t period = now.count() / kCookiePeriod;
  const auto is_of = [&](std::int64_t p) {
    const Cookie ours = in_period(p, client, from);
    return sodium_memcmp(ours.data(), cookie.data(), sizeof ours) == 0;
  };
  return is_of(period) || is_of(period - 1);
}

void fill_randomly(std::span<std::byte> out) noexcept {
  begin();
  randombytes_buf(out.data(), out.size());
}

}  // namespace palpate::protocol
