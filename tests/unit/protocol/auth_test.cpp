#include "protocol/auth.h"

#include <numeric>
#include <set>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/hex.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

/// Bytes 0, 1, 2 ...
Key counted_key(std::uint8_t number = 3) {
  Key key{.number = number};
  std::iota(key.bytes.begin(), key.bytes.end(), std::uint8_t{0});
  return key;
}
constexpr Nonce kClientNonce{0x1716151413121110, 0x1f1e1d1c1b1a1918},
    kServerNonce{0x2726252423222120, 0x2f2e2d2c2b2a2928};

std::string hex_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t b : bytes) text += fmt::format("{:02x}", b);
  return text;
}

struct Sealed {
  std::array<std::byte, kMaxDatagram> bytes{};
  std::size_t size = 0;
  std::span<std::byte> used() { return {bytes.data(), size}; }
};

Sealed sealed(const Message& message, const Key& key, const Header& header = {0x1122334455667788, 7}) {
  Sealed out;
  out.size = seal(out.bytes, encode(header, message, out.bytes), key);
  return out;
}

}  // namespace

// By Python: hashlib.blake2b(b"client to server".ljust(24, b"\0") + bytes([2]) + client + server,
//                            key=bytes(range(32)), digest_size=32).hexdigest(), and so on.
TEST_CASE("keys of a session and tags are BLAKE2b, as Python's hashlib computes it") {
  CHECK(hex_of(direction_key(counted_key(), Direction::kToServer, kClientNonce, {}).bytes) ==
        "eb9ad416ec2474997b8630a8b5591a9d7bc25d7347c4f9ff716070c64ebdcd0f");
  CHECK(hex_of(direction_key(counted_key(), Direction::kToServer, kClientNonce, kServerNonce).bytes) ==
        "c7dbbc274b4b76ab602f3c7bc79a229dd7202ec49c475c726ded4821919a6729");
  CHECK(hex_of(direction_key(counted_key(), Direction::kToClient, kClientNonce, {}).bytes) ==
        "f27187468628d4896da040eaae118e472f8355bae566de937b87484a579fcbb6");
  CHECK(hex_of(direction_key(counted_key(), Direction::kToClient, kClientNonce, kServerNonce).bytes) ==
        "d4e1d837976025ea26b63284609c2b270b44ec148efc1f14db36b12538452109");
  Sealed bye = sealed(Bye{}, direction_key(counted_key(), Direction::kToServer, kClientNonce, kServerNonce));
  CHECK(bye.size == 28 + 16);
  CHECK(bye.bytes[8] == std::byte{16});
  CHECK(bye.bytes[9] == std::byte{3});
  CHECK(hex_of({reinterpret_cast<const std::uint8_t*>(bye.bytes.data()) + 28, 16}) ==
        "c0df51d74bfb448015e8b1d5325b3649");
}

TEST_CASE("every bit of a sealed datagram counts, and so do its length and its key") {
  const Key key = counted_key();
  Sealed sample = sealed(ForceSample{.number = 9, .f_W = {1, 2, 3}}, key);
  REQUIRE(authentic(sample.used(), key));
  for (std::size_t bit = 0; bit < 8 * sample.size; ++bit) {
    std::byte& byte = sample.bytes[bit / 8];
    byte ^= std::byte{1} << (bit % 8);
    REQUIRE_FALSE(authentic(sample.used(), key));
    byte ^= std::byte{1} << (bit % 8);
  }
  for (std::size_t size = 0; size < sample.size; ++size)
    REQUIRE_FALSE(authentic({sample.bytes.data(), size}, key));
  Key other = key;
  other.bytes[31] ^= 1;
  CHECK_FALSE(authentic(sample.used(), other));
  CHECK_FALSE(authentic(sample.used(), counted_key(4)));
  CHECK_FALSE(authentic(sealed(Bye{}, {}).used(), key));
}

TEST_CASE("without a key nothing is added, and everything passes") {
  Sealed plain = sealed(Bye{}, {});
  CHECK(plain.size == 28);
  CHECK(authentic(plain.used(), {}));
  CHECK_FALSE(direction_key({}, Direction::kToServer, kClientNonce, kServerNonce));
}

TEST_CASE("the longest sample and a page have room for a tag, and a sealed one decodes to the same") {
  ForceSample longest;
  longest.flags = 0x3fc;
  longest.relaxed.terms = 1;
  longest.relaxed.fraction[0] = 0.5F;
  longest.relaxed.time[0] = 1;
  longest.number = 1;
  longest.surface.tool_radius = 0.005;
  longest.modes.count = kMaxPublishedModes;
  ForceSample driven = longest;
  driven.flags = (longest.flags & ~ForceSample::kHasRelaxed) | ForceSample::kHasModalLoads;
  driven.modal_loads.count = ModalLoads::room(kMaxPublishedModes);
  ForceSample all_driven = driven;
  all_driven.modes.count = all_driven.modal_loads.count = 53;
  CHECK(ModalLoads::room(53) == 53);
  for (const Message& message :
       {Message{longest}, Message{driven}, Message{all_driven}, Message{SurfacePage{}}, Message{Hello{}}}) {
    Sealed bytes = sealed(message, counted_key());
    CHECK(bytes.size <= kMaxDatagram);
    Datagram datagram;
    REQUIRE(decode(bytes.used(), datagram) == Verdict::kAccepted);
    CHECK(datagram.header.key == 3);
    CHECK(datagram.bytes.data() == bytes.bytes.data());
    CHECK(authentic(datagram.bytes, counted_key()));
  }
}

TEST_CASE("a cookie is of one address, port and nonce, and for 10 to 20 s") {
  const Cookies cookies({1, 2, 3}), others({1, 2, 4});
  const Endpoint at_tool{.address = {10, 0, 0, 1}, .port = 1000};
  const Nonce nonce{42};
  for (const Time now : {Time{0s}, Time{9999ms}, Time{123456789s}}) {
    const Cookie cookie = cookies.make(nonce, at_tool, now);
    CHECK(cookies.valid(cookie, nonce, at_tool, now));
    CHECK(cookies.valid(cookie, nonce, at_tool, now + 10s));
    CHECK_FALSE(cookies.valid(cookie, nonce, at_tool, now + 20s));
    CHECK_FALSE(cookies.valid(cookie, Nonce{43}, at_tool, now));
    CHECK_FALSE(cookies.valid(cookie, nonce, {.address = {10, 0, 0, 2}, .port = 1000}, now));
    CHECK_FALSE(cookies.valid(cookie, nonce, {.address = {10, 0, 0, 1}, .port = 1001}, now));
    CHECK_FALSE(cookies.valid(cookie, nonce, {.address = {10, 0, 0, 1}, .port = 1000, .v6 = true}, now));
    CHECK_FALSE(others.valid(cookie, nonce, at_tool, now));
    CHECK_FALSE(cookies.valid({}, nonce, at_tool, now));
  }
}

TEST_CASE("random values differ") {
  std::set<Nonce> seen;
  for (int i = 0; i < 1000; ++i) seen.insert(random_value<Nonce>());
  CHECK(seen.size() == 1000);
}

TEST_CASE("seal, authentic and the keys of a session do not allocate") {
  Sealed sample = sealed(ForceSample{.number = 1}, counted_key());
  const test::AllocationGuard guard;
  const Key key = direction_key(counted_key(), Direction::kToServer, kClientNonce, kServerNonce);
  sample.size = seal(sample.bytes, sample.size - kTagBytes, key);
  const bool good = authentic(sample.used(), key);
  CHECK(guard.count() == 0);
  CHECK(good);
}
