#include "protocol/codec.h"

#include <algorithm>
#include <cassert>

#include "common/contact/tool.h"
#include "protocol/earlier_ticks.h"
#include "protocol/wire.h"

namespace palpate::protocol {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'P', 'L', 'P', 'T'};
constexpr std::array<std::uint8_t, 2> kReserved{};
constexpr std::size_t kOlderWelcome = 57;  // bytes of payload

static_assert(limits::kToolNumber.most + 1 == kMaxTools);
static_assert(limits::kPageNumber.most + 1 == ToolState::kNoPage);

/// Visits a message: true if each of its fields is within its limits.
class LimitCheck {
 public:
  bool is_passed() const noexcept { return passed_; }

  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T x, const Range& range) noexcept {
    const auto value = static_cast<double>(x);
    require(value >= range.least && value <= range.most && !(range.is_open && value == range.least));
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T x) noexcept {
    if constexpr (std::is_floating_point_v<T>) (*this)(x, limits::kAnyReal);
  }
  void operator()(const Telemetry::Name& name) noexcept {
    require(std::ranges::all_of(name, [](std::uint8_t c) { return c == 0 || (c >= 32 && c < 127); }));
  }
  void operator()(RefuseReason reason) noexcept {
    require(reason >= RefuseReason::kNoFreeTool && reason <= RefuseReason::kVersion);
  }
  void operator()(ErrorSource source) noexcept { require(source <= ErrorSource::kNone); }
  template <class Vector>
  void operator()(const Vector& vector, const UnitLength& length) noexcept {
    double square = 0;
    for (const double x : vector) square += x * x;
    require(std::abs(square - 1) < length.tolerance || (length.or_zero && square == 0));
  }
  template <class T, std::size_t N, class... Limits>
  requires(...&& std::is_same_v<Limits, Range>) void operator()(const std::array<T, N>& values,
                                                                const Limits&... limits) noexcept {
    for (const T& value : values) (*this)(value, limits...);
  }
  template <class Derived, class... Limits>
  requires(...&& std::is_same_v<Limits, Range>) void operator()(const Eigen::DenseBase<Derived>& values,
                                                                const Limits&... limits) noexcept {
    for (const double value : values.reshaped()) (*this)(value, limits...);
  }

 private:
  void require(bool is_met) noexcept { passed_ = passed_ && is_met; }

  bool passed_ = true;
};

template <class M>
bool is_within_limits(const M& m) noexcept {
  LimitCheck check;
  M::fields(m, check);
  return check.is_passed();
}

/// Returns whether the fields of a message that are each within their limits agree with one another.
template <class M>
bool is_consistent(const M&) noexcept {
  return true;
}
bool is_consistent(const RelaxedState& m) noexcept {
  double fractions = 0;
  for (std::size_t j = 0; j < m.terms; ++j) fractions += static_cast<double>(m.fraction[j]);
  return m.count * m.terms <= RelaxedState::kMostAmplitudes && m.first + m.count <= kMaxPublishedModes &&
         m.vertices * m.terms <= RelaxedState::kMostForces && fractions < 1;
}
bool is_consistent(const ForceSample& m) noexcept {
  return (m.surface.tool_radius > 0 || m.surface.version == 0) && is_consistent(m.relaxed);
}

template <class M>
Verdict read_as(std::span<const std::byte> payload, Message& out) noexcept {
  M message;
  Reader reader(payload);
  M::fields(message, reader);
  if (!reader.complete()) return Verdict::kLength;
  if (!reader.finite()) return Verdict::kNotFinite;
  if (!is_within_limits(message) || !is_consistent(message)) return Verdict::kValue;
  out = message;
  return Verdict::kAccepted;
}

/// Servers before `Welcome::scene` end their Welcome in front of it: it reads as not known.
Verdict read_welcome(std::span<const std::byte> payload, Message& out) noexcept {
  if (payload.size() != kOlderWelcome) return read_as<Welcome>(payload, out);
  std::array<std::byte, kOlderWelcome + sizeof(ScenePrint)> whole{};
  std::ranges::copy(payload, whole.begin());
  return read_as<Welcome>(whole, out);
}

Verdict read_payload(MessageType type, std::span<const std::byte> payload, Message& out) noexcept {
  switch (type) {
    case MessageType::kHello:
      // Unpadded, it could be answered with more bytes than it has: a lever for a stranger who forges
      // addresses.
      return payload.size() < kHelloPayload ? Verdict::kLength : read_as<Hello>(payload, out);
    case MessageType::kChallenge:
      return read_as<Challenge>(payload, out);
    case MessageType::kWelcome:
      return read_welcome(payload, out);
    case MessageType::kRefuse:
      return read_as<Refuse>(payload, out);
    case MessageType::kBye:
      return read_as<Bye>(payload, out);
    case MessageType::kToolState:
      return read_as<ToolState>(payload, out);
    case MessageType::kForceSample:
      return read_as<ForceSample>(payload, out);
    case MessageType::kSurfacePage:
      return read_as<SurfacePage>(payload, out);
    case MessageType::kTelemetry:
      return read_as<Telemetry>(payload, out);
    case MessageType::kPointer:
      return read_as<Pointer>(payload, out);
  }
  return Verdict::kType;
}

}  // namespace

bool valid(const ModalLoads& m) noexcept {
  return is_within_limits(m);
}

bool valid(const RelaxedState& m) noexcept {
  return is_within_limits(m) && is_consistent(m);
}

bool valid(const ToolState& m) noexcept {
  return is_within_limits(m);
}

void set_payload_size(std::span<std::byte> datagram, std::size_t payload) noexcept {
  Writer(datagram.subspan(kPayloadAt))(static_cast<std::uint16_t>(payload));
}

std::span<const std::byte> behind_fields(const Datagram& datagram) noexcept {
  if (!std::holds_alternative<ToolState>(datagram.message)) return {};
  const std::size_t tag = std::to_integer<std::size_t>(datagram.bytes[kTagLengthAt]);
  const auto payload = datagram.bytes.subspan(kHeaderBytes, datagram.bytes.size() - kHeaderBytes - tag);
  ToolState state;
  Reader reader(payload);
  ToolState::fields(state, reader);
  return payload.subspan(reader.used());
}

std::size_t encode(const Header& header, const Message& message, std::span<std::byte> out) noexcept {
  assert(out.size() >= kMaxDatagram);
  return std::visit(
      [&](const auto& m) {
        using M = std::decay_t<decltype(m)>;
        Writer body(out.subspan(kHeaderBytes));
        M::fields(m, body);
        std::size_t payload = body.size();
        if (M::kType == MessageType::kHello) {
          std::fill(out.begin() + kHeaderBytes + payload, out.begin() + kHeaderBytes + kHelloPayload,
                    std::byte{0});
          payload = kHelloPayload;
        }
        Writer front(out);
        front(kMagic), front(kProtocolVersion), front(M::kType), front(static_cast<std::uint16_t>(payload));
        front(std::uint8_t{0}), front(std::uint8_t{0}), front(kReserved), front(header.session),
            front(header.sequence);
        return kHeaderBytes + payload;
      },
      message);
}

const char* name_of(Verdict verdict) noexcept {
  static constexpr std::array<const char*, kVerdicts> kNames{
      "accepted",   "too_short", "not_ours", "version", "type", "length",
      "not_finite", "value",     "tag",      "session", "tool", "direction"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::optional<OtherVersion> other_version(std::span<const std::byte> in) noexcept {
  if (in.size() < kHeaderBytes) return {};
  Reader reader(in);
  std::array<std::uint8_t, 4> magic{};
  OtherVersion other;
  MessageType type{};
  reader(magic), reader(other.version), reader(type);
  if (magic != kMagic || other.version == kProtocolVersion) return {};
  other.hello = type == MessageType::kHello && in.size() >= kHeaderBytes + kHelloPayload;
  return other;
}

Verdict decode_fields(std::span<const std::byte> in, Datagram& out) noexcept {
  if (in.size() < kHeaderBytes) return Verdict::kTooShort;
  Reader reader(in);
  std::array<std::uint8_t, 4> magic{};
  std::array<std::uint8_t, 2> reserved{};
  std::uint8_t version = 0, tag_bytes = 0;
  MessageType type{};
  std::uint16_t payload = 0;
  Header header;
  reader(magic), reader(version), reader(type), reader(payload), reader(tag_bytes), reader(header.key),
      reader(reserved);
  reader(header.session), reader(header.sequence);
  if (magic != kMagic) return Verdict::kNotOurs;
  if (version != kProtocolVersion) return Verdict::kVersion;
  if (reserved != kReserved || (tag_bytes != 0 && tag_bytes != kTagBytes)) return Verdict::kLength;
  if (in.size() != kHeaderBytes + payload + tag_bytes || in.size() > kMaxDatagram) return Verdict::kLength;
  Message message;
  const Verdict verdict = read_payload(type, in.subspan(kHeaderBytes, payload), message);
  if (verdict != Verdict::kAccepted) return verdict;
  out = {header, message, in};
  return Verdict::kAccepted;
}

Verdict decode_earlier(const Datagram& datagram) noexcept {
  const auto* const state = std::get_if<ToolState>(&datagram.message);
  if (state == nullptr || (state->flags & ToolState::kHasEarlierTicks) == 0) return Verdict::kAccepted;
  std::array<ToolState, kMostEarlierTicks> ticks;
  return read_earlier_ticks(*state, behind_fields(datagram), ticks) ? Verdict::kAccepted : Verdict::kValue;
}

Verdict decode(std::span<const std::byte> in, Datagram& out) noexcept {
  Datagram read;
  if (const Verdict verdict = decode_fields(in, read); verdict != Verdict::kAccepted) return verdict;
  if (const Verdict verdict = decode_earlier(read); verdict != Verdict::kAccepted) return verdict;
  out = read;
  return Verdict::kAccepted;
}

}  // namespace palpate::protocol
