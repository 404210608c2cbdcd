#include "haptic_client/session/net_link.h"

#include <utility>

#include "common/clock.h"
#include "protocol/earlier_ticks.h"

namespace palpate::client {
using protocol::Endpoint;
using protocol::Verdict;

namespace {
constexpr int kPatientTimers = 6;  // 300 ms; the server gives a tool up after 800 without a state
}

NetLink::NetLink(protocol::UdpSocket& socket, const Endpoint& server, HapticMailboxes& mailboxes,
                 const protocol::Key& key, protocol::Recorder* recorder)
    : socket_(socket),
      server_(server),
      own_(socket.local_towards(server)),
      recorder_(recorder),
      mailboxes_(mailboxes),
      session_(protocol::random_value<protocol::Nonce>(), key) {
  waiting_.reserve(protocol::kMostEarlierTicks + 1);
}

void NetLink::run() {
  on_timer();
  socket_.run(mailboxes_.bell, std::chrono::milliseconds(50),
              {.on_datagram = [this](auto bytes, const Endpoint& from) { on_datagram(bytes, from); },
               .on_doorbell = [this] { on_tool_states(); },
               .on_timer = [this] { on_timer(); }});
  on_tool_states();  // of the last ticks, whose bell nobody answered
  send_ticks(waiting_);
  if (session_.welcomed()) send(protocol::Bye{});
}

void NetLink::on_datagram(std::span<const std::byte> bytes, const Endpoint& from) {
  const Time t = now();
  const std::uint64_t received = stats_.received;
  protocol::Datagram datagram;
  const protocol::Message* message = nullptr;
  const Verdict verdict = from == server_ ? protocol::decode_fields(bytes, datagram) : Verdict::kNotOurs;
  if (verdict == Verdict::kAccepted) {
    message = session_.receive(datagram, t, stats_);
  } else {
    stats_.reject(verdict);
    if (const auto other = protocol::other_version(bytes); other && verdict == Verdict::kVersion)
      other_version = other->version;
  }
  if (recorder_ != nullptr) {
    if (stats_.received > received) {
      recorder_->note(t, from, own_, bytes);
    } else {
      recorder_->note_refused(t, from, own_, bytes);
    }
  }
  if (stats_.received > received) figures_.received(bytes.size(), socket_.arrived());
  if (message != nullptr) pass_on(*message, socket_.arrived());
  if (std::exchange(session_number_, session_.number()) != session_.number()) release();
  welcomed = session_.welcomed();
  refused = session_.refused() ? static_cast<int>(*session_.refused()) : 0;
  if (const auto mismatch = session_.mismatch()) key_mismatch = static_cast<int>(*mismatch);
  greet();
}

/// Another session begins, perhaps with another scene: what a page pressed in the one before is up.
void NetLink::release() {
  if (pointer_.buttons == 0) return;
  pointer_.buttons = 0;
  mailboxes_.pointer.write(pointer_);
}

void NetLink::pass_on(const protocol::Message& message, Time t) {
  if (const auto* sample = std::get_if<protocol::ForceSample>(&message)) {
    mailboxes_.force.write(*sample);
    figures_.sample(*sample, t);
    if (t.count() >= sample->tool_t_ns) pace_.sample(*sample, t - Time{sample->tool_t_ns}, t);
    mailboxes_.pages_hz.store(pace_.pages_hz(), std::memory_order_relaxed);
  }
  if (const auto* page = std::get_if<protocol::SurfacePage>(&message)) {
    mailboxes_.pages.push(*page);
    figures_.page();
  }
  if (const auto* pointer = std::get_if<protocol::Pointer>(&message)) {
    pointer_ = *pointer;
    mailboxes_.pointer.write(pointer_);
  }
}

void NetLink::on_tool_states() {
  for (protocol::ToolState state; mailboxes_.tool.pop(state); ticking_ = true) {
    if (!session_.welcomed()) continue;
    state.tool = session_.welcome().tool;
    state.flags |= protocol::ToolState::kRequestsUplink;
    pace_.shrink(state);
    if ((state.flags & protocol::ToolState::kAsksPages) != 0) figures_.requested_pages(Time{state.t_ns});
    if (!pace_.packs_ticks()) waiting_.clear();
    waiting_.push_back(state);
    const bool news = state.buttons != buttons_ || (state.flags & protocol::ToolState::kRearmed) != 0;
    buttons_ = state.buttons;
    const bool due = pace_.is_due(Time{state.t_ns}, session_.welcome().rate_hz);
    if (!due && !news && waiting_.size() <= protocol::kMostEarlierTicks) continue;
    send_ticks(waiting_);
    waiting_.clear();
  }
  for (protocol::Telemetry telemetry; mailboxes_.telemetry.pop(telemetry);) {
    if (!session_.welcomed() || !pace_.carries_telemetry(Time{telemetry.t_ns})) continue;
    telemetry.tool = session_.welcome().tool;
    send(telemetry);
  }
}

/// In two datagrams where one is too small.
void NetLink::send_ticks(std::span<const protocol::ToolState> ticks) {
  if (ticks.empty()) return;
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  if (const std::size_t size = session_.write_ticks(ticks, bytes); size > 0)
    return send(std::span(bytes).first(size));
  send_ticks(ticks.first(ticks.size() / 2));
  send_ticks(ticks.subspan(ticks.size() / 2));
}

/// A tool that waits long for others to be let in, before its first tick, is kept by states that say nothing
/// of a place.
void NetLink::on_timer() {
  watcher.note(stats_);
  level = pace_.level();
  drops_large = figures_.drops_large();
  greet();
  if (!session_.welcomed() || ticking_ || ++idle_timers_ < kPatientTimers) return;
  send(protocol::ToolState{.tool = session_.welcome().tool,
                           .tick = 1,
                           .t_ns = now().count(),
                           .flags = protocol::ToolState::kDeviceLost});
}

void NetLink::greet() {
  if (const auto hello = session_.poll(now())) send(*hello);
}

void NetLink::send(const protocol::Message& message) {
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  send(std::span(bytes).first(session_.write(message, bytes)));
}

void NetLink::send(std::span<const std::byte> bytes) {
  if (recorder_ != nullptr) recorder_->note(now(), own_, server_, bytes);
  if (const std::error_code failed = socket_.send(bytes, server_)) {
    unsendable = failed.value();
  } else {
    ++stats_.sent;
    figures_.sent(bytes.size());
    unsendable = 0;
  }
}

}  // namespace palpate::client
