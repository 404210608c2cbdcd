#include "protocol/codec.h"

#include <algorithm>
#include <cassert>

#include "common/contact/tool.h"
#include "protocol/surface_pages.h"
#include "protocol/wire.h"

namespace palpate::protocol {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'P', 'L', 'P', 'T'};
constexpr std::array<std::uint8_t, 2> kReserved{};
constexpr float kMaxAmplitude = 1e6F;                     // of a mode, m sqrt(kg), and of its rate
constexpr float kMaxRelaxation = 1e6F;                    // s
constexpr float kMaxPercent = 1e6F;                       // of an error of a force
constexpr std::int64_t kMaxLead = 10'000'000'000;         // ns
constexpr std::int64_t kMaxTime = std::int64_t{1} << 61;  // ns, 73 years: times of any two can be subtracted

bool small(const Vec3& v) noexcept {
  return v.cwiseAbs().maxCoeff() <= kMaxMagnitude;
}
bool is_time(std::int64_t t_ns) noexcept {
  return t_ns >= -kMaxTime && t_ns <= kMaxTime;
}
bool valid(const Hello&) noexcept {
  return true;
}
bool valid(const Challenge&) noexcept {
  return true;
}
bool valid(const Welcome& m) noexcept {
  return m.tool < kMaxTools && m.rate_hz >= 0 && m.rate_hz <= 1e6 && m.tool_radius > 0 && m.tool_radius <= 1;
}
bool valid(const Refuse& m) noexcept {
  return m.reason >= RefuseReason::kNoFreeTool && m.reason <= RefuseReason::kVersion;
}
bool valid(const Bye&) noexcept {
  return true;
}
bool valid(const ToolState& m) noexcept {
  const auto& q = m.q_W;
  const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return m.tool < kMaxTools && m.tick > 0 && small(m.p_W) && small(m.v_W) &&
         std::abs(norm - 1) < kUnitTolerance && is_time(m.t_ns) && m.lead_ns >= 0 && m.lead_ns <= kMaxLead;
}
bool valid(const Linearisation& m) noexcept {
  const double size = m.normal_W.squaredNorm();
  return m.tangent.cwiseAbs().maxCoeff() <= kMaxMagnitude &&
         (size == 0 || std::abs(size - 1) < kUnitTolerance) && m.gap >= 0 && m.gap <= kMaxMagnitude;
}
/// Says nothing of a radius of 0 where there is no surface.
bool valid(const SurfaceState& m) noexcept {
  return m.vertices <= kMostSurfaceVertices && m.triangles <= 2 * kMostSurfaceVertices &&
         m.tool_radius <= 1 && (m.tool_radius > 0 || (m.version == 0 && m.tool_radius == 0)) &&
         m.tool_friction >= 0 && m.tool_friction <= 10 && m.tool_compliance >= 0 &&
         m.tool_compliance <= 1e6 && small(m.shift_W);
}
bool valid(const DiscretisationError& m) noexcept {
  return m.source <= ErrorSource::kNone && m.percent >= 0 && m.percent <= kMaxPercent;
}
bool valid(const OtherTools& m) noexcept {
  return small(m.v_W) && m.compliance.cwiseAbs().maxCoeff() <= 1e6;
}
bool valid(const ModalState& m) noexcept {
  const auto bounded = [](float x) { return std::abs(x) <= kMaxAmplitude; };
  return m.count <= kMaxPublishedModes && std::ranges::all_of(m.q, bounded) &&
         std::ranges::all_of(m.v, bounded);
}
bool valid(const ForceSample& m) noexcept {
  return m.tool < kMaxTools && m.number > 0 && is_time(m.tool_t_ns) && small(m.p_W) && small(m.f_W) &&
         small(m.torque_W) && small(m.surface_v_W) && valid(m.at_tool) && small(m.ahead_p_W) &&
         small(m.ahead_f_W) && valid(m.ahead) && valid(m.surface) && valid(m.errors.mesh) &&
         valid(m.errors.time_step) && valid(m.others) && valid(m.modes) && small(m.mean_f_W) &&
         valid(m.relaxed) && valid(m.modal_loads);
}
bool valid(const SurfacePage& m) noexcept {
  return m.tool < kMaxTools && m.page != ToolState::kNoPage &&
         std::ranges::all_of(m.values, [](float x) { return std::abs(x) <= 1e9f; });
}

bool valid(const Telemetry& m) noexcept {
  const auto ascii = [](const Telemetry::Name& name) {
    return std::ranges::all_of(name, [](std::uint8_t c) { return c == 0 || (c >= 32 && c < 127); });
  };
  const auto force = [](float f) { return std::abs(f) <= 1e9F; };
  return m.tool < kMaxTools && small(m.p_W) && small(m.f_W) && m.passivity_gain >= 0 &&
         m.passivity_gain <= 1 && ascii(m.device) && ascii(m.rendered_law) && ascii(m.name) &&
         m.named < Telemetry::kMostLaws && m.error_percent <= kMaxPercent && m.laws <= Telemetry::kMostLaws &&
         m.count <= Telemetry::kMostTicks && std::ranges::all_of(m.rendered, force) &&
         std::ranges::all_of(m.by_law, force);
}
bool valid(const Pointer& m) noexcept {
  return m.tool < kMaxTools && m.number > 0 && small(m.p_W);
}

template <class M>
Verdict read_as(std::span<const std::byte> payload, Message& out) noexcept {
  M message;
  Reader reader(payload);
  M::fields(message, reader);
  if (!reader.complete()) return Verdict::kLength;
  if (!reader.finite()) return Verdict::kNotFinite;
  if (!valid(message)) return Verdict::kValue;
  out = message;
  return Verdict::kAccepted;
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
      return read_as<Welcome>(payload, out);
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
  return m.count <= kMaxPublishedModes &&
         std::ranges::all_of(m.load, [](float x) { return std::abs(x) <= kMaxAmplitude; });
}

bool valid(const RelaxedState& m) noexcept {
  const auto bounded = [](float x) { return std::abs(x) <= kMaxAmplitude; };
  if (m.terms > kMostRelaxations || m.count * m.terms > RelaxedState::kMostAmplitudes ||
      m.first + m.count > kMaxPublishedModes || m.vertices * m.terms > RelaxedState::kMostForces ||
      m.vertices > RelaxedState::kMostForces)
    return false;
  float fractions = 0;
  for (std::size_t j = 0; j < m.terms; ++j) {
    fractions += m.fraction[j];
    if (!(m.fraction[j] >= 0 && m.time[j] > 0 && m.time[j] <= kMaxRelaxation)) return false;
  }
  return fractions < 1 && std::ranges::all_of(m.z, bounded) &&
         std::ranges::all_of(
             m.vertex, [&](const RelaxedState::Vertex& v) { return std::ranges::all_of(v.psi, bounded); });
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

Verdict decode(std::span<const std::byte> in, Datagram& out) noexcept {
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

}  // namespace palpate::protocol
