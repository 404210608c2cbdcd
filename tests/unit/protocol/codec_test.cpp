#include "protocol/codec.h"

#include <algorithm>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/one_of_each.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::test;

TEST_CASE("what is encoded decodes to the same bytes again") {
  for (const Message& message : one_of_each()) {
    const Bytes bytes = encoded(kHeader, message);
    Datagram datagram;
    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
    CHECK(datagram.header.session == kHeader.session);
    CHECK(datagram.header.sequence == kHeader.sequence);
    CHECK(datagram.message.index() == message.index());
    CHECK(encoded(datagram.header, datagram.message) == bytes);
  }
}

TEST_CASE("every truncation is refused cleanly, Hello's padding alone may be missing only with its length") {
  for (const Message& message : one_of_each()) {
    const Bytes bytes = encoded(kHeader, message);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      // A copy of exactly this size, so that a sanitizer sees a read beyond it.
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      Datagram datagram;
      const Verdict verdict = decode(cut, datagram);
      REQUIRE(verdict == (size < kHeaderBytes ? Verdict::kTooShort : Verdict::kLength));
    }
  }
}

TEST_CASE("every change of one byte is refused or gives a valid message, which encodes") {
  int accepted = 0, refused = 0;
  for (const Message& message : one_of_each()) {
    const Bytes bytes = encoded(kHeader, message);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (int value = 0; value < 256; ++value) {
        Bytes changed = bytes;
        changed[at] = static_cast<std::byte>(value);
        Datagram datagram;
        if (decode(changed, datagram) != Verdict::kAccepted) {
          ++refused;
          continue;
        }
        ++accepted;
        REQUIRE_FALSE(encoded(datagram.header, datagram.message).empty());
      }
    }
  }
  CHECK(accepted > 10000);
  CHECK(refused > 10000);
}

TEST_CASE("each reason of refusal") {
  const auto verdict_of = [](Bytes bytes, auto change) {
    change(bytes);
    Datagram datagram;
    return decode(bytes, datagram);
  };
  const Bytes force = encoded(kHeader, one_of_each()[5]);
  CHECK(verdict_of(force, [](Bytes& b) { b[0] = std::byte{'Q'}; }) == Verdict::kNotOurs);
  CHECK(verdict_of(force, [](Bytes& b) { b[4] = std::byte{1}; }) == Verdict::kVersion);
  CHECK(verdict_of(force, [](Bytes& b) { b[5] = std::byte{99}; }) == Verdict::kType);
  CHECK(verdict_of(force, [](Bytes& b) { b[5] = std::byte{11}; }) == Verdict::kType);
  CHECK(verdict_of(force, [](Bytes& b) { b.push_back(std::byte{0}); }) == Verdict::kLength);
  CHECK(verdict_of(force, [](Bytes& b) { b[8] = std::byte{16}; }) ==
        Verdict::kLength);  // announces a tag that is not there
  CHECK(verdict_of(force, [](Bytes& b) { b.resize(4000); }) == Verdict::kLength);
  const auto with_f = [&](double f) {
    ForceSample sample = std::get<ForceSample>(one_of_each()[5]);
    sample.f_W[1] = f;
    return encoded(kHeader, sample);
  };
  Datagram untouched{{1, 2}, Bye{}};
  CHECK(decode(with_f(std::nan("")), untouched) == Verdict::kNotFinite);
  CHECK(decode(with_f(std::numeric_limits<double>::infinity()), untouched) == Verdict::kNotFinite);
  CHECK(decode(with_f(1e30), untouched) == Verdict::kValue);
  CHECK(untouched.header.session == 1);
}

TEST_CASE("a surface without a tool that could touch it is refused, and one that is none may say nothing") {
  constexpr std::size_t kVersion = 28 + 109, kRadius = kVersion + 12;  // by hand, behind the flags
  const auto with_radius = [](const char* radius, bool none = false) {
    Bytes bytes = encoded(kHeader, one_of_each()[9]);
    for (std::size_t i = 0; i < 8; ++i)
      bytes[kRadius + i] = static_cast<std::byte>(std::stoi(std::string(radius + 2 * i, 2), nullptr, 16));
    if (none) std::fill_n(bytes.begin() + kVersion, 4, std::byte{0});
    Datagram datagram;
    return decode(bytes, datagram);
  };
  CHECK(with_radius("000000000000e03f") == Verdict::kAccepted);  // 0.5, as it was
  CHECK(with_radius("0100000000000000") == Verdict::kAccepted);  // the least there is
  CHECK(with_radius("0000000000000000") == Verdict::kValue);
  CHECK(with_radius("0000000000000080") == Verdict::kValue);  // -0
  CHECK(with_radius("000000000000e0bf") == Verdict::kValue);  // -0.5
  CHECK(with_radius("0000000000000040") == Verdict::kValue);  // 2 m
  CHECK(with_radius("000000000000f87f") == Verdict::kNotFinite);
  CHECK(with_radius("000000000000f07f") == Verdict::kNotFinite);
  CHECK(with_radius("0000000000000000", true) == Verdict::kAccepted);
  CHECK(with_radius("000000000000e0bf", true) == Verdict::kValue);
}

TEST_CASE("more modes than there are, or wild ones, are refused") {
  const auto verdict = [](std::uint8_t count, float q, float v) {
    ForceSample sample = std::get<ForceSample>(one_of_each()[13]);
    sample.modes.count = count;
    sample.modes.q[0] = q;
    sample.modes.v[0] = v;
    Datagram datagram;
    return decode(encoded(kHeader, sample), datagram);
  };
  CHECK(verdict(kMaxPublishedModes, 1e6F, -1e6F) == Verdict::kAccepted);
  CHECK(verdict(0, 1e6F, 0) == Verdict::kAccepted);
  CHECK(verdict(kMaxPublishedModes + 1, 0, 0) == Verdict::kValue);
  CHECK(verdict(255, 0, 0) == Verdict::kValue);
  CHECK(verdict(1, 2e6F, 0) == Verdict::kValue);
  CHECK(verdict(1, 0, -2e6F) == Verdict::kValue);
  CHECK(verdict(1, NAN, 0) == Verdict::kNotFinite);
}

TEST_CASE("loads on more modes than there are, or wild ones, are refused") {
  const auto verdict = [](std::uint8_t count, float load) {
    ForceSample sample = std::get<ForceSample>(one_of_each()[18]);
    sample.modal_loads.count = count;
    sample.modal_loads.load[1] = load;
    Datagram datagram;
    return decode(encoded(kHeader, sample), datagram);
  };
  CHECK(verdict(kMaxPublishedModes, -1e6F) == Verdict::kAccepted);
  CHECK(verdict(0, 0) == Verdict::kAccepted);
  CHECK(verdict(kMaxPublishedModes + 1, 0) == Verdict::kValue);
  CHECK(verdict(2, 2e6F) == Verdict::kValue);
  CHECK(verdict(2, NAN) == Verdict::kNotFinite);
}

TEST_CASE("a series that no tissue has, or more of what relaxes than a sample tells, is refused") {
  const auto verdict = [](auto change) {
    ForceSample sample = std::get<ForceSample>(one_of_each()[15]);
    change(sample.relaxed);
    Datagram datagram;
    return decode(encoded(kHeader, sample), datagram);
  };
  CHECK(verdict([](RelaxedState&) {}) == Verdict::kAccepted);
  CHECK(verdict([](RelaxedState& r) { r.fraction[0] = 0.8F; }) == Verdict::kValue);  // 1.05 together
  CHECK(verdict([](RelaxedState& r) { r.fraction[0] = -0.1F; }) == Verdict::kValue);
  CHECK(verdict([](RelaxedState& r) { r.time[1] = 0; }) == Verdict::kValue);
  CHECK(verdict([](RelaxedState& r) { r.time[1] = 2e6F; }) == Verdict::kValue);
  CHECK(verdict([](RelaxedState& r) { r.time[1] = NAN; }) == Verdict::kNotFinite);
  CHECK(verdict([](RelaxedState& r) { r.z[1] = 2e6F; }) == Verdict::kValue);
  CHECK(verdict([](RelaxedState& r) { r.vertex[0].psi[5] = -2e6F; }) == Verdict::kValue);
  CHECK(verdict([](RelaxedState& r) { r.terms = 5; }) == Verdict::kValue);
  CHECK(verdict([](RelaxedState& r) { r.first = 75; }) == Verdict::kValue);  // and one mode from there
  CHECK(verdict([](RelaxedState& r) { r.count = 38; }) == Verdict::kValue);  // 76 amplitudes
  CHECK(verdict([](RelaxedState& r) { r.vertices = 8; }) == Verdict::kAccepted);
  CHECK(verdict([](RelaxedState& r) { r.vertices = 9; }) == Verdict::kValue);  // 18 forces
  CHECK(verdict([](RelaxedState& r) { r = {.terms = 0, .vertices = 255}; }) == Verdict::kValue);
}

TEST_CASE("a tag behind the payload, and fields a later version adds, do not disturb a reader") {
  Bytes bytes = encoded(kHeader, one_of_each()[5]);
  bytes[8] = std::byte{16};
  bytes.resize(bytes.size() + 16, std::byte{0xab});
  Datagram datagram;
  CHECK(decode(bytes, datagram) == Verdict::kAccepted);
  Bytes longer = encoded(kHeader, one_of_each()[5]);
  longer[6] = static_cast<std::byte>(std::to_integer<int>(longer[6]) + 3);
  longer.resize(longer.size() + 3);
  CHECK(decode(longer, datagram) == Verdict::kAccepted);
}

TEST_CASE("a Welcome that ends before the print of its scene, as older servers say it, tells of none") {
  const Welcome welcome{.nonce = {1}, .tool_radius = 0.005, .scene = {.mesh = 1, .tools = 2}};
  const Bytes whole = encoded(kHeader, welcome);
  Datagram datagram;
  REQUIRE(decode(whole, datagram) == Verdict::kAccepted);
  CHECK(std::get<Welcome>(datagram.message).scene == welcome.scene);
  for (std::size_t payload = 50; payload < 73; ++payload) {
    CAPTURE(payload);
    Bytes shorter = whole;
    shorter.resize(kHeaderBytes + payload);
    shorter[6] = static_cast<std::byte>(payload);
    datagram.message = Bye{};
    REQUIRE(decode(shorter, datagram) == (payload == 57 ? Verdict::kAccepted : Verdict::kLength));
    if (payload != 57) continue;
    CHECK(std::get<Welcome>(datagram.message).tool_radius == 0.005);
    CHECK(std::get<Welcome>(datagram.message).scene == ScenePrint{});
  }
}

TEST_CASE("a Hello without its padding is refused: it could be answered with more bytes than it has") {
  Bytes bytes = encoded({}, Hello{.nonce = {1}});
  bytes.resize(kHeaderBytes + 40);
  bytes[6] = std::byte{40};
  bytes[7] = std::byte{0};
  Datagram datagram;
  CHECK(decode(bytes, datagram) == Verdict::kLength);
}

TEST_CASE("no reply is larger than the Hello that asked for it") {
  const std::size_t hello = encoded({}, Hello{}).size();
  for (const std::size_t reply : {1u, 2u, 3u, 14u})
    CHECK(encoded(kHeader, one_of_each()[reply]).size() < hello);
}

TEST_CASE("random bytes never crash the decoder") {
  test::Random random(9);
  Bytes bytes(300);
  for (int trial = 0; trial < 20000; ++trial) {
    for (std::byte& b : bytes) b = static_cast<std::byte>(random.bits() & 0xff);
    const Bytes valid = encoded(kHeader, one_of_each()[static_cast<std::size_t>(trial % 6)]);
    if (trial % 2 == 0) std::copy_n(valid.begin(), std::min<std::size_t>(28, valid.size()), bytes.begin());
    Datagram datagram;
    const auto verdict = decode({bytes.data(), random.bits() % 300}, datagram);
    REQUIRE(static_cast<std::size_t>(verdict) < kVerdicts);
  }
}

TEST_CASE("encode and decode do not allocate") {
  const auto messages = one_of_each();
  Bytes bytes(kMaxDatagram);
  Datagram datagram;
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    for (const Message& message : messages) {
      const std::size_t size = encode(kHeader, message, bytes);
      decode({bytes.data(), size}, datagram);
    }
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
