// Sessions with a key, as bytes over a network that anybody can write to.
#include <functional>
#include <vector>

#include "protocol/session.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

using Bytes = std::vector<std::byte>;

const Endpoint kClient{.address = {10, 0, 0, 1}, .port = 1000},
    kStranger{.address = {10, 0, 0, 9}, .port = 9};
const Key kKey{.number = 1, .bytes = {1, 2, 3}}, kNewer{.number = 2, .bytes = {4, 5, 6}},
    kWrong{.number = 1, .bytes = {1, 2, 4}};

/// Both ends, and all that passed between them.
struct Network {
  explicit Network(const Key& of_client = kKey, std::vector<Key> of_server = {kKey, kNewer})
      : client(Nonce{42}, of_client), server(30, {0.005}, {7}, std::move(of_server)) {}

  Bytes from_client(const Message& message) {
    Bytes bytes(kMaxDatagram);
    bytes.resize(client.write(message, bytes));
    up.push_back(bytes);
    return bytes;
  }
  Bytes from_server(const Message& message) {
    Bytes bytes(kMaxDatagram);
    bytes.resize(ServerSessions::write(*server.holder(0), message, bytes));
    down.push_back(bytes);
    return bytes;
  }
  /// Whether it reaches the simulation. What answers it goes to the client, if it asked.
  bool to_server(const Bytes& bytes, const Endpoint& from = kClient) {
    Datagram datagram;
    if (decode_fields(bytes, datagram) != Verdict::kAccepted) return false;
    const auto outcome = server.receive(datagram, from, now, {++fresh, {fresh, 1}}, server_stats);
    answered = outcome.answer.has_value();
    if (outcome.answer) {
      Bytes answer(kMaxDatagram);
      answer.resize(seal(answer, encode(outcome.answer->first, outcome.answer->second, answer), outcome.key));
      if (from == kClient) {
        down.push_back(answer);
        to_client(answer);
      }
    }
    return outcome.tool_state != nullptr;
  }
  /// Whether it reaches the haptic loop.
  bool to_client(const Bytes& bytes) {
    Datagram datagram;
    if (decode_fields(bytes, datagram) != Verdict::kAccepted) return false;
    return client.receive(datagram, now, client_stats) != nullptr;
  }
  bool shake_hands() {
    while (const auto hello = client.poll(now)) to_server(from_client(*hello));
    return client.welcomed();
  }
  Bytes state(std::uint64_t newest_sample = 0) {
    return from_client(ToolState{.tick = ++tick, .newest_sample = newest_sample});
  }
  Bytes sample() { return from_server(ForceSample{.number = ++number, .f_W = {0, 1, 0}}); }

  ClientSession client;
  ServerSessions server;
  LinkStats client_stats, server_stats;
  Time now = 100s;
  std::uint64_t fresh = 0, tick = 0, number = 0;
  bool answered = false;
  std::vector<Bytes> up, down;
};

}  // namespace

TEST_CASE("with a key: Hello, Challenge, Hello, Welcome, and values both ways") {
  Network n;
  REQUIRE(n.shake_hands());
  CHECK(n.up.size() == 2);
  CHECK(n.to_server(n.state()));
  CHECK(n.to_client(n.sample()));
  CHECK(n.server_stats.rejected == 0);
  CHECK(n.client_stats.rejected == 0);
}

TEST_CASE(
    "a client with the newest or an older key of the server is let in, one with another or none is not") {
  CHECK(Network(kNewer).shake_hands());
  CHECK(Network(kKey).shake_hands());
  for (const Key& key : {kWrong, Key{.number = 9, .bytes = kKey.bytes}, Key{}}) {
    Network n(key);
    CHECK_FALSE(n.shake_hands());
    CHECK_FALSE(n.answered);  // and hears nothing
    CHECK(n.server_stats.rejected_by[static_cast<std::size_t>(Verdict::kTag)] == 1);
  }
}

TEST_CASE("a client with a key obeys no server without") {
  Network n(kKey, {});
  CHECK_FALSE(n.shake_hands());
  CHECK(n.client_stats.rejected > 0);
}

TEST_CASE("what was captured is worth nothing: replayed, in another session, or in the other direction") {
  Network old;
  REQUIRE(old.shake_hands());
  for (int i = 0; i < 3; ++i) {
    REQUIRE(old.to_server(old.state()));
    REQUIRE(old.to_client(old.sample()));
  }
  Network n;
  n.client = ClientSession(Nonce{43}, kKey);
  n.fresh = 100;
  REQUIRE(n.shake_hands());
  const auto try_all = [&](const std::vector<Bytes>& datagrams) {
    for (const Bytes& bytes : datagrams) {
      CHECK_FALSE(n.to_client(bytes));
      for (const Endpoint& from : {kClient, kStranger}) CHECK_FALSE(n.to_server(bytes, from));
    }
  };
  try_all(old.up);
  try_all(old.down);
  REQUIRE(n.to_server(n.state()));
  REQUIRE(n.to_client(n.sample()));
  try_all(n.up);
  try_all(n.down);
  CHECK(n.server.holder(0)->endpoint == kClient);
  CHECK(n.to_server(n.state()));
  CHECK(n.to_client(n.sample()));
}

TEST_CASE("the same session number does not help: the keys are drawn from both nonces") {
  Network old, n;
  REQUIRE(old.shake_hands());
  const Bytes state = old.state();
  n.server = ServerSessions(30, {0.005}, {7}, {kKey});
  n.client = ClientSession(Nonce{43}, kKey);
  REQUIRE(n.shake_hands());
  REQUIRE(n.server.holder(0)->session == old.server.holder(0)->session);
  CHECK_FALSE(n.to_server(state));
  CHECK(n.server_stats.rejected_by[static_cast<std::size_t>(Verdict::kTag)] == 1);
}

TEST_CASE("no mutated datagram gets through, and what it says of numbers changes nothing") {
  Network n;
  REQUIRE(n.shake_hands());
  test::Random random(3);
  for (int i = 0; i < 20000; ++i) {
    for (Bytes bytes : {n.state(), n.sample()}) {
      bytes[random.bits() % bytes.size()] ^= std::byte{1} << (random.bits() % 8);
      REQUIRE_FALSE(n.to_server(bytes));
      REQUIRE_FALSE(n.to_client(bytes));
    }
    // All of these are lost, so every tenth goes through.
    if (i % 10 != 0) continue;
    REQUIRE(n.to_server(n.state()));
    REQUIRE(n.to_client(n.sample()));
  }
}

TEST_CASE("with a key a session goes on from another address at once, and without one it does not") {
  const Endpoint remote{.address = {10, 0, 0, 1}, .port = 1001};
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_server(n.state()));
  const Bytes late = n.state();
  CHECK(n.to_server(n.state(), remote));
  CHECK(n.server.holder(0)->endpoint == remote);
  CHECK_FALSE(n.to_server(late, kClient));  // overtaken: the answer goes where the newest came from
  CHECK(n.server.holder(0)->endpoint == remote);
  Network open(Key{}, {});
  REQUIRE(open.shake_hands());
  CHECK_FALSE(open.to_server(open.state(), remote));
  CHECK(open.server.holder(0)->endpoint == kClient);
}

TEST_CASE("states relayed from a forged address aim nothing large at it, whatever their client receives") {
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_server(n.state()));
  REQUIRE(n.to_client(n.sample()));
  CHECK(n.server.holder(0)->is_reached());  // by its cookie
  for (int round = 0; round < 5; ++round) {
    const std::uint64_t used = n.number;
    for (int i = 0; i < 20; ++i) {  // samples that the client misses: fewer than make it begin anew
      REQUIRE(n.to_server(n.state(used), kStranger));  // ahead of the client's own
      CHECK(n.server.holder(0)->endpoint == kStranger);
      CHECK_FALSE(n.server.holder(0)->is_reached());
      n.sample();  // to the forged address
    }
    REQUIRE(n.to_server(n.state(used)));
    CHECK(n.server.holder(0)->is_reached());  // as before: pages go on
    REQUIRE(n.to_client(n.sample()));         // of a number above all that went to the forged address
  }
}

TEST_CASE("a client that moved is reached once it has used a sample that was sent to its new address") {
  const Endpoint remote{.address = {10, 0, 0, 2}, .port = 1001};
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_server(n.state()));
  REQUIRE(n.to_client(n.sample()));
  const std::uint64_t used = n.number;
  const Bytes on_its_way = n.sample();  // to the address before
  REQUIRE(n.to_server(n.state(used), remote));
  CHECK_FALSE(n.server.holder(0)->is_reached());
  REQUIRE(n.to_client(on_its_way));
  REQUIRE(n.to_server(n.state(used + 1), remote));
  CHECK_FALSE(n.server.holder(0)->is_reached());
  REQUIRE(n.to_server(n.state(used + 1000), remote));  // a number of the server before this one
  CHECK_FALSE(n.server.holder(0)->is_reached());
  REQUIRE(n.to_client(n.sample()));
  REQUIRE(n.to_server(n.state(used + 1), remote));
  CHECK_FALSE(n.server.holder(0)->is_reached());
  REQUIRE(n.to_server(n.state(used + 2), remote));
  CHECK(n.server.holder(0)->is_reached());
  REQUIRE(n.to_server(n.state(used + 2), kClient));  // back: asked again, as it may be another by now
  CHECK_FALSE(n.server.holder(0)->is_reached());
}

TEST_CASE("ticks behind a state are read once its tag is known to be right") {
  Network n;
  REQUIRE(n.shake_hands());
  const auto with_no_ticks_behind = [&](const Key& key) {
    ToolState state{.tick = ++n.tick};
    state.flags = ToolState::kHasEarlierTicks;
    const ServerSessions::Member& member = *n.server.holder(0);
    Bytes bytes(kMaxDatagram);
    std::size_t size = encode({member.session, 1000 + n.tick}, state, bytes);
    bytes[size++] = std::byte{64};  // one more than there may be
    set_payload_size(bytes, size - kHeaderBytes);
    bytes.resize(seal(bytes, size, key));
    return bytes;
  };
  const auto rejected = [&](Verdict verdict) {
    return n.server_stats.rejected_by[static_cast<std::size_t>(verdict)];
  };
  CHECK_FALSE(n.to_server(with_no_ticks_behind(kWrong)));
  CHECK(rejected(Verdict::kTag) == 1);
  CHECK(rejected(Verdict::kValue) == 0);
  CHECK_FALSE(n.to_server(with_no_ticks_behind(n.server.holder(0)->keys.in)));
  CHECK(rejected(Verdict::kValue) == 1);
  CHECK(n.server_stats.implausible == 0);  // its sequence number counts for nothing
  CHECK(n.to_server(n.state()));
}

TEST_CASE(
    "a Hello from a forged address holds no tool, however often it is said, nor does one without states") {
  for (const bool keyed : {false, true}) {
    Network n(keyed ? kKey : Key{}, keyed ? std::vector{kKey} : std::vector<Key>{});
    const Bytes hello = n.from_client(*n.client.poll(n.now));
    for (int i = 0; i < 10; ++i) CHECK_FALSE(n.to_server(hello, kStranger));
    CHECK(n.server.members().empty());
    n.now += 250ms;
    REQUIRE(n.shake_hands());
    const Bytes with_cookie = n.up.back();
    for (int i = 0; i < 7; ++i) {
      n.now += 100ms;
      n.to_server(with_cookie);
      CHECK(n.server.expire(n.now).empty());
    }
    n.now += 100ms;
    CHECK(n.server.expire(n.now).size() == 1);
    n.to_server(with_cookie, kStranger);  // the cookie is of another address
    CHECK(n.server.members().empty());
    n.now += 20s;
    n.to_server(with_cookie);  // and of another time
    CHECK(n.server.members().empty());
  }
}

TEST_CASE("a server that was started again says nothing to a client with a key, and silence brings it back") {
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_client(n.sample()));
  n.server = ServerSessions(30, {0.005}, {8}, {kKey});
  n.to_server(n.state());
  CHECK_FALSE(n.answered);
  n.now += 300ms;
  REQUIRE(n.shake_hands());
  n.number = 0;
  CHECK(n.to_server(n.state()));
  CHECK(n.to_client(n.sample()));
}

TEST_CASE("two ends do not keep each other busy with Challenges: one Hello more in each 250 ms") {
  Network n;
  int hellos = 0;
  for (Time end = n.now + 1s; n.now < end; n.now += 1ms) {
    while (const auto hello = n.client.poll(n.now)) {
      ++hellos;
      const Challenge challenge{Nonce{42}, hello->attempt, Cookie{1}};
      Bytes bytes(kMaxDatagram);
      const Key key = direction_key(kKey, Direction::kToClient, Nonce{42}, {});
      bytes.resize(seal(bytes, encode({}, challenge, bytes), key));
      n.to_client(bytes);
    }
  }
  CHECK(hellos == 8);
}

TEST_CASE(
    "old Welcomes and samples of the same run, captured and sent again, do not bring back their session") {
  Network n;
  for (std::uint8_t server = 1; server <= 4; ++server) {  // each knows nothing of those before
    CAPTURE(server);
    n.server = ServerSessions(30, {0.005}, {server}, {kKey});
    n.number = 0;
    n.now += 1s;
    REQUIRE(n.shake_hands());
    REQUIRE(n.to_client(n.sample()));
    const std::vector<Bytes> captured = n.down;
    for (const Bytes& bytes : captured) CHECK_FALSE(n.to_client(bytes));
    n.now += 400ms;  // silent: it says Hello again
    const auto hello = n.client.poll(n.now);
    REQUIRE(hello);
    for (const Bytes& bytes : captured) CHECK_FALSE(n.to_client(bytes));
    CHECK(n.to_server(n.state()));
    CHECK(n.to_client(n.sample()));
  }
}

TEST_CASE("who has another key of the server and another client's nonce does not get that client's session") {
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_server(n.state()));
  Network other(kNewer);  // the same nonce, as it is read from the line
  other.server = n.server;
  other.fresh = 50;
  CHECK_FALSE(other.shake_hands());  // there is one tool, and it is held
  CHECK(other.server.members().size() == 1);
}

TEST_CASE("with a key a captured Hello takes no tool again after a Bye, or once its session has expired") {
  for (const bool bye : {true, false}) {
    CAPTURE(bye);
    Network n;
    REQUIRE(n.shake_hands());
    const std::vector<Bytes> hellos = n.up;
    n.to_server(n.state());
    if (bye) {
      n.to_server(n.from_client(Bye{}));
    } else {
      n.now += ServerSessions::kTimeout;
      REQUIRE(n.server.expire(n.now).size() == 1);
    }
    REQUIRE(n.server.members().empty());
    for (const Bytes& hello : hellos) n.to_server(hello);
    CHECK(n.server.members().empty());
    // Its client gets in as ever, in the same second.
    n.now += ClientSession::kSilence;
    n.shake_hands();
    CHECK(n.server.members().size() == 1);
  }
}

TEST_CASE("with a key a captured Hello ends no session whose client stalls, one that its client says does") {
  Network n;
  REQUIRE(n.shake_hands());
  const std::vector<Bytes> hellos = n.up;
  REQUIRE(n.to_server(n.state()));
  const std::uint64_t session = n.server.holder(0)->session;
  n.now += 600ms;
  for (const Bytes& hello : hellos) n.to_server(hello);
  REQUIRE(n.server.holder(0) != nullptr);
  CHECK(n.server.holder(0)->session == session);
  REQUIRE(n.to_server(n.state()));  // its client goes on where it was
  n.now += 600ms;
  REQUIRE(n.shake_hands());
  REQUIRE(n.server.members().size() == 1);
  const std::uint64_t next = n.server.holder(0)->session;
  CHECK(next != session);
  n.number = 0;
  CHECK(n.to_server(n.state()));
  CHECK(n.to_client(n.sample()));
  // What ended that session ends no other: its attempt is known, and its cookie spent.
  n.now += 600ms;
  for (const Bytes& bytes : std::vector(n.up)) n.to_server(bytes);
  CHECK(n.server.holder(0)->session == next);
}

TEST_CASE("with a key a second client does not get the tool of one that is shut out, at any moment") {
  const Time since = 5ms * GENERATE(range(0, 50));  // it asks each 250 ms from then on, after the first
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_server(n.state()));
  ClientSession waiting(Nonce{43}, kKey);
  LinkStats stats;
  const auto ask = [&] {
    if (n.now < 100s + since) return;
    while (const auto hello = waiting.poll(n.now)) {
      Bytes bytes(kMaxDatagram);
      bytes.resize(waiting.write(*hello, bytes));
      Datagram datagram;
      REQUIRE(decode_fields(bytes, datagram) == Verdict::kAccepted);
      const auto outcome = n.server.receive(datagram, kStranger, n.now, {900, {900, 1}}, n.server_stats);
      REQUIRE(outcome.answer);
      Bytes answer(kMaxDatagram);
      answer.resize(seal(answer, encode(outcome.answer->first, outcome.answer->second, answer), outcome.key));
      REQUIRE(decode_fields(answer, datagram) == Verdict::kAccepted);
      waiting.receive(datagram, n.now, stats);
    }
  };
  int sessions = 0;
  for (std::uint64_t last = 0; n.now < 100s + 799ms; n.now += 5ms) {  // no state arrives
    while (const auto hello = n.client.poll(n.now)) {
      n.to_server(n.from_client(*hello));
      ask();
    }
    ask();
    REQUIRE(n.server.holder(0) != nullptr);
    REQUIRE(n.server.holder(0)->nonce == Nonce{42});
    if (std::exchange(last, n.server.holder(0)->session) != n.server.holder(0)->session) ++sessions;
  }
  CHECK(sessions == 2);
  CHECK_FALSE(waiting.welcomed());
  CHECK(waiting.refused() == RefuseReason::kNoFreeTool);
}

TEST_CASE("with a key a captured Hello does not lead a session back to the address it was said from") {
  const Endpoint remote{.address = {10, 0, 0, 3}, .port = 1001};
  Network n;
  REQUIRE(n.shake_hands());
  REQUIRE(n.to_server(n.state()));
  REQUIRE(n.to_server(n.state(), remote));
  for (const Bytes& bytes : std::vector(n.up)) n.to_server(bytes, kClient);
  CHECK(n.server.holder(0)->endpoint == remote);
}

TEST_CASE("without a key those who leave keep nobody from joining") {
  ServerSessions server(30, {0.005, 0.005}, {7});
  LinkStats stats;
  Hello hello{.nonce = {5}};
  const auto challenge = server.receive({{}, hello}, kClient, 100s, {1}, stats);
  hello.cookie = std::get<Challenge>(challenge.answer->second).cookie;
  Hello other{.nonce = {6}};
  other.cookie =
      std::get<Challenge>(server.receive({{}, other}, kStranger, 100s, {2}, stats).answer->second).cookie;
  const auto joined = server.receive({{}, other}, kStranger, 100s, {2}, stats).answer;
  REQUIRE(std::holds_alternative<Welcome>(joined->second));
  server.receive({{joined->first.session, 1}, Bye{}}, kStranger, 100s, {}, stats);
  CHECK(
      std::holds_alternative<Welcome>(server.receive({{}, hello}, kClient, 100s, {3}, stats).answer->second));
}

TEST_CASE("both ends know why the other one's Hello or answer is not of their key") {
  const auto mismatches = [](const Key& of_client, const std::vector<Key>& of_server) {
    Network n(of_client, of_server);
    const auto hello = n.client.poll(n.now);
    const Bytes bytes = n.from_client(*hello);
    Datagram datagram;
    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
    const auto outcome = n.server.receive(datagram, kClient, n.now, {1}, n.server_stats);
    if (outcome.answer) n.to_server(bytes);  // its answer reaches the client
    return std::pair(n.client.mismatch(), outcome.mismatch);
  };
  using Pair = decltype(mismatches(kKey, {}));
  CHECK(mismatches(kKey, {kKey}) == Pair{});
  CHECK(mismatches({}, {}) == Pair{});
  CHECK(mismatches({}, {kKey}) == Pair{std::nullopt, KeyMismatch::kNoTag});
  CHECK(mismatches(kWrong, {kKey}) == Pair{std::nullopt, KeyMismatch::kOtherKey});
  CHECK(mismatches(kNewer, {kKey}) == Pair{std::nullopt, KeyMismatch::kOtherKey});
  CHECK(mismatches(kKey, {}) == Pair{KeyMismatch::kNoTag, KeyMismatch::kNotExpected});
}
