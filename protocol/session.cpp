#include "protocol/session.h"

#include <algorithm>

namespace palpate::protocol {

std::optional<Hello> ClientSession::poll(Time now) noexcept {
  if ((welcomed() && heard_lately(now)) || (last_hello_ && now - *last_hello_ < kHelloPeriod)) return {};
  last_hello_ = now;
  return Hello{.nonce = nonce_};
}

const Message* ClientSession::receive(const Datagram& datagram, Time now, LinkStats& stats) noexcept {
  if (const auto* welcome = std::get_if<Welcome>(&datagram.message); welcome && welcome->nonce == nonce_) {
    // Late, from a server that is gone; unless this one has been silent since.
    if (datagram.header.session == left_.session && heard_lately(now)) return nullptr;
    last_heard_ = now;
    refused_.reset();
    if (datagram.header.session != current_.session) {  // a new server, the first, or the one before
      std::swap(current_, left_);
      if (current_.session != datagram.header.session) current_ = {.session = datagram.header.session};
      welcome_ = *welcome;
    }
    current_.window.accept(datagram.header.sequence, stats);
    return nullptr;
  }
  if (const auto* refuse = std::get_if<Refuse>(&datagram.message)) {
    const bool to_hello = refuse->nonce == nonce_,
               to_session = refuse->nonce == 0 && welcomed() && datagram.header.session == current_.session;
    if (to_hello) refused_ = refuse->reason;
    if (to_session) last_heard_.reset();  // forgotten there: ask at once
    if (!to_hello && !to_session) ++stats.rejected;
    return nullptr;
  }
  const bool mine = welcomed() && datagram.header.session == current_.session;
  if (const auto* sample = std::get_if<ForceSample>(&datagram.message);
      sample && mine && sample->tool == welcome_.tool) {
    if (!current_.window.accept(datagram.header.sequence, stats)) return nullptr;
    last_heard_ = now;
    return current_.samples.accept(sample->number, current_.window.in_order())
               ? &datagram.message
               : nullptr;  // the newest value wins
  }
  if (const auto* page = std::get_if<SurfacePage>(&datagram.message);
      page && mine && page->tool == welcome_.tool) {
    return current_.window.accept(datagram.header.sequence, stats) ? &datagram.message : nullptr;
  }
  if (std::holds_alternative<Bye>(datagram.message) && mine) {
    last_heard_.reset();
    return nullptr;
  }
  ++stats.rejected;
  return nullptr;
}

ServerSessions::Member* ServerSessions::holder(std::uint8_t tool) noexcept {
  const auto found =
      std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.tool == tool; });
  return found == members_.end() ? nullptr : &*found;
}

std::optional<std::uint8_t> ServerSessions::free_tool() noexcept {
  for (int tool = 0; tool < static_cast<int>(radii_.size()); ++tool) {
    if (holder(static_cast<std::uint8_t>(tool)) == nullptr) return static_cast<std::uint8_t>(tool);
  }
  return {};
}

ServerSessions::Outcome ServerSessions::admit(const Hello& hello, const Endpoint& from, Time now,
                                              std::uint64_t fresh_id, LinkStats& stats) {
  ++stats.received;
  auto member = std::find_if(members_.begin(), members_.end(),
                             [&](const Member& m) { return m.nonce == hello.nonce && m.endpoint == from; });
  if (member == members_.end()) {
    const auto tool = free_tool();
    if (!tool) return {.answer = {{Header{}, Refuse{hello.nonce, RefuseReason::kNoFreeTool}}}};
    member =
        members_.insert(member, {.session = fresh_id, .nonce = hello.nonce, .endpoint = from, .tool = *tool});
  }
  member->last_heard = now;
  return {.answer = {{Header{member->session, ++member->sent},
                      Welcome{hello.nonce, member->tool, rate_hz_, radii_[member->tool]}}}};
}

ServerSessions::Outcome ServerSessions::receive(const Datagram& datagram, const Endpoint& from, Time now,
                                                std::uint64_t fresh_id, LinkStats& stats) {
  if (const auto* hello = std::get_if<Hello>(&datagram.message))
    return admit(*hello, from, now, fresh_id, stats);
  const auto found = std::find_if(members_.begin(), members_.end(), [&](const Member& m) {
    return m.session == datagram.header.session && m.endpoint == from;
  });
  const auto* tool_state = std::get_if<ToolState>(&datagram.message);
  if (found == members_.end()) {
    ++stats.rejected;
    if (tool_state == nullptr) return {};
    return {.answer = {{Header{datagram.header.session, 1}, Refuse{0, RefuseReason::kUnknownSession}}}};
  }
  if (std::holds_alternative<Bye>(datagram.message)) {
    if (!found->window.accept(datagram.header.sequence, stats)) return {};
    left_ = *found;
    members_.erase(found);
    return {.left = &left_};
  }
  if (tool_state == nullptr || tool_state->tool != found->tool) {
    ++stats.rejected;
    return {};
  }
  if (!found->window.accept(datagram.header.sequence, stats)) return {};
  found->last_heard = now;
  if (!found->ticks.accept(tool_state->tick, found->window.in_order())) return {};  // the newest value wins
  return {.tool_state = tool_state};
}

std::vector<ServerSessions::Member> ServerSessions::expire(Time now) {
  std::vector<Member> gone;
  std::erase_if(members_, [&](const Member& m) {
    const bool silent = now - m.last_heard >= kTimeout;
    if (silent) gone.push_back(m);
    return silent;
  });
  return gone;
}

}  // namespace palpate::protocol
