#pragma once
/// Who may speak: keys, the tags of datagrams, cookies; all by libsodium (keyed BLAKE2b). The bytes:
/// protocol/README.md, "Keys".
#include <span>
#include <string_view>

#include "common/time.h"
#include "protocol/codec.h"
#include "protocol/endpoint.h"

namespace palpate::protocol {

/// 32 secret bytes, and the number they go by. Number 0: there is no key, and nothing is authenticated.
struct Key {
  std::uint8_t number = 0;
  std::array<std::uint8_t, 32> bytes{};
  explicit operator bool() const noexcept { return number != 0; }
};

enum class Direction : std::uint8_t { kToServer, kToClient };

/// The key of one direction of a session, derived from the shared key and the nonces of both ends; of its
/// handshake where `server` is zero. No key of no key. A microsecond; no allocation.
Key direction_key(const Key& shared, Direction direction, const Nonce& client, const Nonce& server) noexcept;

/// Puts a tag behind the datagram in the first `size` bytes of `out`, which has room for it, and returns the
/// size with it. Without a key: nothing, and `size`. A microsecond a kilobyte; no allocation.
std::size_t seal(std::span<std::byte> out, std::size_t size, const Key& key) noexcept;

/// True if the tag of a datagram that `decode_fields` accepted is that of `key`, compared in constant time;
/// without a key always true.
bool authentic(std::span<const std::byte> datagram, const Key& key) noexcept;
/// True if a datagram says that it has a tag, of whatever key.
bool is_tagged(std::span<const std::byte> datagram) noexcept;

/// Returns the token that ends the address of a live page, derived from a key. Only its owner may do more
/// than watch. The server passes the key of one run (`direction_key` with a random nonce).
std::array<std::uint8_t, 16> page_token(const Key& key) noexcept;

/// True if two texts are equal; the time does not depend on where they differ.
bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept;

/// Cookies that a server hands out, so that only who receives at an address can say Hello from it, and the
/// server need not remember whom it gave one (as DTLS does: RFC 6347, section 4.2.1). A cookie of one key of
/// 10 s is good in that and in the next.
class Cookies {
 public:
  using Secret = std::array<std::uint8_t, 32>;
  explicit Cookies(const Secret& secret) : secret_(secret) {}

  Cookie make(const Nonce& client, const Endpoint& from, Time now) const noexcept;
  /// Makes all cookies so far worthless.
  void renew() noexcept { ++renewals_; }
  bool valid(const Cookie& cookie, const Nonce& client, const Endpoint& from, Time now) const noexcept;

 private:
  Cookie in_period(std::int64_t period, const Nonce& client, const Endpoint& from) const noexcept;

  Secret secret_;
  std::uint64_t renewals_ = 0;  // which the cookies are of
};

/// Bytes that nobody can predict, from the operating system.
void fill_randomly(std::span<std::byte> out) noexcept;

template <class T>
T random_value() noexcept {
  T value{};
  fill_randomly(std::as_writable_bytes(std::span(&value, 1)));
  return value;
}

}  // namespace palpate::protocol
