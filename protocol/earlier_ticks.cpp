#include "protocol/earlier_ticks.h"

#include <algorithm>
#include <cassert>

#include "protocol/wire.h"

namespace palpate::protocol {
namespace {

/// Of the filter by which `haptic_client` makes a velocity, s. Another filter costs bytes, not exactness.
constexpr double kVelocityFilter = 0.005;

/// Bits of the first byte of a tick: which of its fields stand there.
enum Part : std::uint8_t {
  kTick = 1,    ///< not one less than the tick after it
  kSample = 2,  ///< another newest sample
  kBits = 4,    ///< other buttons or flags
  kTurn = 8,    ///< another orientation
  kLead = 16,   ///< another lead
  kPagesTaken = 32,
  kPlace = 64,     ///< another place than predicted
  kVelocity = 128  ///< another velocity than predicted
};

/// Returns a number whose order is that of reals, so that two near reals have near numbers.
std::uint64_t order_of(double x) noexcept {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}
double real_of(std::uint64_t order) noexcept {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return std::bit_cast<double>((order & kSign) != 0 ? order & ~kSign : ~order);
}

/// Maps differences, modulo 2^64, so that small ones of either sign become small numbers.
std::uint64_t zigzag(std::uint64_t difference) noexcept {
  return (difference << 1) ^ (0 - (difference >> 63));
}
std::uint64_t unzigzag(std::uint64_t z) noexcept {
  return (z >> 1) ^ (0 - (z & 1));
}

constexpr std::size_t kMostBytesOfATick = 200;  // 188 at worst, with each field and eight pages

/// Writes numbers in as many bytes as they need.
class Packer {
 public:
  explicit Packer(std::span<std::byte> out) noexcept : out_(out) {}
  void byte(std::uint8_t value) noexcept { out_[at_++] = static_cast<std::byte>(value); }
  void number(std::uint64_t value) noexcept {  // LEB128
    for (; value >= 0x80; value >>= 7) byte(static_cast<std::uint8_t>(value | 0x80));
    byte(static_cast<std::uint8_t>(value));
  }
  void difference(std::uint64_t now, std::uint64_t expected) noexcept { number(zigzag(now - expected)); }
  /// Half a byte for each real, how many bytes it differs by, then these bytes.
  template <std::size_t N>
  void reals(const std::array<double, N>& now, const std::array<double, N>& expected) noexcept {
    std::array<std::uint64_t, N> z{};
    std::uint16_t sizes = 0;
    for (std::size_t i = 0; i < N; ++i) {
      z[i] = zigzag(order_of(now[i]) - order_of(expected[i]));
      sizes = static_cast<std::uint16_t>(sizes | ((std::bit_width(z[i]) + 7) / 8) << (4 * i));
    }
    byte(static_cast<std::uint8_t>(sizes)), byte(static_cast<std::uint8_t>(sizes >> 8));
    for (std::uint64_t rest : z) {
      for (; rest != 0; rest >>= 8) byte(static_cast<std::uint8_t>(rest));
    }
  }
  std::size_t size() const noexcept { return at_; }
  std::size_t room() const noexcept { return out_.size() - at_; }

 private:
  std::span<std::byte> out_;
  std::size_t at_ = 0;
};

/// Reads them; what is not there reads as 0, and `is_valid` says so.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> in) noexcept : in_(in) {}
  std::uint8_t byte() noexcept {
    valid_ = valid_ && at_ < in_.size();
    return valid_ ? std::to_integer<std::uint8_t>(in_[at_++]) : std::uint8_t{0};
  }
  std::uint64_t number() noexcept {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t next = byte();
      value |= static_cast<std::uint64_t>(next & 0x7f) << shift;
      if (next < 0x80) return value;
    }
    valid_ = false;
    return value;
  }
  std::uint64_t difference(std::uint64_t expected) noexcept { return expected + unzigzag(number()); }
  template <std::size_t N>
  std::array<double, N> reals(const std::array<double, N>& expected) noexcept {
    const auto low = byte();
    const unsigned sizes = low | static_cast<unsigned>(byte()) << 8;
    std::array<double, N> all{};
    for (std::size_t i = 0; i < N; ++i) {
      const unsigned bytes = sizes >> (4 * i) & 15;
      valid_ = valid_ && bytes <= 8;
      std::uint64_t z = 0;
      for (unsigned k = 0; k < bytes && valid_; ++k) z |= static_cast<std::uint64_t>(byte()) << (8 * k);
      all[i] = real_of(order_of(expected[i]) + unzigzag(z));
      valid_ = valid_ && std::isfinite(all[i]);
    }
    return all;
  }
  bool is_valid() const noexcept { return valid_; }

 private:
  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  bool valid_ = true;
};

/// True if they are equal bit by bit: 0 and -0 are not.
template <std::size_t N>
bool is_same(const std::array<double, N>& a, const std::array<double, N>& b) noexcept {
  using Bits = std::array<std::uint64_t, N>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

std::array<double, 3> values_of(const Vec3& v) noexcept {
  return {v[0], v[1], v[2]};
}
Vec3 vector_of(const std::array<double, 3>& v) noexcept {
  return {v[0], v[1], v[2]};
}

std::uint64_t unsigned_of(std::int64_t value) noexcept {
  return static_cast<std::uint64_t>(value);
}

/// What writer and reader know of a tick before they come to it: the tick after it, and the one after that.
class Prediction {
 public:
  Prediction(const ToolState& after, const ToolState* then) noexcept : after_(after) {
    if (then != nullptr) {
      gap_ = unsigned_of(then->t_ns) - unsigned_of(after.t_ns);
      step_ = then->p_W - after.p_W;
    }
  }
  /// That ticks are as long as each other.
  std::uint64_t t() const noexcept { return unsigned_of(after_.t_ns) - gap_; }
  /// That the tool goes on as it went; of the first, by its velocity.
  std::array<double, 3> place(std::int64_t t_ns) const noexcept {
    const Vec3 step = gap_ != 0 ? step_ : Vec3(after_.v_W * seconds(t_ns));
    return values_of(after_.p_W - step);
  }
  /// That the velocity is filtered (`Pipeline::sense`), and this the value before that.
  std::array<double, 3> velocity(std::int64_t t_ns, const Vec3& p_W) const noexcept {
    const double dt = seconds(t_ns), share = dt / (dt + kVelocityFilter);
    if (!(dt > 0 && dt < 1)) return values_of(after_.v_W);
    return values_of((after_.v_W - share * ((after_.p_W - p_W) / dt)) / (1 - share));
  }

 private:
  double seconds(std::int64_t t_ns) const noexcept {
    return 1e-9 *
           static_cast<double>(static_cast<std::int64_t>(unsigned_of(after_.t_ns) - unsigned_of(t_ns)));
  }

  const ToolState& after_;
  std::uint64_t gap_ = 0;  // ns
  Vec3 step_ = Vec3::Zero();
};

void pack(const ToolState& tick, const ToolState& after, const ToolState* then, Packer& out) noexcept {
  const Prediction predicted(after, then);
  const auto place = predicted.place(tick.t_ns), velocity = predicted.velocity(tick.t_ns, tick.p_W);
  const bool bits = tick.buttons != after.buttons || tick.flags != after.flags;
  std::uint8_t parts = 0;
  const auto has = [&](bool differs, Part part) {
    if (differs) parts = static_cast<std::uint8_t>(parts | part);
    return differs;
  };
  has(tick.tick != after.tick - 1, kTick), has(tick.newest_sample != after.newest_sample, kSample),
      has(bits, kBits), has(!is_same(tick.q_W, after.q_W), kTurn), has(tick.lead_ns != after.lead_ns, kLead),
      has(tick.pages_taken != after.pages_taken, kPagesTaken),
      has(!is_same(values_of(tick.p_W), place), kPlace),
      has(!is_same(values_of(tick.v_W), velocity), kVelocity);
  out.byte(parts);
  out.difference(unsigned_of(tick.t_ns), predicted.t());
  if ((parts & kTick) != 0) out.difference(tick.tick, after.tick);
  if ((parts & kSample) != 0) out.difference(tick.newest_sample, after.newest_sample);
  if ((parts & kBits) != 0) out.number(tick.buttons), out.number(tick.flags);
  if ((parts & kTurn) != 0) out.reals(tick.q_W, after.q_W);
  if ((parts & kLead) != 0) out.difference(unsigned_of(tick.lead_ns), unsigned_of(after.lead_ns));
  if ((parts & kPagesTaken) != 0) out.difference(tick.pages_taken, after.pages_taken);
  if ((parts & kPlace) != 0) out.reals(values_of(tick.p_W), place);
  if ((parts & kVelocity) != 0) out.reals(values_of(tick.v_W), velocity);
  if ((tick.flags & ToolState::kAsksPages) == 0) return;
  out.number(tick.surface_version);
  for (const std::uint32_t page : tick.pages) out.number(page + std::uint32_t{1});  // none: one byte
}

ToolState unpack(const ToolState& after, const ToolState* then, Unpacker& in) noexcept {
  const Prediction predicted(after, then);
  ToolState tick;
  tick.tool = after.tool;
  const std::uint8_t parts = in.byte();
  tick.t_ns = static_cast<std::int64_t>(in.difference(predicted.t()));
  tick.tick = (parts & kTick) != 0 ? in.difference(after.tick) : after.tick - 1;
  tick.newest_sample = (parts & kSample) != 0 ? in.difference(after.newest_sample) : after.newest_sample;
  tick.buttons = (parts & kBits) != 0 ? static_cast<std::uint16_t>(in.number()) : after.buttons;
  tick.flags = (parts & kBits) != 0 ? static_cast<std::uint16_t>(in.number()) : after.flags;
  tick.q_W = (parts & kTurn) != 0 ? in.reals(after.q_W) : after.q_W;
  tick.lead_ns = (parts & kLead) != 0 ? static_cast<std::int64_t>(in.difference(unsigned_of(after.lead_ns)))
                                      : after.lead_ns;
  tick.pages_taken = (parts & kPagesTaken) != 0 ? in.difference(after.pages_taken) : after.pages_taken;
  const auto place = predicted.place(tick.t_ns);
  tick.p_W = vector_of((parts & kPlace) != 0 ? in.reals(place) : place);
  const auto velocity = predicted.velocity(tick.t_ns, tick.p_W);
  tick.v_W = vector_of((parts & kVelocity) != 0 ? in.reals(velocity) : velocity);
  if ((tick.flags & ToolState::kAsksPages) == 0) return tick;
  tick.surface_version = static_cast<std::uint32_t>(in.number());
  for (std::uint32_t& page : tick.pages) page = static_cast<std::uint32_t>(in.number()) - 1;
  return tick;
}

/// Fields that a message without the bit of their part does not have.
ToolState without_absent_parts(ToolState tick) noexcept {
  if ((tick.flags & ToolState::kRequestsAhead) == 0) tick.lead_ns = 0;
  if ((tick.flags & ToolState::kRequestsSurface) == 0) tick.pages_taken = 0;
  return tick;
}

}  // namespace

std::size_t encode_ticks(const Header& header, std::span<const ToolState> ticks,
                         std::span<std::byte> out) noexcept {
  assert(!ticks.empty() && ticks.size() <= kMostEarlierTicks + 1);
  ToolState newest = ticks.back();
  if (ticks.size() == 1) return encode(header, newest, out);
  newest.flags |= ToolState::kHasEarlierTicks;
  const std::size_t begin = encode(header, newest, out);
  std::array<ToolState, 3> row{
      without_absent_parts(ticks.back()), {}, {}};  // the tick, that after it, that after this one
  Packer packer(out.subspan(begin, kMaxDatagram - kTagBytes - begin));
  packer.byte(static_cast<std::uint8_t>(ticks.size() - 1));
  for (std::size_t i = ticks.size() - 1; i-- > 0;) {
    row = {without_absent_parts(ticks[i]), row[0], row[1]};
    std::array<std::byte, kMostBytesOfATick> bytes;
    Packer one(bytes);
    pack(row[0], row[1], i + 2 < ticks.size() ? &row[2] : nullptr, one);
    if (one.size() > packer.room()) return 0;
    for (std::size_t k = 0; k < one.size(); ++k) packer.byte(std::to_integer<std::uint8_t>(bytes[k]));
  }
  set_payload_size(out, begin - kHeaderBytes + packer.size());
  return begin + packer.size();
}

std::optional<std::size_t> read_earlier_ticks(const ToolState& newest, std::span<const std::byte> behind,
                                              std::span<ToolState> out) noexcept {
  assert(out.size() >= kMostEarlierTicks);
  if (behind.empty()) return 0;  // of a version that has the bit for something else
  Unpacker in(behind);
  const std::size_t count = in.byte();
  if (count > kMostEarlierTicks) return {};
  ToolState after = newest;
  after.flags &= static_cast<std::uint16_t>(~ToolState::kHasEarlierTicks);
  for (std::size_t i = 0; i < count; ++i) {
    const ToolState later = i > 1 ? out[i - 2] : after;
    out[i] = unpack(i > 0 ? out[i - 1] : after, i > 0 ? &later : nullptr, in);
    if (!in.is_valid() || !valid(out[i]) || (out[i].flags & ToolState::kHasEarlierTicks) != 0) return {};
  }
  return count;
}

std::vector<ToolState> ticks_of(const Datagram& datagram) {
  const auto* const state = std::get_if<ToolState>(&datagram.message);
  if (state == nullptr) return {};
  ToolState newest = *state;
  newest.flags &= static_cast<std::uint16_t>(~ToolState::kHasEarlierTicks);
  if (newest.flags == state->flags) return {newest};
  std::vector<ToolState> ticks(kMostEarlierTicks);
  ticks.resize(read_earlier_ticks(*state, behind_fields(datagram), ticks).value_or(0));
  std::ranges::reverse(ticks);
  ticks.push_back(newest);
  return ticks;
}

}  // namespace palpate::protocol
