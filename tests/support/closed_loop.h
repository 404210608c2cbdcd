#pragma once
/// A device, the whole tick and an organ in one loop of virtual time: what a hand would feel, in a test.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "haptic_client/device/device.h"
#include "haptic_client/pipeline/pipeline.h"
#include "protocol/codec.h"
#include "protocol/link_simulator.h"
#include "protocol/session.h"

namespace palpate::test {

/// How the loop runs. `link`: from reading the tool to having its force, as one way.
struct ClosedLoopSettings {
  double haptic_hz = 1000, sim_hz = 30;
  protocol::LinkConditions link = {.delay = 0.035};
  std::uint64_t seed = 1;   ///< of the link
  double faults_end = 1e6;  ///< s: what is sent from then on takes `link.delay` and nothing happens to it
};

/// An organ that is a function of the tool's place: with its tangent, and its surface out of contact.
using Organ = std::function<Linearisation(const Vec3& p_W)>;

/// What the loop asks at the other end of the link.
struct Server {
  /// A step for the newest tool state.
  std::function<std::optional<protocol::ForceSample>(const protocol::ToolState&)> step;
  /// The pages of the surface that a tool state asks for; asked every tick.
  std::function<std::vector<protocol::SurfacePage>(const protocol::ToolState&)> pages = {};
};

/// A server with that organ.
inline Server served(Organ organ) {
  const auto step = [=, number = std::uint64_t{0}](const protocol::ToolState& tool) mutable {
    using protocol::ForceSample;
    ForceSample sample{.number = ++number, .tool_t_ns = tool.t_ns, .p_W = tool.p_W};
    sample.at_tool = organ(tool.p_W);
    sample.f_W = sample.at_tool.f_W;
    if ((tool.flags & protocol::ToolState::kRequestsTangent) != 0) sample.flags |= ForceSample::kHasTangent;
    if ((tool.flags & protocol::ToolState::kRequestsAhead) != 0) {
      const Vec3 way = to_seconds(Time{tool.lead_ns}) * tool.v_W;
      sample.flags |= ForceSample::kHasAhead;
      sample.ahead_p_W = tool.p_W + (way.norm() > 2e-3 ? Vec3(2e-3 * way.normalized()) : way);
      sample.ahead = organ(sample.ahead_p_W);
      sample.ahead_f_W = sample.ahead.f_W;
    }
    return std::optional(sample);
  };
  return {.step = step};
}

/// A device and the whole tick at one end of a link, a server at the other; what it sends travels as bytes.
class ClosedLoop {
 public:
  ClosedLoop(client::Device& device, client::Pipeline& pipeline, Server server,
             const ClosedLoopSettings& settings)
      : device_(device),
        pipeline_(pipeline),
        server_(std::move(server)),
        settings_(settings),
        link_(settings.link, settings.seed),
        good_link_({.delay = settings.link.delay}, settings.seed) {}

  /// One tick; returns what was written.
  client::TickResult tick() {
    const double t = seconds();
    const Time now = from_seconds(1 + t);
    const client::DeviceReading reading = device_.read(now);
    receive(now);
    const client::TickResult result = pipeline_.tick(reading, arrived_ ? &*arrived_ : nullptr, pages_);
    device_.write(result.f_D);
    if (server_.pages) {
      for (const protocol::SurfacePage& page : server_.pages(result.tool)) send(page, now);
    }
    if (static_cast<double>(steps_) / settings_.sim_hz <= t + 1e-9) {
      ++steps_;
      if (const auto sample = server_.step(result.tool)) send(*sample, now);
    }
    ++ticks_;
    return result;
  }

  /// A tick that is missed: time goes on, and what was written stays.
  void skip() { ++ticks_; }

  double seconds() const { return static_cast<double>(ticks_) / settings_.haptic_hz; }
  const protocol::LinkCounts& link() const { return link_.counts(); }

 private:
  /// As the network thread does: of several force samples since the last tick, the one that came last.
  void receive(Time now) {
    arrived_.reset();
    pages_.clear();
    while (const auto bytes = link_.receive(now)) take(*bytes);
    while (const auto bytes = good_link_.receive(now)) take(*bytes);
  }
  void take(std::span<const std::byte> bytes) {
    protocol::Datagram datagram;
    if (protocol::decode(bytes, datagram) != protocol::Verdict::kAccepted) return;
    if (!window_.accept(datagram.header.sequence, stats_)) return;
    if (const auto* sample = std::get_if<protocol::ForceSample>(&datagram.message)) arrived_ = *sample;
    if (const auto* page = std::get_if<protocol::SurfacePage>(&datagram.message)) pages_.push_back(*page);
  }
  void send(const protocol::Message& message, Time now) {
    std::array<std::byte, protocol::kMaxDatagram> bytes;
    const std::size_t size = protocol::encode({1, ++sent_}, message, bytes);
    (seconds() < settings_.faults_end ? link_ : good_link_).send({bytes.data(), size}, now);
  }

  client::Device& device_;
  client::Pipeline& pipeline_;
  Server server_;
  ClosedLoopSettings settings_;
  protocol::LinkSimulator link_, good_link_;
  protocol::ReplayWindow window_{protocol::ClientSession::kMaxSample};
  protocol::LinkStats stats_;
  std::uint64_t ticks_ = 0, steps_ = 0, sent_ = 0;
  std::optional<protocol::ForceSample> arrived_;
  std::vector<protocol::SurfacePage> pages_;
};

/// A wall that begins at y = 0 and pushes upwards (N/m).
inline Organ wall(double stiffness) {
  return [stiffness](const Vec3& p_W) {
    Linearisation l{.p_W = p_W, .normal_W = {0, 1, 0}, .gap = std::max(p_W[1], 0.0)};
    l.f_W[1] = stiffness * std::max(-p_W[1], 0.0);
    l.tangent(1, 1) = -stiffness;
    return l;
  };
}

/// A wall as a sphere feels it on an elastic half-space (Hertz 1882): F = c depth^(3/2), with the c that
/// makes its slope `stiffness` (N/m) at `force` (N): F' = 3/2 c^(2/3) F^(1/3).
inline Organ hertz_wall(double stiffness, double force) {
  const double c = std::pow(stiffness / (1.5 * std::cbrt(force)), 1.5);
  return [c](const Vec3& p_W) {
    Linearisation l{.p_W = p_W, .normal_W = {0, 1, 0}, .gap = std::max(p_W[1], 0.0)};
    const double depth = std::max(-p_W[1], 0.0);
    l.f_W[1] = c * std::pow(depth, 1.5);
    l.tangent(1, 1) = -1.5 * c * std::sqrt(std::max(depth, 2e-4));  // free: as it will be at 0.2 mm
    return l;
  };
}

}  // namespace palpate::test
