#include "sim_server/serving/net_link.h"

#include "common/clock.h"

namespace palpate::sim {
using protocol::Datagram;
using protocol::Endpoint;
using protocol::Verdict;

NetLink::NetLink(protocol::UdpSocket& socket, protocol::ServerSessions sessions,
                 std::vector<SurfacePager> pagers, SimMailboxes& mailboxes, std::uint64_t seed,
                 protocol::Recorder* recorder)
    : socket_(socket),
      recorder_(recorder),
      sessions_(std::move(sessions)),
      pagers_(std::move(pagers)),
      mailboxes_(mailboxes),
      random_(seed) {}

void NetLink::run() {
  socket_.run(mailboxes_.bell, std::chrono::milliseconds(50),
              {.on_datagram = [this](auto bytes, const Endpoint& from) { on_datagram(bytes, from); },
               .on_doorbell = [this] { on_forces(); },
               .on_timer = [this] { on_timer(); }});
  for (auto member : sessions_.members())
    send({member.session, ++member.sent}, protocol::Bye{}, member.endpoint);
}

void NetLink::on_datagram(std::span<const std::byte> bytes, const Endpoint& from) {
  const Time t = now();
  if (recorder_ != nullptr) recorder_->note(t, from, own_towards(from), bytes);
  Datagram datagram;
  if (const Verdict verdict = protocol::decode(bytes, datagram); verdict != Verdict::kAccepted) {
    ++stats_.rejected;
    ++stats_.rejected_by[static_cast<std::size_t>(verdict)];
    return;
  }
  const std::size_t before = sessions_.members().size();
  const auto outcome = sessions_.receive(datagram, from, t, random_() | 1, stats_);
  // A new member stands at the end.
  if (sessions_.members().size() > before) ++tools[sessions_.members().back().tool].so_far;
  note_holders();
  if (outcome.answer) send(outcome.answer->first, outcome.answer->second, from);
  if (outcome.left != nullptr) tool_is_free(outcome.left->tool);
  if (outcome.tool_state == nullptr) return;
  pass_on(datagram.header.session, *outcome.tool_state);
  send_pages(*outcome.tool_state);
}

/// To the simulation, with the path that led there in this session.
void NetLink::pass_on(std::uint64_t session, const protocol::ToolState& state) {
  SessionInput& input = inputs_[state.tool];
  if (input.session != session) input = {};
  input.session = session;
  input.state = state;
  if ((state.flags & protocol::ToolState::kDeviceLost) != 0) input.path = {};  // its pose is of long ago
  input.path.add(state);
  mailboxes_.tools[state.tool].input.write(input);
}

/// The pages it asks for, if they are of the surface that we have; what is lost will be asked for again.
void NetLink::send_pages(const protocol::ToolState& state) {
  SurfacePager& pager = pagers_[state.tool];
  if ((state.flags & protocol::ToolState::kAsksPages) == 0 || state.surface_version != pager.state().version)
    return;
  auto* const member = sessions_.holder(state.tool);
  protocol::SurfacePage page;
  for (const std::uint32_t number : state.pages) {
    if (pager.page(number, page)) send({member->session, ++member->sent}, page, member->endpoint);
  }
}

void NetLink::on_forces() {
  for (ToolMailboxes& mailboxes : mailboxes_.tools) {
    ForceOutput output;
    if (!mailboxes.force.read(output)) continue;
    auto* member = sessions_.holder(output.sample.tool);
    if (member == nullptr || member->session != output.session) continue;
    send({member->session, ++member->sent}, output.sample, member->endpoint);
  }
}

void NetLink::on_timer() {
  for (const auto& gone : sessions_.expire(now())) tool_is_free(gone.tool);
  note_holders();
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

void NetLink::send(const protocol::Header& header, const protocol::Message& message, const Endpoint& to) {
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  const std::size_t size = protocol::encode(header, message, bytes);
  if (recorder_ != nullptr) recorder_->note(now(), own_towards(to), to, {bytes.data(), size});
  if (!socket_.send({bytes.data(), size}, to)) ++stats_.sent;
}

}  // namespace palpate::sim
