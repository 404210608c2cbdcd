#include "protocol/codec.h"

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::protocol;

namespace {

using Bytes = std::vector<std::byte>;

Bytes encoded(const Header& header, const Message& message) {
  Bytes bytes(kMaxDatagram);
  bytes.resize(encode(header, message, bytes));
  return bytes;
}

std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::byte b : bytes) text += fmt::format("{:02x}", std::to_integer<int>(b));
  return text;
}

const Header kHeader{0x1122334455667788, 7};

std::vector<Message> one_of_each() {
  ToolState tool{
      .tool = 1, .tick = 9, .newest_sample = 8, .t_ns = 123456789, .p_W = {0.5, -1, 2}, .v_W = {0, 0.25, 0}};
  tool.buttons = 5;
  ForceSample force{.tool = 1,
                    .number = 3,
                    .tool_tick = 9,
                    .tool_t_ns = 123456789,
                    .p_W = {0.5, -1, 2},
                    .f_W = {0, 1.5, 0}};
  force.step_ns = 70000;
  force.flags = ForceSample::kInContact;
  ToolState asking = tool;
  asking.flags = ToolState::kWantsHere | ToolState::kWantsAhead;
  asking.lead_ns = 0x0102030;
  ForceSample whole = force;
  whole.flags = ForceSample::kHasHere | ForceSample::kHasAhead;
  whole.surface_v_W = {0.25, 0, -0.5};
  whole.here = {{-1, -2, -3, -4, -5, -6}, {0, 1, 0}, 0.5};
  whole.ahead_p_W = {0.5, -1, 2};
  whole.ahead_f_W = {0, 1.5, 0};
  whole.ahead = {{-8, 0, 0, -16, 0, -32}, {0, 0, 0}, 0};
  ToolState fetching = tool;
  fetching.flags = ToolState::kWantsSurface | ToolState::kAsksPages;
  fetching.pages_taken = 0x0203;
  fetching.surface_version = 0xa1b2c3d4;
  fetching.pages = {7, 8, 9, 10, 11, 12, 13, ToolState::kNoPage};
  ForceSample on_surface = force;
  on_surface.flags = ForceSample::kHasSurface;
  on_surface.surface = {.version = 0xa1b2c3d4,
                        .vertices = 0x162,
                        .triangles = 0x2c0,
                        .tool_radius = 0.5,
                        .tool_friction = 0.25,
                        .tool_compliance = 2,
                        .shift_W = {0, -0.5, 0}};
  ForceSample with_errors = force;
  with_errors.flags = ForceSample::kHasErrors;
  with_errors.errors = {{ErrorSource::kEstimated, 3.5F}, {ErrorSource::kNone, 0}};
  ForceSample among_others = force;
  among_others.flags = ForceSample::kHasOthers;
  among_others.others = {{0.5, 0, -1}, {-1, -2, -3, -4, -5, -6}};
  ForceSample swinging = force;
  swinging.flags = ForceSample::kHasModes | ForceSample::kHasMean;
  swinging.modes.count = 2;
  swinging.modes.q = {0.5F, -1};
  swinging.modes.v = {2, 0};
  swinging.mean_f_W = {0, 1.5, 0};
  ForceSample relaxing = swinging;
  relaxing.flags = ForceSample::kHasModes | ForceSample::kHasRelaxed;
  relaxing.relaxed = {.terms = 2, .first = 1, .count = 1, .vertices = 1};
  relaxing.relaxed.share = {0.5F, 0.25F};
  relaxing.relaxed.time = {0.125F, 2};
  relaxing.relaxed.z = {-1, 3};
  relaxing.relaxed.vertex[0] = {0x0102, {1, 2, 3, 0.5F, 0, -0.5F}};
  SurfacePage page{.tool = 1, .version = 0xa1b2c3d4, .page = 0x0708};
  page.values.front() = 0.5F;
  page.values.back() = -2;
  return {Hello{.nonce = {42}, .attempt = 5},
          Welcome{{42}, 5, {43, 44}, 1, 30, 0.005},
          Refuse{{42}, 5, RefuseReason::kNoFreeTool},
          Bye{},
          tool,
          force,
          asking,
          whole,
          fetching,
          on_surface,
          page,
          with_errors,
          among_others,
          swinging,
          Challenge{{42}, 5, {45, 46}},
          relaxing};
}

}  // namespace

TEST_CASE("golden bytes: written down by hand from protocol/README.md") {
  const auto front = [](const char* type, const char* payload) {
    return std::string("504c5054") + "02" + type + payload +
           "00"
           "000000"
           "8877665544332211"
           "0700000000000000";
  };
  const auto messages = one_of_each();
  CHECK(hex(encoded(kHeader, messages[0])) == front("01", "0001") + "2a00000000000000" +
                                                  std::string(2 * 24, '0') + "0500000000000000" +
                                                  std::string(2 * 216, '0'));
  CHECK(hex(encoded(kHeader, messages[14])) == front("02", "2800") +
                                                   "2a000000000000000000000000000000"
                                                   "0500000000000000"
                                                   "2d000000000000002e00000000000000");
  CHECK(hex(encoded(kHeader, messages[1])) == front("03", "3900") +
                                                  "2a000000000000000000000000000000"
                                                  "0500000000000000"
                                                  "2b000000000000002c00000000000000"
                                                  "01"
                                                  "0000000000003e40"
                                                  "7b14ae47e17a743f");
  CHECK(hex(encoded(kHeader, messages[2])) == front("04", "1900") +
                                                  "2a000000000000000000000000000000"
                                                  "0500000000000000"
                                                  "01");
  CHECK(hex(encoded(kHeader, messages[3])) == front("05", "0000"));
  CHECK(hex(encoded(kHeader, messages[4])) == front("06", "6d00") +
                                                  "01"
                                                  "0900000000000000"
                                                  "0800000000000000"
                                                  "15cd5b0700000000"
                                                  "000000000000e03f"
                                                  "000000000000f0bf"
                                                  "0000000000000040"
                                                  "0000000000000000"
                                                  "000000000000d03f"
                                                  "0000000000000000"
                                                  "000000000000f03f"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "05000000");
  CHECK(hex(encoded(kHeader, messages[5])) == front("07", "6d00") +
                                                  "01"
                                                  "0300000000000000"
                                                  "0900000000000000"
                                                  "15cd5b0700000000"
                                                  "000000000000e03f"
                                                  "000000000000f0bf"
                                                  "0000000000000040"
                                                  "0000000000000000"
                                                  "000000000000f83f"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "7011010000000000"
                                                  "01000000");
  CHECK(hex(encoded(kHeader, messages[8])).substr(2 * (28 + 107)) ==
        "6000"  // flags, then: pages taken, version, pages
        "0302000000000000"
        "d4c3b2a1"
        "0700000008000000090000000a0000000b0000000c0000000d000000ffffffff");
  CHECK(hex(encoded(kHeader, messages[9])).substr(2 * (28 + 105)) ==
        "10000000"  // flags, then: version, vertices, triangles, radius, friction, compliance, shift
        "d4c3b2a1"
        "62010000"
        "c0020000"
        "000000000000e03f"
        "000000000000d03f"
        "0000000000000040"
        "0000000000000000"
        "000000000000e0bf"
        "0000000000000000");
  CHECK(hex(encoded(kHeader, messages[11])).substr(2 * (28 + 105)) ==
        "20000000"  // flags, then: source and percent of the mesh, source and percent of the time step
        "01"
        "00006040"
        "03"
        "00000000");
  CHECK(hex(encoded(kHeader, messages[12])).substr(2 * (28 + 105)) ==
        "40000000"  // flags, then: velocity, compliance
        "000000000000e03f"
        "0000000000000000"
        "000000000000f0bf"
        "000000000000f0bf"
        "00000000000000c0"
        "00000000000008c0"
        "00000000000010c0"
        "00000000000014c0"
        "00000000000018c0");
  CHECK(hex(encoded(kHeader, messages[13])).substr(2 * (28 + 105)) ==
        "80010000"
        "02"
        "0000003f00000040"
        "000080bf00000000"
        "0000000000000000000000000000f83f0000000000000000");
  CHECK(hex(encoded(kHeader, messages[15])).substr(2 * (28 + 105)) ==
        "80020000"
        "020000003f00000040000080bf00000000"
        "02"  // terms: share and time of each
        "0000003f0000003e"
        "0000803e00000040"
        "0101"  // first mode, count: both terms of it
        "000080bf00004040"
        "01"  // vertices: number, both terms
        "0201"
        "0000803f0000004000004040"
        "0000003f00000000000000bf");
  CHECK(hex(encoded(kHeader, messages[10])) == front("0a", "8d03") + "01" + "d4c3b2a1" + "08070000" +
                                                   "0000003f" + std::string(2 * 4 * 223, '0') + "000000c0");
  CHECK(hex(encoded(kHeader, messages[6])).substr(2 * (28 + 107)) ==
        "1800"
        "3020100000000000");
  CHECK(hex(encoded(kHeader, messages[7])).substr(2 * (28 + 105)) ==
        "0c000000"  // flags, then: surface velocity, tangent, normal, gap
        "000000000000d03f"
        "0000000000000000"
        "000000000000e0bf"
        "000000000000f0bf"
        "00000000000000c0"
        "00000000000008c0"
        "00000000000010c0"
        "00000000000014c0"
        "00000000000018c0"
        "0000000000000000"
        "000000000000f03f"
        "0000000000000000"
        "000000000000e03f"
        // place ahead, force there, tangent, normal, gap
        "000000000000e03f"
        "000000000000f0bf"
        "0000000000000040"
        "0000000000000000"
        "000000000000f83f"
        "0000000000000000"
        "00000000000020c0"
        "0000000000000000"
        "0000000000000000"
        "00000000000030c0"
        "0000000000000000"
        "00000000000040c0"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000");
}

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
  CHECK(verdict_of(force, [](Bytes& b) { b[5] = static_cast<std::byte>(MessageType::kTelemetry); }) ==
        Verdict::kType);
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
  CHECK(verdict(kMostSlowModes, 1e6F, -1e6F) == Verdict::kAccepted);
  CHECK(verdict(0, 1e6F, 0) == Verdict::kAccepted);
  CHECK(verdict(kMostSlowModes + 1, 0, 0) == Verdict::kValue);
  CHECK(verdict(255, 0, 0) == Verdict::kValue);
  CHECK(verdict(1, 2e6F, 0) == Verdict::kValue);
  CHECK(verdict(1, 0, -2e6F) == Verdict::kValue);
  CHECK(verdict(1, NAN, 0) == Verdict::kNotFinite);
}

TEST_CASE("a series that no tissue has, or more of what relaxes than a sample tells, is refused") {
  const auto verdict = [](auto change) {
    ForceSample sample = std::get<ForceSample>(one_of_each()[15]);
    change(sample.relaxed);
    Datagram datagram;
    return decode(encoded(kHeader, sample), datagram);
  };
  CHECK(verdict([](RelaxedState&) {}) == Verdict::kAccepted);
  CHECK(verdict([](RelaxedState& r) { r.share[0] = 0.8F; }) == Verdict::kValue);  // 1.05 together
  CHECK(verdict([](RelaxedState& r) { r.share[0] = -0.1F; }) == Verdict::kValue);
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
