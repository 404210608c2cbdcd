#include "sim_server/serving/net_link.h"

#include <algorithm>

#include "common/clock.h"
#include "protocol/earlier_ticks.h"

namespace palpate::sim {
using protocol::Datagram;
using protocol::Endpoint;
using protocol::Verdict;

namespace {

/// A client of ours asks for one page a millisecond; a megabyte a second carries two.
constexpr double kPagesPerSecond = 2000, kPagesAtOnce = 32;

/// Returns what a session would begin with.
protocol::ServerSessions::Fresh fresh_for(const Datagram& datagram) {
  if (!std::holds_alternative<protocol::Hello>(datagram.message)) return {};
  return {protocol::random_value<std::uint64_t>() | 1, protocol::random_value<protocol::Nonce>()};
}

/// Anything but a Welcome answers somebody who has no session, or not yet.
bool is_to_a_stranger(const protocol::ServerSessions::Outcome& outcome) {
  return outcome.answer && !std::holds_alternative<protocol::Welcome>(outcome.answer->second);
}

}  // namespace

NetLink::NetLink(protocol::UdpSocket& socket, protocol::ServerSessions sessions, SimMailboxes& mailboxes,
                 protocol::Recorder* recorder, PageMailboxes* page)
    : socket_(socket),
      recorder_(recorder),
      sessions_(std::move(sessions)),
      mailboxes_(mailboxes),
      page_(page),
      page_buckets_(kMaxTools, {kPagesPerSecond, kPagesAtOnce}) {}

void NetLink::run() {
  socket_.run(mailboxes_.bell, std::chrono::milliseconds(50),
              {.on_datagram = [this](auto bytes, const Endpoint& from) { on_datagram(bytes, from); },
               .on_doorbell = [this] { on_forces(); },
               .on_timer = [this] { on_timer(); }});
  for (auto member : sessions_.members()) send(member, protocol::Bye{});
}

void NetLink::on_datagram(std::span<const std::byte> bytes, const Endpoint& from) {
  const Time t = now();
  Datagram datagram;
  if (const Verdict verdict = protocol::decode_fields(bytes, datagram); verdict != Verdict::kAccepted) {
    record(t, from, Direction::kIn, bytes, false);
    return refuse(verdict, bytes, from);
  }
  const std::size_t before = sessions_.members().size();
  const std::uint64_t received = stats_.received, lost = stats_.lost;
  const auto outcome = sessions_.receive(datagram, from, t, fresh_for(datagram), stats_);
  // Before any answer to it, as a reader of the capture expects.
  record(t, from, Direction::kIn, bytes, stats_.received > received && !is_to_a_stranger(outcome));
  // A new member stands at the end; it may have come in the place of one.
  const std::size_t departed = outcome.departed != nullptr ? 1 : 0;
  if (sessions_.members().size() + departed > before) {
    const std::uint8_t tool = sessions_.members().back().tool;
    ++tools[tool].so_far;
    requested_[tool] = socket_.requested();
    peers_[tool] = {};
  }
  note_holders();
  if (outcome.mismatch) mismatch.write({*outcome.mismatch, from});
  answer(outcome, from);
  if (outcome.departed != nullptr) tool_is_free(outcome.departed->tool);
  if (outcome.telemetry != nullptr && page_ != nullptr)
    page_->tools[outcome.telemetry->tool].telemetry.push(*outcome.telemetry);
  const std::vector<protocol::ToolState> ticks = outcome.tool_state != nullptr || outcome.asking != nullptr
                                                     ? protocol::ticks_of(datagram)
                                                     : std::vector<protocol::ToolState>();
  if (outcome.tool_state != nullptr) {
    requested_[outcome.tool_state->tool] = socket_.requested();
    pass_on(datagram.header.session, ticks);
  }
  if (outcome.asking != nullptr) send_pages(ticks, t);
  if (outcome.asking != nullptr || outcome.telemetry != nullptr) {
    PeerCounts& peer = peers_[outcome.asking != nullptr ? outcome.asking->tool : outcome.telemetry->tool];
    peer.received += stats_.received - received;
    if (outcome.tool_state != nullptr) peer.ticks += ticks.size();
    peer.lost += stats_.lost - lost;  // less, where a late one takes a loss back
  }
}

/// Into the recording, if there is one. `ours`: of a session; of all else there may be any number.
void NetLink::record(Time t, const Endpoint& peer, Direction direction, std::span<const std::byte> bytes,
                     bool ours) {
  if (recorder_ == nullptr) return;
  const Endpoint& own = own_towards(peer);
  const Endpoint &from = direction == Direction::kIn ? peer : own,
                 &to = direction == Direction::kIn ? own : peer;
  if (ours) {
    recorder_->note(t, from, to, bytes);
  } else {
    recorder_->note_refused(t, from, to, bytes);
  }
}

/// A Hello of another version is answered with the version that is spoken here.
void NetLink::refuse(Verdict verdict, std::span<const std::byte> bytes, const Endpoint& to) {
  stats_.reject(verdict);
  const auto other = protocol::other_version(bytes);
  if (other && other->hello)
    answer({.answer = {{{}, protocol::Refuse{{}, 0, protocol::RefuseReason::kVersion}}}}, to);
}

/// Passes the newest of some ticks on to the simulation, with the path that led there in this session.
void NetLink::pass_on(std::uint64_t session, std::span<const protocol::ToolState> ticks) {
  const protocol::ToolState& state = ticks.back();
  SessionInput& input = inputs_[state.tool];
  if (input.session != session) input = {};
  input.session = session;
  input.state = state;
  for (const protocol::ToolState& tick : ticks) input.follow(tick);
  mailboxes_.tools[state.tool].input.write(input);
}

/// The pages that some ticks ask for, each once, if they are of the surface that we have and the client is
/// known to receive at its address; what is lost, or too much at once, will be asked for again.
void NetLink::send_pages(std::span<const protocol::ToolState> ticks, Time t) {
  const std::uint8_t tool = ticks.back().tool;
  std::shared_ptr<SurfacePager>& pager = pagers_[tool];
  mailboxes_.tools[tool].pager.read(pager);
  auto* const member = sessions_.holder(tool);
  if (pager == nullptr || !member->is_reached()) return;
  std::vector<std::uint32_t> sent;
  protocol::SurfacePage page;
  for (const protocol::ToolState& tick : ticks) {
    if ((tick.flags & protocol::ToolState::kAsksPages) == 0) continue;
    if (tick.surface_version != pager->state().version) continue;
    for (const std::uint32_t number : tick.pages) {
      if (number == protocol::ToolState::kNoPage || std::ranges::find(sent, number) != sent.end()) continue;
      if (!page_buckets_[tool].take(t)) return;
      sent.push_back(number);
      if (pager->page(number, page)) send(*member, page);
    }
  }
}

/// Adds what was heard of the tool's session, where the client asks for it and the sample has room.
void NetLink::tell_uplink(protocol::ForceSample& sample) const {
  using protocol::ForceSample;
  const bool requested = (inputs_[sample.tool].state.flags & protocol::ToolState::kRequestsUplink) != 0;
  const bool full = (sample.flags & ForceSample::kHasModes) != 0 &&
                    (sample.flags &
                     (ForceSample::kHasRelaxed | ForceSample::kHasModalLoads | ForceSample::kHasOthers)) != 0;
  if (!requested || full) return;
  const PeerCounts& peer = peers_[sample.tool];
  sample.flags |= ForceSample::kHasUplink;
  sample.uplink = {static_cast<std::uint32_t>(peer.received), static_cast<std::uint32_t>(peer.lost)};
}

void NetLink::on_forces() {
  for (ToolMailboxes& mailboxes : mailboxes_.tools) {
    ForceOutput output;
    if (!mailboxes.force.read(output)) continue;
    auto* member = sessions_.holder(output.sample.tool);
    if (member == nullptr || member->session != output.session) continue;
    if (page_ != nullptr && page_->requests_telemetry)
      output.sample.flags |= protocol::ForceSample::kRequestsTelemetry;
    tell_uplink(output.sample);
    send(*member, output.sample);
  }
  if (page_ != nullptr) send_pointers();
}

void NetLink::send_pointers() {
  for (std::size_t i = 0; i < kMaxTools; ++i) {
    protocol::Pointer pointer;
    if (!page_->tools[i].pointer.read(pointer)) continue;
    pointer.tool = static_cast<std::uint8_t>(i);
    if (auto* member = sessions_.holder(pointer.tool)) send(*member, pointer);
  }
}

void NetLink::on_timer() {
  watcher.note(stats_);
  for (const auto& expired : sessions_.expire(now())) tool_is_free(expired.tool);
  note_holders();
  if (page_ != nullptr) report_peers();
}

void NetLink::report_peers() {
  for (std::size_t i = 0; i < kMaxTools; ++i) {
    const auto* const member = sessions_.holder(static_cast<std::uint8_t>(i));
    peers_[i] = member == nullptr
                    ? PeerCounts{}
                    : PeerCounts{true, member->endpoint, peers_[i].received, peers_[i].lost, peers_[i].ticks};
    page_->tools[i].peer.write(peers_[i]);
  }
}

void NetLink::note_holders() {
  for (std::size_t i = 0; i < tools.size(); ++i)
    tools[i].held = sessions_.holder(static_cast<std::uint8_t>(i)) != nullptr;
}

void NetLink::tool_is_free(std::uint8_t tool) {
  SessionInput nobody;
  nobody.state.tool = tool;
  mailboxes_.tools[tool].input.write(nobody);
}

const Endpoint& NetLink::own_towards(const Endpoint& peer) {
  if (peer != peer_) {
    own_ = socket_.local_towards(peer);
    peer_ = peer;
  }
  return own_;
}

void NetLink::send(protocol::ServerSessions::Member& member, const protocol::Message& message) {
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  send({bytes.data(), protocol::ServerSessions::write(member, message, bytes)}, member.endpoint,
       requested_[member.tool], true);
}

void NetLink::answer(const protocol::ServerSessions::Outcome& outcome, const Endpoint& to) {
  if (!outcome.answer) return;
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  const std::size_t size = protocol::encode(outcome.answer->first, outcome.answer->second, bytes);
  send({bytes.data(), protocol::seal(bytes, size, outcome.key)}, to, socket_.requested(),
       !is_to_a_stranger(outcome));
}

void NetLink::send(std::span<const std::byte> bytes, const Endpoint& to, const Endpoint& from, bool ours) {
  record(now(), to, Direction::kOut, bytes, ours);
  if (!socket_.send(bytes, to, from)) ++stats_.sent;
}

}  // namespace palpate::sim
