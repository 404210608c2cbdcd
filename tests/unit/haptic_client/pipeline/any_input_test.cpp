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
class Implausible {
 public:
  /// `any_count`: also of more than there is room for, which the codec refuses.
  Implausible(std::uint64_t seed, bool any_count) : random_(seed), any_count_(any_count) {}
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

  Mat3 symmetric(std::uint64_t seldom, double size) {
    Mat3 m;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) m(i, j) = m(j, i) = once_in(seldom) ? number() : ordinary(size);
    }
    return m;
  }

  Linearisation linearisation() {
    Linearisation l;
    const double size = once_in(4) ? 1e30 : 2000;  // N/m; of either sign: no tissue, but it may be sent
    l.tangent = symmetric(40, size);
    l.normal_W = once_in(3) ? vector() : random_.vector(1).normalized();
    l.gap = once_in(20) ? number() : std::abs(ordinary(0.002));
    return l;
  }

  ForceSample sample(Time now) {
    ForceSample s{.number = below(1000) + 1, .p_W = place(), .f_W = vector()};
    s.tool_t_ns = (now - Time{static_cast<Time::rep>(below(400'000'000))}).count();
    if (once_in(100)) s.tool_t_ns = std::numeric_limits<std::int64_t>::min();
    if (once_in(100)) s.tool_t_ns = std::numeric_limits<std::int64_t>::max();
    s.flags = static_cast<std::uint32_t>(below(2 * ForceSample::kCutting));
    if (!once_in(40)) s.flags &= ~ForceSample::kPaused;
    s.others.v_W = vector();
    s.others.compliance = symmetric(20, 0.01);
    s.surface_v_W = vector(), s.at_tool = linearisation();
    s.ahead_p_W = place(), s.ahead_f_W = vector(), s.ahead = linearisation();
    s.surface = {.version = static_cast<std::uint32_t>(below(40) == 0 ? below(3) : 1),
                 .vertices = 6,
                 .triangles = 8,
                 .tool_radius = once_in(30) ? number() : 0.005,
                 .tool_friction = once_in(30) ? number() : 0.3,
                 .tool_compliance = once_in(30) ? number() : 0,
                 .shift_W = once_in(10) ? place() : Vec3(Vec3::Zero())};
    s.mean_f_W = vector();
    s.cuts = static_cast<std::uint32_t>(once_in(40) ? below(3) : 1);
    add_motion(s);
    return s;
  }

  /// Mostly of as many modes as `page` has room for with the 6 vertices and 8 triangles of `sample`.
  void add_motion(ForceSample& s) {
    const auto amplitude = [&] { return static_cast<float>(once_in(40) ? number() : ordinary(1e-3)); };
    const auto fill = [&](auto& numbers) {
      for (float& x : numbers) x = amplitude();
    };
    s.modes.count = count(3, s.modes.q.size());
    s.modal_loads.count = count(s.modes.count, s.modal_loads.load.size());
    s.relaxed.terms = count(1 + below(2), s.relaxed.fraction.size());
    s.relaxed.count = count(3, s.relaxed.z.size() / s.relaxed.fraction.size());
    s.relaxed.first = count(0, s.modes.q.size() - std::min<std::size_t>(s.relaxed.count, s.modes.q.size()));
    s.relaxed.vertices = count(2, s.relaxed.vertex.size() / s.relaxed.fraction.size());
    fill(s.modes.q), fill(s.modes.v), fill(s.modal_loads.load);
    s.relaxed.terms = static_cast<std::uint8_t>(once_in(10) ? below(256) : 1 + below(2));
    s.relaxed.first = static_cast<std::uint8_t>(once_in(10) ? below(256) : 0);
    s.relaxed.count = static_cast<std::uint8_t>(once_in(10) ? below(256) : 3);
    s.relaxed.vertices = static_cast<std::uint8_t>(once_in(10) ? below(256) : 2);
    for (float& fraction : s.relaxed.fraction) fraction = once_in(20) ? amplitude() : 0.3F;
    for (float& time : s.relaxed.time) time = once_in(20) ? amplitude() : 0.5F;
    fill(s.relaxed.z);
    for (auto& vertex : s.relaxed.vertex) {
      vertex.number = static_cast<std::uint16_t>(once_in(20) ? below(65536) : below(6));
      fill(vertex.psi);
    }
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
  /// Now and then another one than usual.
  std::uint8_t count(std::uint64_t usual, std::size_t most) {
    return static_cast<std::uint8_t>(once_in(10) ? below(any_count_ ? 256 : most + 1) : usual);
  }

  test::Random random_;
  bool any_count_;
};

/// Whether the client would let this in from the wire.
bool is_let_in(const protocol::Message& message) {
  std::array<std::byte, 4 * protocol::kMaxDatagram> bytes;  // with all parts at once it may be longer
  protocol::Datagram out;
  const std::size_t size = protocol::encode({1, 1}, message, bytes);
  return size <= protocol::kMaxDatagram &&
         protocol::decode(std::span(bytes).first(size), out) == protocol::Verdict::kAccepted;
}

/// Runs a law on wild input; returns the largest force that came out.
double largest_force(const ExtrapolatorRow& law, bool through_the_wire, int ticks) {
  Pipeline pipeline(law.make(), {}, {.max_force = kForce, .max_slew = kSlew});
  Implausible implausible(13, through_the_wire);
  Time t = 1s;
  Vec3 last = Vec3::Zero();
  double largest = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    const Time dt =
        implausible.once_in(500) ? Time{1s} : Time{static_cast<Time::rep>(implausible.below(4'000'000))};
    t += dt;
    const ForceSample sample = implausible.sample(t);
    const protocol::SurfacePage page = implausible.page();
    const bool fresh = implausible.once_in(4) && (!through_the_wire || is_let_in(sample)),
               paged = implausible.once_in(8) && is_let_in(page);
    const DeviceReading reading{.t = t, .p_D = implausible.place(), .valid = !implausible.once_in(300)};
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
    if (implausible.once_in(8)) pipeline.rearm();
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
