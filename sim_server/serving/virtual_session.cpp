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

constexpr std::uint16_t kFirstPort = 45131;  // of the clients
// For documentation (RFC 5737), as the clients' address.
const Endpoint kServer{.address = {192, 0, 2, 2}, .port = 45130};

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

std::vector<double> radii_of(const Simulation& simulation) {
  std::vector<double> radii;
  for (std::size_t i = 0; i < simulation.tools(); ++i) radii.push_back(simulation.tool(i).radius());
  return radii;
}

}  // namespace

VirtualSession::VirtualSession(Simulation& simulation, std::span<const Trajectory> motions,
                               const VirtualLink& link, CaptureWriter& capture, const ErrorOfForce* errors)
    : simulation_(simulation),
      served_(simulation, errors),
      inputs_(simulation.tools()),
      motions_(motions.first(std::min(motions.size(), simulation.tools()))),
      link_(link),
      capture_(capture),
      server_(link.rate_hz, radii_of(simulation)) {
  server_.set_scene(link.scene);
  for (std::size_t i = 0; i < motions_.size(); ++i) add_client(i);
  stats_.snaps = SnapCounter(link.rate_hz);
  stats_.missed = MissedTools(simulation.tools());
}

void VirtualSession::add_client(std::size_t tool) {
  clients_.push_back(
      {.tool = tool,
       .endpoint = {.address = {192, 0, 2, 1}, .port = static_cast<std::uint16_t>(kFirstPort + tool)},
       .session = session_number(motions_[tool], link_) + 2 * tool,
       .talk = ClientSession(Nonce{1 + tool}),
       .pages = {.near = NearTiles(served_.pager(tool)->state().vertices)}});
}

Time VirtualSession::time_of(std::uint64_t k) const {
  return from_seconds(static_cast<double>(k) / link_.ticks_hz);
}

void VirtualSession::tick(std::uint64_t k) {
  const Time t = now_ = time_of(k);
  for (Client& client : clients_) {
    keep_session(client, t);
    client.state = next_state(client, k, t);
  }
  note_paths();
  step(to_seconds(time_of(k + 1)) * link_.rate_hz);
  announce(clients_[link_.tool], t);
  for (Client& client : clients_) {
    if (client.tool != link_.tool) announce(client, t);
  }
  deliver(t);
}

ToolState VirtualSession::next_state(const Client& client, std::uint64_t k, Time t) const {
  const Trajectory& motion = motions_[client.tool];
  ToolState state = state_at(motion, to_seconds(t));
  state.tool = client.talk.welcome().tool;
  state.tick = k + 1;
  state.t_ns = t.count();
  if (k > 0) state.v_W = link_.ticks_hz * (state.p_W - motion.at(to_seconds(time_of(k - 1))));
  if (link_.parts) {
    state.flags |= ToolState::kRequestsTangent | ToolState::kRequestsAhead | ToolState::kRequestsSurface |
                   ToolState::kRequestsErrors;
    state.pages_taken = client.pages_taken;
    state.lead_ns = (lateness_.took + link_.delay + from_seconds(0.5 / link_.rate_hz)).count();
  }
  return state;
}

/// Sends the newest state of a tool.
void VirtualSession::announce(Client& client, Time t) {
  // What arrives in this very tick (no delay) is named by its tool state, though it stands behind it.
  for (const InTransit& next : in_transit_) {
    if (next.ready <= t && next.sample.tool == client.tool) client.newest = next.sample.number;
  }
  client.state.newest_sample = client.newest;
  to_server(client, client.talk.next_header(), client.state, t);
  ++stats_.tool_states;
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

/// A step answers the newest tool states there are when it begins.
void VirtualSession::step(double steps_due) {
  if (!is_due(steps_due)) return;
  ++steps_;
  // The organ stands as it does when the tools were read, so it moves from one answered tool state to the
  // next.
  const double dt = to_seconds(now_ - answered_);
  answered_ = now_;
  const Time begun = std::max(answered_, deadline());
  if (link_.clock != nullptr) link_.clock->begin(begun);
  const Time begin = thread_time();
  const auto outcomes = served_.step(inputs_, dt);
  note(outcomes, thread_time() - begin);
  const Time done = link_.clock == nullptr ? answered_ : pass(begun, link_.clock->took());
  for (const Client& client : clients_) {
    in_transit_.push_back({done + link_.delay, *outcomes[client.tool].answer});
    in_transit_.back().sample.tool = client.state.tool;
  }
}

void VirtualSession::note(std::span<const ServedTools::Outcome> outcomes, Time took) {
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
}

/// Notes the paths of all tools that led to where they are.
void VirtualSession::note_paths() {
  for (const Client& client : clients_) {
    SessionInput& input = inputs_[client.tool];
    input.session = client.session;
    input.state = client.state;
    input.fresh = true;
    input.path.add(client.state);
  }
}

void VirtualSession::deliver(Time t) {
  while (!in_transit_.empty() && in_transit_.front().ready <= t) {
    const InTransit next = in_transit_.front();
    in_transit_.pop_front();
    Client& client = clients_[next.sample.tool];
    // Numbered only now: a Welcome in between does not overtake it.
    auto* const member = server_.holder(next.sample.tool);
    to_client(client, {client.session, ++member->sent}, next.sample, next.ready);
    ++stats_.force_samples;
    const bool has_surface = (next.sample.flags & ForceSample::kHasSurface) != 0;
    if (has_surface && link_.parts) send_surface(client, next.sample, next.ready);
  }
}

void VirtualSession::keep_session(Client& client, Time t) {
  while (const auto hello = client.talk.poll(t)) to_server(client, {}, *hello, t);
}

void VirtualSession::send_shape(Client& client, Time t) {
  const SurfacePager& pager = *served_.pager(client.tool);
  const SurfacePages pages = pager.pages();
  client.pages.surface = pager.state().version;
  for (std::uint32_t page = 0; page < pages.first_tile(); ++page) send_page(client, page, t);
  if (pages.modes > 0) send_page(client, pages.spectrum(), t);
  client.pages.near = NearTiles(pager.state().vertices);
  client.pages.near.take(pager.rest());
  client.pages.has.assign(pages.count() - pages.first_tile(), 0);
  client.pages.sent.clear();
}

/// Sends what the client lacks of the surface by now, around where the tool is, in the frame of the organ at
/// rest; nothing of a surface that was withdrawn while a sample was on its way.
void VirtualSession::send_surface(Client& client, const ForceSample& sample, Time t) {
  const SurfacePager& pager = *served_.pager(client.tool);
  if (sample.surface.version != pager.state().version) return;
  if (sample.surface.version != client.pages.surface) send_shape(client, t);
  const SurfacePages pages = pager.pages();
  const double reach = NearTiles::reach(sample.surface.tool_radius, client.state.v_W.norm());
  NearTiles& near = client.pages.near;
  near.search(client.state.p_W - sample.surface.shift_W);
  if (near.distance() > reach && sample.f_W.isZero(0)) return;
  near.for_pairs(reach, [&](std::uint32_t a, std::uint32_t b) {
    pages.for_clusters(a, b, [&](std::uint32_t page) { keep_page(client, page, pages.first_tile(), t); });
    return true;
  });
}

/// Sends a page that the client no longer has, which then forgets its oldest.
void VirtualSession::keep_page(Client& client, std::uint32_t page, std::uint32_t first_tile, Time t) {
  Pages& pages = client.pages;
  const std::uint32_t tile = page - first_tile;
  if (pages.has[tile] != 0 || !send_page(client, page, t)) return;
  if (pages.sent.size() == NearTiles::kStored) {
    pages.has[pages.sent.front()] = 0;
    pages.sent.pop_front();
  }
  pages.has[tile] = 1;
  pages.sent.push_back(tile);
}

/// True if there is one by now. A client that asks in vain learns nothing, so it need not be in a capture.
bool VirtualSession::send_page(Client& client, std::uint32_t number, Time t) {
  SurfacePage page;
  if (!served_.pager(client.tool)->page(number, page) || page.page != number) return false;
  auto* const member = server_.holder(client.state.tool);
  to_client(client, {client.session, ++member->sent}, page, t);
  ++client.pages_taken;
  return true;
}

void VirtualSession::leave() {
  for (Client& client : clients_) to_server(client, client.talk.next_header(), Bye{}, now_);
}

/// Over the wire and into the capture, as bytes.
Datagram VirtualSession::travel(const Endpoint& from, const Endpoint& to, const Header& header,
                                const Message& message, Time t) {
  std::array<std::byte, kMaxDatagram> bytes;
  const std::size_t size = encode(header, message, bytes);
  capture_.write(t, from, to, {bytes.data(), size}, size);
  Datagram datagram;
  if (decode({bytes.data(), size}, datagram) == Verdict::kAccepted) return datagram;
  const auto* const state = std::get_if<ToolState>(&message);
  fail("the motion leads to {} m, farther than the protocol carries",
       state != nullptr ? state->p_W.norm() : 0);
}

void VirtualSession::to_server(Client& client, const Header& header, const Message& message, Time t) {
  const auto outcome = server_.receive(travel(client.endpoint, kServer, header, message, t), client.endpoint,
                                       t, {client.session}, server_stats_);
  if (outcome.answer) to_client(client, outcome.answer->first, outcome.answer->second, t);
}

void VirtualSession::to_client(Client& client, const Header& header, const Message& message, Time t) {
  client.talk.receive(travel(kServer, client.endpoint, header, message, t), t, client.stats);
}

}  // namespace palpate::sim
