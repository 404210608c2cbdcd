// Whatever comes from the wire and the device, whenever it comes: force and its change stay in their limits.
#include <algorithm>
#include <limits>

#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "protocol/codec.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;
using protocol::ForceSample;
using namespace std::chrono_literals;

namespace {

constexpr double kForce = 3, kSlew = 500;  // N, N/s

/// Numbers, ordinary ones and others; the same for the same seed.
class Wild {
 public:
  explicit Wild(std::uint64_t seed) : random_(seed) {}
  std::uint64_t below(std::uint64_t end) { return random_.bits() % end; }
  bool once_in(std::uint64_t n) { return below(n) == 0; }

  /// Of an ordinary size, with a NaN, an infinity, a denormal or a number beyond measure now and then.
  Vec3 vector(std::span<const double> sizes) {
    constexpr double kBeyond[] = {0, 1e308, -1e308, 1e-320};
    Vec3 v = random_.vector(sizes[below(sizes.size())]);
    if (once_in(50)) v[0] = kBeyond[below(4)];
    if (once_in(97)) v[1] = std::nan("");
    if (once_in(97)) v[2] = std::numeric_limits<double>::infinity();
    return v;
  }
  Vec3 vector() { return vector(kSizes); }
  Vec3 place() { return vector(std::span(kSizes).first(4)); }
  double number() { return vector()[static_cast<long>(below(3))]; }
  double ordinary(double size) { return random_.vector(size)[0]; }

  protocol::Linearisation linearisation() {
    protocol::Linearisation l;
    const double size = once_in(4) ? 1e30 : 2000;  // N/m; of either sign: no tissue, but it may be sent
    for (double& k : l.tangent) k = once_in(40) ? number() : ordinary(size);
    l.normal_W = once_in(3) ? vector() : random_.vector(1).normalized();
    l.gap = once_in(20) ? number() : std::abs(ordinary(0.002));
    return l;
  }

  ForceSample sample(Time now) {
    ForceSample s{.number = below(1000) + 1, .p_W = place(), .f_W = vector()};
    s.tool_t_ns = (now - Time{static_cast<Time::rep>(below(400'000'000))}).count();
    if (once_in(100)) s.tool_t_ns = std::numeric_limits<std::int64_t>::min();
    if (once_in(100)) s.tool_t_ns = std::numeric_limits<std::int64_t>::max();
    s.flags = static_cast<std::uint32_t>(below(128));
    s.others.v_W = vector();
    for (double& c : s.others.compliance) c = once_in(20) ? number() : ordinary(0.01);
    s.surface_v_W = vector(), s.here = linearisation();
    s.ahead_p_W = place(), s.ahead_f_W = vector(), s.ahead = linearisation();
    s.surface = {.version = static_cast<std::uint32_t>(below(40) == 0 ? below(3) : 1),
                 .vertices = 6,
                 .triangles = 8,
                 .tool_radius = once_in(30) ? number() : 0.005,
                 .tool_friction = once_in(30) ? number() : 0.3,
                 .tool_compliance = once_in(30) ? number() : 0,
                 .shift_W = once_in(10) ? place() : Vec3(Vec3::Zero())};
    return s;
  }

  protocol::SurfacePage page() {
    protocol::SurfacePage p{.version = 1, .page = static_cast<std::uint32_t>(below(8))};
    for (float& value : p.values) {
      value = static_cast<float>(ordinary(0.02));
      if (once_in(200)) value = static_cast<float>(ordinary(1e30));
    }
    return p;
  }

 private:
  static constexpr double kSizes[] = {0, 1e-9, 1e-3, 1, 1e30, 1e-320};
  test::Random random_;
};

/// Whether the client would let this in from the wire.
bool is_let_in(const protocol::Message& message) {
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  protocol::Datagram out;
  const std::size_t size = protocol::encode({1, 1}, message, bytes);
  return protocol::decode(std::span(bytes).first(size), out) == protocol::Verdict::kAccepted;
}

/// Runs a law on wild input; returns the largest force that came out.
double largest_force(const ExtrapolatorRow& law, bool through_the_wire, int ticks) {
  Pipeline pipeline(law.make(), {}, {.max_force = kForce, .max_slew = kSlew});
  Wild wild(13);
  Time t = 1s;
  Vec3 last = Vec3::Zero();
  double largest = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    const Time dt = wild.once_in(500) ? Time{1s} : Time{static_cast<Time::rep>(wild.below(4'000'000))};
    t += dt;
    const ForceSample sample = wild.sample(t);
    const protocol::SurfacePage page = wild.page();
    const bool fresh = wild.once_in(4) && (!through_the_wire || is_let_in(sample)),
               paged = wild.once_in(8) && is_let_in(page);
    const DeviceReading reading{.t = t, .p_D = wild.place(), .valid = !wild.once_in(300)};
    const Vec3 f = pipeline
                       .tick(reading, fresh ? &sample : nullptr,
                             std::span(&page, static_cast<std::size_t>(paged ? 1 : 0)))
                       .f_D;
    REQUIRE(f.allFinite());
    REQUIRE(f.norm() <= kForce * (1 + 1e-12));
    // It goes as slowly as it comes; only a lost device and a fault take it away at once.
    const bool dropped =
        !reading.valid || !reading.p_D.allFinite() || pipeline.limiter().fault() != Fault::kNone;
    if (!dropped)
      REQUIRE((f - last).norm() <= kSlew * std::min(to_seconds(dt), kLongestTick) * (1 + 1e-9) + 1e-12);
    if (dropped) REQUIRE(f.isZero(0));
    last = f;
    largest = std::max(largest, f.norm());
    if (wild.once_in(8)) pipeline.rearm();
  }
  return largest;
}

}  // namespace

TEST_CASE("whatever comes from the wire and the device, force and its change stay within their limits") {
  for (const ExtrapolatorRow& law : extrapolators()) {
    for (const bool through_the_wire : {true, false}) {
      CAPTURE(law.name, through_the_wire);
      CHECK(largest_force(law, through_the_wire, 40000) > 0);
    }
  }
}
