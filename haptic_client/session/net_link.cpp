#include "haptic_client/session/net_link.h"

#include "common/clock.h"

namespace palpate::client {
using protocol::Endpoint;
using protocol::Verdict;

NetLink::NetLink(protocol::UdpSocket& socket, const Endpoint& server, HapticMailboxes& mailboxes,
                 std::uint64_t nonce, protocol::Recorder* recorder)
    : socket_(socket),
      server_(server),
      own_(socket.local_towards(server)),
      recorder_(recorder),
      mailboxes_(mailboxes),
      session_(nonce) {}

void NetLink::run() {
  on_timer();
  socket_.run(mailboxes_.bell, std::chrono::milliseconds(50),
              {.on_datagram = [this](auto bytes, const Endpoint& from) { on_datagram(bytes, from); },
               .on_doorbell = [this] { on_tool_states(); },
               .on_timer = [this] { on_timer(); }});
  on_tool_states();  // of the last ticks, whose bell nobody answered
  if (session_.welcomed()) send(session_.next_header(), protocol::Bye{});
}

void NetLink::on_datagram(std::span<const std::byte> bytes, const Endpoint& from) {
  const Time t = now();
  if (recorder_ != nullptr) recorder_->note(t, from, own_, bytes);
  protocol::Datagram datagram;
  const Verdict verdict = from == server_ ? protocol::decode(bytes, datagram) : Verdict::kNotOurs;
  if (verdict != Verdict::kAccepted) {
    ++stats_.rejected;
    ++stats_.rejected_by[static_cast<std::size_t>(verdict)];
    return;
  }
  if (const protocol::Message* message = session_.receive(datagram, t, stats_)) {
    if (const auto* sample = std::get_if<protocol::ForceSample>(message)) mailboxes_.force.write(*sample);
    if (const auto* page = std::get_if<protocol::SurfacePage>(message)) mailboxes_.pages.push(*page);
  }
  welcomed = session_.welcomed();
  refused = session_.refused() ? static_cast<int>(*session_.refused()) : 0;
}

void NetLink::on_tool_states() {
  for (protocol::ToolState state; mailboxes_.tool.pop(state);) {
    if (!session_.welcomed()) continue;
    state.tool = session_.welcome().tool;
    send(session_.next_header(), state);
  }
}

void NetLink::on_timer() {
  if (const auto hello = session_.poll(now())) send({}, *hello);
}

void NetLink::send(const protocol::Header& header, const protocol::Message& message) {
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  const std::size_t size = protocol::encode(header, message, bytes);
  if (recorder_ != nullptr) recorder_->note(now(), own_, server_, {bytes.data(), size});
  if (const std::error_code failed = socket_.send({bytes.data(), size}, server_)) {
    unsendable = failed.value();
  } else {
    ++stats_.sent;
    unsendable = 0;
  }
}

}  // namespace palpate::client
