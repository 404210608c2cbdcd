#include "sim_server/serving/virtual_session.h"

#include <algorithm>
#include <cmath>

#include "common/clock.h"
#include "common/error.h"
#include "common/hash.h"

namespace palpate::sim {
using namespace protocol;

namespace {

constexpr double kNow = 1e-9;  // s: rounding of tick and step times

Endpoint documentation_address(std::uint8_t last, std::uint16_t port) {
  return {.address = {192, 0, 2, last}, .port = port};
}
/// Captures of different motions or links are different sessions.
std::uint64_t session_number(const Trajectory& motion, const VirtualLink& link) {
  constexpr int kPlaces = 64;  // that tell one motion from another
  Fnv1a hash;
  hash.add(&link.rate_hz, sizeof link.rate_hz);
  hash.add(&link.ticks_hz, sizeof link.ticks_hz);
  hash.add(&link.delay, sizeof link.delay);
  for (int i = 0; i <= kPlaces; ++i) {
    const Vec3 p = motion.at(i * motion.duration() / kPlaces);
    hash.add(p.data(), sizeof p);
    if (motion.turns()) {
      const Quat q = motion.orientation_at(i * motion.duration() / kPlaces);
      hash.add(q.coeffs().data(), sizeof q);
    }
  }
  return hash.value() | 1;
}

/// Returns the state of a tool that follows `motion` exactly, `t` (s) after its start, without the velocity.
ToolState state_at(const Trajectory& motion, double t) {
  const Quat q = motion.orientation_at(t);
  return {.p_W = motion.at(t), .q_W = {q.w(), q.x(), q.y(), q.z()}, .buttons = motion.buttons_at(t)};
}

const Endpoint kClient = documentation_address(1, 45131), kServer = documentation_address(2, 45130);

}  // namespace

VirtualSession::VirtualSession(Simulation& simulation, std::span<const Trajectory> motions,
                               double tool_radius, const VirtualLink& link, CaptureWriter& capture,
                               const ErrorOfForce* errors)
    : simulation_(simulation),
      served_(simulation, errors),
      inputs_(simulation.tools()),
      motions_(motions.first(std::min(motions.size(), simulation.tools()))),
      link_(link),
      capture_(capture),
      server_(link.rate_hz, {tool_radius}),
      session_(session_number(motions[link.tool], link)),
      client_pages_{.surface = 0,
                    .near = protocol::NearTiles(served_.pager(link.tool)->state().vertices),
                    .sent = {},
                    .has = {}} {
  stats_.snaps = SnapCounter(link.rate_hz);
  stats_.missed = MissedTools(simulation.tools());
}

Time VirtualSession::time_of(std::uint64_t k) const {
  return from_seconds(static_cast<double>(k) / link_.ticks_hz);
}

void VirtualSession::tick(std::uint64_t k) {
  const Time t = now_ = time_of(k);
  keep_session(t);
  ToolState state = state_at(motions_[link_.tool], to_seconds(t));
  state.tool = client_.welcome().tool;
  state.tick = k + 1;
  state.t_ns = t.count();
  newest_p_W_ = state.p_W;
  if (k > 0) state.v_W = link_.ticks_hz * (state.p_W - motions_[link_.tool].at(to_seconds(time_of(k - 1))));
  newest_v_W_ = state.v_W;
  if (link_.parts) {
    state.flags |= ToolState::kRequestsTangent | ToolState::kRequestsAhead | ToolState::kRequestsSurface |
                   ToolState::kRequestsErrors;
    state.pages_taken = pages_;
    state.lead_ns = (lateness_.took + link_.delay + from_seconds(0.5 / link_.rate_hz)).count();
  }
  note_paths(state);
  step(state, to_seconds(time_of(k + 1)) * link_.rate_hz);
  // What arrives in this very tick (no delay) is named by its tool state, though it stands behind it.
  for (const InTransit& next : in_transit_) {
    if (next.ready > t) break;
    newest_ = next.sample.number;
  }
  state.newest_sample = newest_;
  to_server(client_.next_header(), state, t);
  ++stats_.tool_states;
  deliver(t);
}

/// Step n is due at n / rate; where steps take time, at a deadline that they put off. Either comes before the
/// next tick.
bool VirtualSession::is_due(double steps_due) const {
  if (link_.clock != nullptr) return to_seconds(deadline()) < steps_due / link_.rate_hz - kNow;
  return static_cast<double>(steps_) < steps_due - kNow * link_.rate_hz;
}

Time VirtualSession::deadline() const {
  return lateness_.put_off_to + from_seconds(static_cast<double>(lateness_.steps_since) / link_.rate_hz);
}

/// The deadline moves on by a period, or to the end of a step that took longer. When the step is done.
Time VirtualSession::pass(Time begun, Time took) {
  const Time done = begun + took;
  lateness_.took = took;
  ++lateness_.steps_since;
  if (done > deadline()) {
    stats_.late += static_cast<std::uint64_t>(to_seconds(done - deadline()) * link_.rate_hz) + 1;
    lateness_.put_off_to = done;
    lateness_.steps_since = 0;
  }
  return done;
}

/// A step answers the newest tool state there is when it begins.
void VirtualSession::step(const ToolState& state, double steps_due) {
  if (!is_due(steps_due)) return;
  ++steps_;
  // The organ stands as it does when the tool was read, so it moves from one answered tool state to the next.
  const double dt = to_seconds(Time{state.t_ns} - answered_);
  answered_ = Time{state.t_ns};
  const Time begun = std::max(answered_, deadline());
  if (link_.clock != nullptr) link_.clock->begin(begun);
  const Time begin = thread_time();
  const auto outcomes = served_.step(inputs_, dt);
  const Time took = thread_time() - begin;
  const auto touches = [](const ServedTools::Outcome& o) { return o.force.contacts > 0; };
  const auto is_flagged = [](const ServedTools::Outcome& o) { return o.force.flagged; };
  if (std::ranges::any_of(outcomes, touches)) {
    ++stats_.in_contact;
    stats_.contact_step_ns.add(took.count());
  }
  stats_.flagged += std::ranges::any_of(outcomes, is_flagged) ? 1 : 0;
  stats_.missed.measure(outcomes, simulation_, answered_);
  for (const ServedTools::Outcome& outcome : outcomes)
    stats_.max_newton = std::max(stats_.max_newton, outcome.force.force.norm());
  const ServedTools::Outcome& outcome = outcomes[link_.tool];
  stats_.snaps.add(outcome.force.force, answered_);
  stats_.jumps.add(published_force(*outcome.answer));
  const Time done = link_.clock == nullptr ? answered_ : pass(begun, link_.clock->took());
  in_transit_.push_back({done + link_.delay, *outcome.answer});
  in_transit_.back().sample.tool = state.tool;
}

/// Notes the paths of all tools that led to where they are at the time of this one's state.
void VirtualSession::note_paths(const ToolState& state) {
  const double t = to_seconds(Time{state.t_ns}), tick = 1 / link_.ticks_hz;
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    ToolState newest = state;
    if (i != link_.tool) {
      newest = state_at(motions_[i], t);
      newest.tool = static_cast<std::uint8_t>(i);
      newest.tick = state.tick;
      newest.t_ns = state.t_ns;
      if (t >= tick) newest.v_W = link_.ticks_hz * (newest.p_W - motions_[i].at(t - tick));
    }
    inputs_[i].session = i == link_.tool ? session_ : session_ + 1 + i;
    inputs_[i].state = newest;
    inputs_[i].fresh = true;
    inputs_[i].path.add(newest);
  }
}

void VirtualSession::deliver(Time t) {
  while (!in_transit_.empty() && in_transit_.front().ready <= t) {
    const InTransit next = in_transit_.front();
    in_transit_.pop_front();
    // Numbered only now: a Welcome in between does not overtake it.
    auto* const member = server_.holder(next.sample.tool);
    to_client({session_, ++member->sent}, next.sample, next.ready);
    ++stats_.force_samples;
    const bool has_surface = (next.sample.flags & ForceSample::kHasSurface) != 0;
    if (has_surface && link_.parts) send_surface(next.sample, next.ready);
  }
}

void VirtualSession::keep_session(Time t) {
  while (const auto hello = client_.poll(t)) to_server({}, *hello, t);
}

void VirtualSession::send_shape(Time t) {
  const SurfacePager& pager = *served_.pager(link_.tool);
  const SurfacePages pages = pager.pages();
  client_pages_.surface = pager.state().version;
  for (std::uint32_t page = 0; page < pages.first_tile(); ++page) send_page(page, t);
  if (pages.modes > 0) send_page(pages.spectrum(), t);
  client_pages_.near = NearTiles(pager.state().vertices);
  client_pages_.near.take(pager.rest());
  client_pages_.has.assign(pages.count() - pages.first_tile(), 0);
  client_pages_.sent.clear();
}

/// Sends what the client lacks of the surface by now, around where the tool is, in the frame of the organ at
/// rest; nothing of a surface that was withdrawn while a sample was on its way.
void VirtualSession::send_surface(const ForceSample& sample, Time t) {
  const SurfacePager& pager = *served_.pager(link_.tool);
  if (sample.surface.version != pager.state().version) return;
  if (sample.surface.version != client_pages_.surface) send_shape(t);
  const SurfacePages pages = pager.pages();
  const double reach = NearTiles::reach(sample.surface.tool_radius, newest_v_W_.norm());
  client_pages_.near.search(newest_p_W_ - sample.surface.shift_W);
  if (client_pages_.near.distance() > reach && sample.f_W.isZero(0)) return;
  client_pages_.near.for_pairs(reach, [&](std::uint32_t a, std::uint32_t b) {
    pages.for_clusters(a, b, [&](std::uint32_t page) { keep_page(page, pages.first_tile(), t); });
    return true;
  });
}

/// Sends a page that the client no longer has, which then forgets its oldest.
void VirtualSession::keep_page(std::uint32_t page, std::uint32_t first_tile, Time t) {
  const std::uint32_t tile = page - first_tile;
  if (client_pages_.has[tile] != 0 || !send_page(page, t)) return;
  if (client_pages_.sent.size() == NearTiles::kStored) {
    client_pages_.has[client_pages_.sent.front()] = 0;
    client_pages_.sent.pop_front();
  }
  client_pages_.has[tile] = 1;
  client_pages_.sent.push_back(tile);
}

/// True if there is one by now. A client that asks in vain learns nothing, so it need not be in a capture.
bool VirtualSession::send_page(std::uint32_t number, Time t) {
  SurfacePage page;
  if (!served_.pager(link_.tool)->page(number, page) || page.page != number) return false;
  auto* const member = server_.holder(client_.welcome().tool);
  to_client({session_, ++member->sent}, page, t);
  ++pages_;
  return true;
}

void VirtualSession::leave() {
  to_server(client_.next_header(), Bye{}, now_);
}

/// Over the wire and into the capture, as bytes.
Datagram VirtualSession::travel(const Endpoint& from, const Endpoint& to, const Header& header,
                                const Message& message, Time t) {
  std::array<std::byte, kMaxDatagram> bytes;
  const std::size_t size = encode(header, message, bytes);
  capture_.write(t, from, to, {bytes.data(), size}, size);
  Datagram datagram;
  if (decode({bytes.data(), size}, datagram) != Verdict::kAccepted)
    fail("the motion leads to {} m, farther than the protocol carries", newest_p_W_.norm());
  return datagram;
}

void VirtualSession::to_server(const Header& header, const Message& message, Time t) {
  const auto outcome =
      server_.receive(travel(kClient, kServer, header, message, t), kClient, t, {session_}, server_stats_);
  if (outcome.answer) to_client(outcome.answer->first, outcome.answer->second, t);
}

void VirtualSession::to_client(const Header& header, const Message& message, Time t) {
  client_.receive(travel(kServer, kClient, header, message, t), t, client_stats_);
}

}  // namespace palpate::sim
