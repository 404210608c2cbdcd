#include "protocol/session.h"

#include <algorithm>

#include "protocol/earlier_ticks.h"

namespace palpate::protocol {

namespace {

std::size_t write_sealed(const Header& header, const Message& message, const Key& key,
                         std::span<std::byte> out) noexcept {
  return seal(out, encode(header, message, out), key);
}

bool checked(const Datagram& datagram, const Key& key, LinkStats& stats) noexcept {
  if (authentic(datagram.bytes, key)) return true;
  stats.reject(Verdict::kTag);
  return false;
}

KeyMismatch mismatch_of(const Datagram& datagram) noexcept {
  return is_tagged(datagram.bytes) ? KeyMismatch::kOtherKey : KeyMismatch::kNoTag;
}

}  // namespace

/// True if an answer to a Hello is of who has our key; else notes why not.
bool ClientSession::is_proven(const Datagram& datagram, LinkStats& stats) noexcept {
  if (checked(datagram, hello_keys_.in, stats)) return true;
  mismatch_ = mismatch_of(datagram);
  return false;
}

SessionKeys ClientSession::keys_for(const Nonce& server) const noexcept {
  return {direction_key(shared_, Direction::kToClient, nonce_, server),
          direction_key(shared_, Direction::kToServer, nonce_, server)};
}

std::optional<Hello> ClientSession::poll(Time now) noexcept {
  if (welcomed() && heard_lately(now)) return {};
  if (!prompted_) {
    if (last_hello_ && now - *last_hello_ < kHelloPeriod) return {};
    last_hello_ = now;
  }
  prompted_ = false;
  return Hello{nonce_, cookie_, ++attempts_};
}

std::size_t ClientSession::write(const Message& message, std::span<std::byte> out) noexcept {
  if (std::holds_alternative<Hello>(message)) return write_sealed({}, message, hello_keys_.out, out);
  return write_sealed(next_header(), message, current_.keys.out, out);
}

std::size_t ClientSession::write_ticks(std::span<const ToolState> ticks, std::span<std::byte> out) noexcept {
  const std::size_t size = encode_ticks({current_.session, current_.sent + 1}, ticks, out);
  if (size == 0) return 0;
  ++current_.sent;
  return seal(out, size, current_.keys.out);
}

/// True if it is the answer to one of the newest Hellos: an older one may be captured and sent again.
bool ClientSession::answers_lately(const Nonce& nonce, std::uint64_t attempt) const noexcept {
  return nonce == nonce_ && attempt <= attempts_ && attempt + kAnswered > attempts_;
}

/// Answered once for each Hello that was due, so that no two programs can keep each other busy.
void ClientSession::challenged(const Challenge& challenge, LinkStats& stats) noexcept {
  ++stats.received;
  cookie_ = challenge.cookie;
  prompted_ = prompted_in_period_ != last_hello_;
  prompted_in_period_ = last_hello_;
}

void ClientSession::welcomed_by(const Datagram& datagram, const Welcome& welcome, Time now,
                                LinkStats& stats) noexcept {
  // An older one, from a server that is gone; unless this one has been silent since.
  const bool another = datagram.header.session != current_.session;
  const bool fresh = welcome.attempt > welcomed_attempt_;  // else it may have been captured
  if (another && !fresh) return;
  if (datagram.header.session == departed_.session && heard_lately(now)) return;
  welcomed_attempt_ = std::max(welcomed_attempt_, welcome.attempt);
  if (!another && fresh &&
      !heard_lately(now)) {  // wild numbers may have moved the window ahead of the server
    current_.window.go_back_to(datagram.header.sequence);
    current_.samples = {};
  }
  last_heard_ = now;
  refused_.reset(), mismatch_.reset();
  if (another) {  // a new server, the first, or the one before
    std::swap(current_, departed_);
    if (current_.session != datagram.header.session)
      current_ = {.session = datagram.header.session, .keys = keys_for(welcome.server)};
    welcome_ = welcome;
  }
  current_.window.accept(datagram.header.sequence, stats);
}

/// Without a key only: with one, a server that knows the session no more cannot say so, and silence does.
void ClientSession::refused_by(const Datagram& datagram, const Refuse& refuse, LinkStats& stats) noexcept {
  if (answers_lately(refuse.nonce, refuse.attempt)) {
    if (is_proven(datagram, stats)) refused_ = refuse.reason;
  } else if (refuse.nonce == Nonce{} && !shared_ && welcomed() &&
             datagram.header.session == current_.session) {
    last_heard_.reset();  // forgotten there: ask at once
  } else {
    stats.reject(Verdict::kSession);
  }
}

const Message* ClientSession::receive(const Datagram& datagram, Time now, LinkStats& stats) noexcept {
  if (const auto* challenge = std::get_if<Challenge>(&datagram.message);
      challenge && answers_lately(challenge->nonce, challenge->attempt)) {
    if (is_proven(datagram, stats)) challenged(*challenge, stats);
    return nullptr;
  }
  if (const auto* welcome = std::get_if<Welcome>(&datagram.message);
      welcome && answers_lately(welcome->nonce, welcome->attempt)) {
    if (is_proven(datagram, stats)) welcomed_by(datagram, *welcome, now, stats);
    return nullptr;
  }
  if (const auto* refuse = std::get_if<Refuse>(&datagram.message)) {
    refused_by(datagram, *refuse, stats);
    return nullptr;
  }
  if (!welcomed() || datagram.header.session != current_.session) {
    stats.reject(Verdict::kSession);
    return nullptr;
  }
  if (!checked(datagram, current_.keys.in, stats)) return nullptr;
  if (const auto* sample = std::get_if<ForceSample>(&datagram.message);
      sample && sample->tool == welcome_.tool) {
    if (!current_.window.accept(datagram.header.sequence, stats) ||
        !current_.samples.accept(sample->number, datagram.header.sequence, current_.window.in_order(), stats))
      return nullptr;  // the newest value wins
    last_heard_ = now;
    return &datagram.message;
  }
  const auto* page = std::get_if<SurfacePage>(&datagram.message);
  const auto* pointer = std::get_if<Pointer>(&datagram.message);
  if ((page && page->tool == welcome_.tool) || (pointer && pointer->tool == welcome_.tool)) {
    if (!current_.window.accept(datagram.header.sequence, stats)) return nullptr;
    return page || current_.window.in_order() ? &datagram.message : nullptr;  // an older place is of no use
  }
  if (std::holds_alternative<Bye>(datagram.message)) {
    last_heard_.reset();
    return nullptr;
  }
  const bool of_server = std::holds_alternative<ForceSample>(datagram.message) || page || pointer;
  stats.reject(of_server ? Verdict::kTool : Verdict::kDirection);
  return nullptr;
}

ServerSessions::Member* ServerSessions::holder(std::uint8_t tool) noexcept {
  const auto found = std::ranges::find_if(members_, [&](const Member& m) { return m.tool == tool; });
  return found == members_.end() ? nullptr : &*found;
}

std::optional<std::uint8_t> ServerSessions::free_tool() noexcept {
  for (int tool = 0; tool < static_cast<int>(radii_.size()); ++tool) {
    if (holder(static_cast<std::uint8_t>(tool)) == nullptr) return static_cast<std::uint8_t>(tool);
  }
  return {};
}

/// The key by which a datagram says it is sealed; without keys the one that is none; null: we have no such.
const Key* ServerSessions::key_of(const Datagram& datagram) const noexcept {
  static constexpr Key kNone{};
  if (keys_.empty()) return &kNone;
  const auto found =
      std::ranges::find_if(keys_, [&](const Key& key) { return key.number == datagram.header.key; });
  return found == keys_.end() ? nullptr : &*found;
}

ServerSessions::Outcome ServerSessions::greet(const Datagram& datagram, const Hello& hello,
                                              const Endpoint& from, Time now, const Fresh& fresh,
                                              LinkStats& stats) {
  const Key* const shared = key_of(datagram);
  if (shared == nullptr ||
      !authentic(datagram.bytes, direction_key(*shared, Direction::kToServer, hello.nonce, {}))) {
    stats.reject(Verdict::kTag);
    return {.mismatch = mismatch_of(datagram)};
  }
  ++stats.received;
  Outcome outcome = cookies_.valid(hello.cookie, hello.nonce, from, now)
                        ? admit(hello, *shared, from, now, fresh)
                        : challenge(hello, from, now);
  outcome.key = direction_key(*shared, Direction::kToClient, hello.nonce, {});
  // It takes no answer without a tag.
  if (!*shared && is_tagged(datagram.bytes)) outcome.mismatch = KeyMismatch::kNotExpected;
  return outcome;
}

ServerSessions::Outcome ServerSessions::challenge(const Hello& hello, const Endpoint& from,
                                                  Time now) const noexcept {
  return {
      .answer = {{Header{}, Challenge{hello.nonce, hello.attempt, cookies_.make(hello.nonce, from, now)}}}};
}

/// True if a client speaks and none of its states is taken any more, as numbers that are not its own shut
/// them out. With keys a captured Hello, sent again while its client only stalls, does not count. Without
/// keys nothing tells one end from another, and a wild attempt would keep those of the client from counting.
bool ServerSessions::is_shut_out(const Member& member, const Hello& hello, Time now) const noexcept {
  const bool said_now = keys_.empty() || hello.attempt > member.attempt;
  return said_now && member.window.highest() > 0 && now - member.last_heard >= kUnheard;
}

/// Adds a member behind those that there are.
ServerSessions::Member& ServerSessions::join(const Hello& hello, const Key& shared, const Endpoint& from,
                                             std::uint8_t tool, Time now, const Fresh& fresh) {
  return members_.emplace_back(
      Member{.session = number_like(fresh.session),
             .key = shared.number,
             .nonce = hello.nonce,
             .server_nonce = fresh.nonce,
             .attempt = hello.attempt,
             .endpoint = from,  // the cookie was sent there
             .reached = from,
             .tool = tool,
             .last_heard = now,
             .keys = {direction_key(shared, Direction::kToServer, hello.nonce, fresh.nonce),
                      direction_key(shared, Direction::kToClient, hello.nonce, fresh.nonce)}});
}

/// A known client hears its Welcome again, and is not kept by that: only tool states keep a tool. One that is
/// shut out gets another session at once, so that nobody takes its tool in between.
ServerSessions::Outcome ServerSessions::admit(const Hello& hello, const Key& shared, const Endpoint& from,
                                              Time now, const Fresh& fresh) {
  const auto known = std::ranges::find_if(members_, [&](const Member& m) {
    return m.nonce == hello.nonce && m.key == shared.number && (m.endpoint == from || !keys_.empty());
  });
  Outcome outcome;
  Member* member = known == members_.end() ? nullptr : &*known;
  if (member != nullptr && is_shut_out(*member, hello, now)) {
    depart(known);
    outcome.departed = &departed_;
    member = &join(hello, shared, from, departed_.tool, now, fresh);
  } else if (member == nullptr) {
    const auto tool = free_tool();
    if (!tool) return {.answer = {{Header{}, Refuse{hello.nonce, hello.attempt, RefuseReason::kNoFreeTool}}}};
    member = &join(hello, shared, from, *tool, now, fresh);
  } else if (hello.attempt > member->attempt) {  // else it may have been captured
    member->attempt = hello.attempt;
    member->endpoint = member->reached = from;
  }
  outcome.answer = {Header{member->session, ++member->sent},
                    Welcome{hello.nonce, hello.attempt, member->server_nonce, member->tool, rate_hz_,
                            radii_[member->tool], scene_}};
  return outcome;
}

/// Without a key the answer is that the session is unknown here, with fewer bytes than the client sent.
ServerSessions::Outcome ServerSessions::unknown(const Datagram& datagram, LinkStats& stats) const {
  stats.reject(Verdict::kSession);
  if (!keys_.empty() || !std::holds_alternative<ToolState>(datagram.message)) return {};
  return {.answer = {{Header{datagram.header.session, 1}, Refuse{{}, 0, RefuseReason::kUnknownSession}}}};
}

/// That number, or the next odd one that no member has: it alone tells members with a key apart.
std::uint64_t ServerSessions::number_like(std::uint64_t session) const noexcept {
  const auto taken = [&](const Member& m) { return m.session == session; };
  while (std::ranges::any_of(members_, taken)) session += 2;
  return session;
}

/// Another endpoint only with a key.
void ServerSessions::Member::heard_from(const Endpoint& from, std::uint64_t newest_sample) noexcept {
  if (from != endpoint) {
    endpoint = from;
    probe = 0;
  } else if (probe != 0 && newest_sample >= probe && newest_sample <= newest_sent) {
    reached = from;  // beyond what was sent, it speaks of a server before this one
  }
}

std::size_t ServerSessions::write(Member& member, const Message& message, std::span<std::byte> out) noexcept {
  if (const auto* sample = std::get_if<ForceSample>(&message)) {
    if (member.probe == 0) member.probe = sample->number;
    member.newest_sent = std::max(member.newest_sent, sample->number);
  }
  return write_sealed({member.session, ++member.sent}, message, member.keys.out, out);
}

ServerSessions::Outcome ServerSessions::receive(const Datagram& datagram, const Endpoint& from, Time now,
                                                const Fresh& fresh, LinkStats& stats) {
  if (const auto* hello = std::get_if<Hello>(&datagram.message))
    return greet(datagram, *hello, from, now, fresh, stats);
  const auto found = std::ranges::find_if(members_, [&](const Member& m) {
    return m.session == datagram.header.session && (m.endpoint == from || !keys_.empty());
  });
  if (found == members_.end()) return unknown(datagram, stats);
  if (!checked(datagram, found->keys.in, stats)) return {};
  if (std::holds_alternative<Bye>(datagram.message)) {
    if (!found->window.accept(datagram.header.sequence, stats)) return {};
    depart(found);
    return {.departed = &departed_};
  }
  const auto* tool_state = std::get_if<ToolState>(&datagram.message);
  const auto* telemetry = std::get_if<Telemetry>(&datagram.message);
  if (tool_state == nullptr && telemetry == nullptr) {
    stats.reject(Verdict::kDirection);
    return {};
  }
  if ((tool_state != nullptr ? tool_state->tool : telemetry->tool) != found->tool) {
    stats.reject(Verdict::kTool);
    return {};
  }
  if (const Verdict verdict = decode_earlier(datagram); verdict != Verdict::kAccepted) {
    stats.reject(verdict);
    return {};
  }
  if (!found->window.accept(datagram.header.sequence, stats)) return {};
  if (telemetry != nullptr) return {.telemetry = telemetry};
  if (found->window.in_order()) found->heard_from(from, tool_state->newest_sample);
  const bool newer =
      found->ticks.accept(tool_state->tick, datagram.header.sequence, found->window.in_order(), stats);
  // A client that waits for its first tick says the same over and over.
  const bool again = found->window.in_order() && tool_state->tick == found->ticks.newest();
  if (newer || again) found->last_heard = now;
  if (!newer) return {.asking = tool_state};  // the newest value wins
  return {.tool_state = tool_state, .asking = tool_state};
}

void ServerSessions::depart(std::vector<Member>::iterator member) noexcept {
  departed_ = *member;
  members_.erase(member);
  spend_cookies();
}

/// With keys: a Hello of a session that is over, sent again by who captured it, takes no tool. Who is about
/// to join answers one Challenge more. Without keys a stranger could so keep others from joining.
void ServerSessions::spend_cookies() noexcept {
  if (!keys_.empty()) cookies_.renew();
}

std::vector<ServerSessions::Member> ServerSessions::expire(Time now) {
  std::vector<Member> expired;
  std::erase_if(members_, [&](const Member& m) {
    const bool silent = now - m.last_heard >= kTimeout;
    if (silent) expired.push_back(m);
    return silent;
  });
  if (!expired.empty()) spend_cookies();
  return expired;
}

}  // namespace palpate::protocol
