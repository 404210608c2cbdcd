#include "haptic_client/session/telemetry_maker.h"

#include <algorithm>
#include <cmath>

#include "common/ages.h"
#include "haptic_client/session/whole_error.h"

namespace palpate::client {
using protocol::Telemetry;

namespace {

/// Appends to a name, as much as there is room for.
void append(Telemetry::Name& name, std::string_view text) noexcept {
  auto at = std::ranges::find(name, std::uint8_t{0});
  for (const char c : text) {
    if (at == name.end()) return;
    *at++ = static_cast<std::uint8_t>(c);
  }
}

template <class T>
std::uint32_t in_32_bits(T value) noexcept {
  return static_cast<std::uint32_t>(std::clamp<T>(value, 0, std::numeric_limits<std::uint32_t>::max()));
}

/// The page shows these numbers: a wild force that the limiter held back must still travel.
float newton(const Vec3& f) noexcept {
  return static_cast<float>(std::min(f.stableNorm(), 1e6));
}

}  // namespace

TelemetryMaker::TelemetryMaker(const std::string& device, bool motors, const std::string& law, double rate_hz)
    : law_(law),
      every_(static_cast<std::uint64_t>(std::ceil(rate_hz / kMessagesHz / Telemetry::kMostTicks))),
      ticks_(std::clamp<std::size_t>(
          static_cast<std::size_t>(rate_hz / kMessagesHz / static_cast<double>(every_)), 1,
          Telemetry::kMostTicks)) {
  append(next_.device, device);
  next_.flags = motors ? Telemetry::kHasMotors : 0;
}

const Telemetry* TelemetryMaker::tick(const TickResult& result, const Pipeline& pipeline,
                                      const Observation& observation, std::uint64_t missed) noexcept {
  const std::int64_t t = result.tool.t_ns;
  if (!wanted_ || !began_) {
    began_ = wanted_;
    start_at(t);
    return nullptr;
  }
  longest_ns_ = std::max(longest_ns_, t - last_ns_);
  oldest_ns_ = std::max(oldest_ns_, pipeline.age_ns());
  last_ns_ = t;
  const Vec3 rendered_W = pipeline.workspace().force_to_world(result.f_D);
  if (seen_++ % every_ == every_ - 1) add(rendered_W, observation.scoring());
  if (next_.count < ticks_) return nullptr;
  next_.f_W = rendered_W.allFinite() ? rendered_W : Vec3::Zero();
  complete(result, pipeline, observation, missed);
  start_at(t);
  return &published_;
}

void TelemetryMaker::start_at(std::int64_t t_ns) noexcept {
  start_ns_ = last_ns_ = t_ns;
  longest_ns_ = oldest_ns_ = 0;
  seen_ = 0;
  next_.count = 0;
}

void TelemetryMaker::add(const Vec3& rendered_W, const Scoring& scoring) noexcept {
  const std::size_t laws = scoring.names().size();
  next_.rendered[next_.count] = newton(rendered_W);
  for (std::size_t i = 0; i < laws; ++i) next_.by_law[next_.count * laws + i] = newton(scoring.forces()[i]);
  ++next_.count;
}

void TelemetryMaker::complete(const TickResult& result, const Pipeline& pipeline,
                              const Observation& observation, std::uint64_t missed) noexcept {
  const std::uint16_t motors = next_.flags & Telemetry::kHasMotors;
  next_.flags = motors;
  if (pipeline.limiter().fault() != Fault::kNone) next_.flags |= Telemetry::kFault;
  if ((result.tool.flags & protocol::ToolState::kClutched) != 0) next_.flags |= Telemetry::kClutched;
  if ((result.tool.flags & protocol::ToolState::kDeviceLost) != 0) next_.flags |= Telemetry::kDeviceLost;
  if (pipeline.paused()) next_.flags |= Telemetry::kPaused;
  if (pipeline.age_ns() > kOutage.count()) next_.flags |= Telemetry::kFading;
  if (pipeline.doubt()) next_.flags |= Telemetry::kUnsettled;
  next_.tool = result.tool.tool;
  next_.t_ns = result.tool.t_ns;
  next_.p_W = result.tool.p_W;
  next_.age_ns = oldest_ns_;
  const std::int64_t spent = last_ns_ - start_ns_;
  const auto periods = static_cast<std::int64_t>(seen_);
  next_.loop.period_ns = in_32_bits(spent / periods);
  next_.dt_ns = in_32_bits(spent / periods * static_cast<std::int64_t>(every_));
  next_.loop.longest_period_ns = in_32_bits(longest_ns_);
  next_.loop.ticks = result.tool.tick;
  next_.loop.missed = missed;
  next_.passivity_gain = static_cast<float>(std::clamp(pipeline.passivity().gain(), 0.0, 1.0));
  next_.interventions.faded = in_32_bits(pipeline.watchdog().ramped());
  next_.interventions.clamped = in_32_bits(pipeline.limiter().counts().clamped);
  next_.interventions.slewed = in_32_bits(pipeline.limiter().counts().slewed);
  next_.interventions.damped = in_32_bits(pipeline.passivity().counts().damped);
  next_.rendered_law = {};
  append(next_.rendered_law, law_);
  if (const std::string_view other = pipeline.substitute(); !other.empty())
    append(next_.rendered_law, ": "), append(next_.rendered_law, other);
  next_.laws = static_cast<std::uint8_t>(observation.scoring().names().size());
  name_error(observation);
  published_ = next_;
}

/// The next of the errors: of a law, or, behind all laws, of the force on the hand and its parts.
void TelemetryMaker::name_error(const Observation& observation) noexcept {
  static_assert(kHandErrors.size() <= Telemetry::kMostParts);
  static_assert(Telemetry::kLastColumn + 1 == Telemetry::kMostLaws + Telemetry::kMostParts);
  const Scoring& scoring = observation.scoring();
  next_.named = static_cast<std::uint8_t>((next_.named + 1U) % (next_.laws + kHandErrors.size()));
  next_.name = {};
  double error = -1;
  if (next_.named < next_.laws) {
    append(next_.name, scoring.names()[next_.named]);
    if (scoring.scored() > 0) error = scoring.metrics(next_.named).mean_percent;
  } else {
    const HandError& part = kHandErrors[next_.named - next_.laws];
    append(next_.name, part.name);
    error = part.percent(observation);
  }
  next_.error_percent = error >= 0 ? static_cast<float>(std::min(error, 1e6)) : -1;
}

}  // namespace palpate::client
