#include "protocol/session.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

const Endpoint kClient{.port = 1000}, kOther{.port = 2000};

/// All Hellos that are due, and what answers them. Returns the last answer, if there was a Hello.
std::optional<Message> greet(ServerSessions& server, ClientSession& client, const Endpoint& from, Time now,
                             std::uint64_t fresh_id, LinkStats& server_stats, LinkStats& client_stats) {
  std::optional<Message> last;
  while (const auto hello = client.poll(now)) {
    const auto outcome = server.receive({{}, *hello}, from, now, {fresh_id}, server_stats);
    REQUIRE(outcome.answer);
    client.receive({outcome.answer->first, outcome.answer->second}, now, client_stats);
    last = outcome.answer->second;
  }
  return last;
}

/// Says Hello with the cookie that a server gives to `from`, and returns its answer.
ServerSessions::Outcome greet_as(std::uint64_t nonce, ServerSessions& server, const Endpoint& from, Time now,
                                 std::uint64_t fresh_id, LinkStats& stats) {
  Hello hello{.nonce = {nonce}};
  const auto first = server.receive({{}, hello}, from, now, {fresh_id}, stats);
  REQUIRE(first.answer);
  hello.cookie = std::get<Challenge>(first.answer->second).cookie;
  return server.receive({{}, hello}, from, now, {fresh_id}, stats);
}

/// Both ends joined by hand, in virtual time.
struct Pair {
  ClientSession client{Nonce{42}};
  ServerSessions server{30, {0.005}};
  LinkStats client_stats, server_stats;
  Time now = 10s;

  /// A Hello there and the answer back, where a cookie is wanted once more.
  void shake_hands(std::uint64_t fresh_id = 77) {
    REQUIRE(greet(server, client, kClient, now, fresh_id, server_stats, client_stats));
  }
  ServerSessions::Outcome send_tool(std::uint64_t tick) {
    return server.receive(Datagram{client.next_header(), ToolState{.tick = tick}}, kClient, now, {},
                          server_stats);
  }
  const Message* send_force(std::uint64_t number, Datagram& datagram) {
    auto* member = server.holder(0);
    datagram = {{member->session, ++member->sent}, ForceSample{.number = number}};
    return client.receive(datagram, now, client_stats);
  }
};

}  // namespace

TEST_CASE("Hello, Welcome, tool states and forces") {
  Pair pair;
  CHECK_FALSE(pair.client.welcomed());
  pair.shake_hands();
  CHECK(pair.client.welcomed());
  CHECK(pair.client.welcome().tool_radius == 0.005);
  const Datagram tool{pair.client.next_header(), ToolState{.tick = 1}};
  CHECK(pair.server.receive(tool, kClient, pair.now, {}, pair.server_stats).tool_state != nullptr);
  CHECK(pair.server.receive(tool, kClient, pair.now, {}, pair.server_stats).tool_state ==
        nullptr);  // a duplicate
  Datagram datagram;
  CHECK(pair.send_force(1, datagram) != nullptr);
  CHECK(pair.client.receive(datagram, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client_stats.duplicated == 1);
  CHECK(pair.client_stats.lost == 0);
}

TEST_CASE("each Welcome of a server tells of which scene it is, once the server knows it") {
  const ScenePrint scene{.mesh = 1, .material = 2, .supports = 3, .tools = 4};
  ServerSessions server(30, {0.005, 0.005});
  LinkStats stats;
  const auto welcome_of = [&](std::uint64_t nonce) {
    const auto outcome = greet_as(nonce, server, kClient, 10s, nonce, stats);
    REQUIRE(outcome.answer);
    return std::get<Welcome>(outcome.answer->second);
  };
  CHECK(welcome_of(1).scene == ScenePrint{});
  server.set_scene(scene);
  for (const std::uint64_t nonce : {1, 2}) CHECK(welcome_of(nonce).scene == scene);
}

TEST_CASE("the client asks every 250 ms until welcomed, and again after 300 ms of silence") {
  Pair pair;
  CHECK(pair.client.poll(pair.now));
  CHECK_FALSE(pair.client.poll(pair.now + 249ms));
  CHECK(pair.client.poll(pair.now + 250ms));
  pair.now += 500ms;
  pair.shake_hands();
  CHECK_FALSE(pair.client.poll(pair.now + 299ms));
  CHECK(pair.client.poll(pair.now + 300ms));
}

TEST_CASE("a lost Welcome: the same client asking again gets the same session") {
  Pair pair;
  const auto challenge =
      pair.server.receive({{}, *pair.client.poll(pair.now)}, kClient, pair.now, {77}, pair.server_stats);
  pair.client.receive({challenge.answer->first, challenge.answer->second}, pair.now, pair.client_stats);
  pair.server.receive({{}, *pair.client.poll(pair.now)}, kClient, pair.now, {77},
                      pair.server_stats);  // the answer is lost
  pair.now += 250ms;
  pair.shake_hands(78);
  CHECK(pair.server.members().size() == 1);
  CHECK(pair.server.holder(0)->session == 77);
}

TEST_CASE(
    "a client whose states are shut out by wild numbers gets another session by its Hello after 400 ms") {
  Pair pair;
  pair.shake_hands();
  REQUIRE(pair.send_tool(1).tool_state != nullptr);
  // Four in a row begin anew there, and the client is far behind.
  for (std::uint64_t i = 0; i < 4; ++i)
    pair.server.receive({{77, (std::uint64_t{1} << 62) + i}, ToolState{.tick = 100 + i}}, kClient, pair.now,
                        {}, pair.server_stats);
  REQUIRE(pair.send_tool(2).tool_state == nullptr);
  pair.now += 399ms;
  pair.shake_hands(78);
  CHECK(pair.server.holder(0)->session == 77);
  REQUIRE(pair.send_tool(3).tool_state == nullptr);
  pair.now += 1ms;
  const Hello hello{{42}, {}, 9};
  const auto challenge = pair.server.receive({{}, hello}, kClient, pair.now, {79}, pair.server_stats);
  const Hello again{{42}, std::get<Challenge>(challenge.answer->second).cookie, 10};
  const auto outcome = pair.server.receive({{}, again}, kClient, pair.now, {79}, pair.server_stats);
  REQUIRE(outcome.departed != nullptr);
  CHECK(outcome.departed->session == 77);
  CHECK(std::holds_alternative<Welcome>(outcome.answer->second));
  REQUIRE(pair.server.members().size() == 1);
  CHECK(pair.server.holder(0)->session == 79);
  // The Welcome is lost: the next is of the same session.
  pair.now += 300ms;
  pair.shake_hands(80);
  CHECK(pair.server.holder(0)->session == 79);
  CHECK(pair.send_tool(4).tool_state != nullptr);
}

TEST_CASE("without a key a Hello of a wild attempt does not keep those of its client from counting") {
  Pair pair;
  pair.shake_hands();
  REQUIRE(pair.send_tool(1).tool_state != nullptr);
  const auto say = [&](std::uint64_t attempt, std::uint64_t fresh_id) {
    Hello hello{{42}, {}, attempt};
    const auto challenge = pair.server.receive({{}, hello}, kClient, pair.now, {}, pair.server_stats);
    hello.cookie = std::get<Challenge>(challenge.answer->second).cookie;
    return pair.server.receive({{}, hello}, kClient, pair.now, {fresh_id}, pair.server_stats).departed;
  };
  CHECK(say(std::uint64_t{1} << 63, 78) == nullptr);
  pair.now += 400ms;
  CHECK(say(3, 79) != nullptr);
  CHECK(pair.server.holder(0)->session == 79);
}

TEST_CASE("a client that is shut out keeps its tool, also where one before it is free") {
  ServerSessions server(30, {0.005, 0.004});
  LinkStats stats;
  greet_as(1, server, kOther, 10s, 71, stats);
  REQUIRE(std::get<Welcome>(greet_as(2, server, kClient, 10s, 72, stats).answer->second).tool == 1);
  server.receive({{72, 1}, ToolState{.tool = 1, .tick = 1}}, kClient, 10s, {}, stats);
  server.receive({{71, 1}, Bye{}}, kOther, 10s, {}, stats);
  const auto outcome = greet_as(2, server, kClient, 10s + 400ms, 73, stats);
  REQUIRE(outcome.departed != nullptr);
  CHECK(outcome.departed->session == 72);
  CHECK(std::get<Welcome>(outcome.answer->second).tool == 1);
  CHECK(server.holder(1)->session == 73);
}

TEST_CASE("a second client is refused with the reason, and let in when the first is gone for 800 ms") {
  Pair pair;
  pair.shake_hands();
  const auto ask = [&] { return greet_as(9, pair.server, kOther, pair.now, 99, pair.server_stats).answer; };
  auto answer = ask();
  REQUIRE(answer);
  CHECK(std::get<Refuse>(answer->second).reason == RefuseReason::kNoFreeTool);
  pair.now += 799ms;
  CHECK(pair.server.expire(pair.now).empty());
  pair.now += 1ms;
  CHECK(pair.server.expire(pair.now).size() == 1);
  answer = ask();
  REQUIRE(answer);
  CHECK(std::holds_alternative<Welcome>(answer->second));
}

TEST_CASE("a restarted server does not know the session, says so, and welcomes afresh") {
  Pair pair;
  pair.shake_hands();
  Datagram datagram;
  REQUIRE(pair.send_force(5, datagram) != nullptr);
  pair.server = ServerSessions(30, {0.005});
  const auto outcome = pair.send_tool(1);
  REQUIRE(outcome.answer);
  CHECK(std::get<Refuse>(outcome.answer->second).reason == RefuseReason::kUnknownSession);
  pair.now += 250ms;
  pair.client.receive({outcome.answer->first, outcome.answer->second}, pair.now, pair.client_stats);
  pair.shake_hands(88);  // asks at once
  CHECK(pair.send_tool(2).tool_state != nullptr);
  CHECK(pair.send_force(1, datagram) != nullptr);  // numbers begin again
}

TEST_CASE("overtaken values are dropped: the newest wins") {
  Pair pair;
  pair.shake_hands();
  Datagram newer, older;
  auto* member = pair.server.holder(0);
  older = {{member->session, ++member->sent}, ForceSample{.number = 1}};
  newer = {{member->session, ++member->sent}, ForceSample{.number = 2}};
  CHECK(pair.client.receive(newer, pair.now, pair.client_stats) != nullptr);
  CHECK(pair.client.receive(older, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client_stats.reordered == 1);
}

TEST_CASE("pages are wanted still when a newer state overtook the one that asks for them, but once") {
  Pair pair;
  pair.shake_hands();
  const Datagram asks{pair.client.next_header(), ToolState{.tick = 1, .flags = ToolState::kAsksPages}};
  pair.send_tool(2);
  const auto late = pair.server.receive(asks, kClient, pair.now, {}, pair.server_stats);
  CHECK(late.tool_state == nullptr);
  REQUIRE(late.asking != nullptr);
  CHECK(late.asking->flags == ToolState::kAsksPages);
  CHECK(pair.server.receive(asks, kClient, pair.now, {}, pair.server_stats).asking == nullptr);
}

TEST_CASE("a value that only other kinds of datagrams overtook is the newest still") {
  Pair pair;
  pair.shake_hands();
  auto* member = pair.server.holder(0);
  const Datagram sample{{member->session, ++member->sent}, ForceSample{.number = 5}};
  const Datagram pointer{{member->session, ++member->sent}, Pointer{.number = 1}};
  CHECK(pair.client.receive(pointer, pair.now, pair.client_stats) != nullptr);
  CHECK(pair.client.receive(sample, pair.now, pair.client_stats) != nullptr);
  CHECK(pair.client_stats.overtaken == 0);
  const Datagram state{pair.client.next_header(), ToolState{.tick = 1}};
  const Datagram telemetry{pair.client.next_header(), Telemetry{}};
  CHECK(pair.server.receive(telemetry, kClient, pair.now, {}, pair.server_stats).telemetry != nullptr);
  CHECK(pair.server.receive(state, kClient, pair.now, {}, pair.server_stats).tool_state != nullptr);
  CHECK(pair.server_stats.overtaken == 0);
  CHECK(pair.server_stats.lost == 0);
}

TEST_CASE("a pointer that another one overtook, or of another tool, moves nothing") {
  Pair pair;
  pair.shake_hands();
  auto* member = pair.server.holder(0);
  const Datagram older{{member->session, ++member->sent}, Pointer{.number = 1}};
  const Datagram newer{{member->session, ++member->sent}, Pointer{.number = 2}};
  CHECK(pair.client.receive(newer, pair.now, pair.client_stats) != nullptr);
  CHECK(pair.client.receive(older, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client.receive(newer, pair.now, pair.client_stats) == nullptr);
  const Datagram others{{member->session, ++member->sent}, Pointer{.tool = 1, .number = 3}};
  CHECK(pair.client.receive(others, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client_stats.rejected_by[static_cast<std::size_t>(Verdict::kTool)] == 1);
}

TEST_CASE("telemetry keeps no tool, and counts once") {
  Pair pair;
  pair.shake_hands();
  for (int i = 0; i < 10; ++i) {
    pair.now += 100ms;
    const Datagram telemetry{pair.client.next_header(), Telemetry{}};
    const auto outcome = pair.server.receive(telemetry, kClient, pair.now, {}, pair.server_stats);
    CHECK((outcome.telemetry != nullptr) == (i < 8));
    CHECK(pair.server.receive(telemetry, kClient, pair.now, {}, pair.server_stats).telemetry == nullptr);
    CHECK(pair.server.expire(pair.now).size() == (i == 7 ? 1U : 0U));
  }
  Pair other;
  other.shake_hands();
  const Datagram of_another{other.client.next_header(), Telemetry{.tool = 1}};
  CHECK(other.server.receive(of_another, kClient, other.now, {}, other.server_stats).telemetry == nullptr);
  CHECK(other.server_stats.rejected_by[static_cast<std::size_t>(Verdict::kTool)] == 1);
}

TEST_CASE("Bye frees the tool at once, strangers' datagrams are counted, not obeyed") {
  Pair pair;
  pair.shake_hands();
  const Header theirs{77, 1};
  CHECK(pair.server.receive({theirs, Bye{}}, kOther, pair.now, {}, pair.server_stats).departed == nullptr);
  CHECK(pair.server.receive({{123, 1}, ToolState{.tick = 1}}, kClient, pair.now, {}, pair.server_stats)
            .tool_state == nullptr);
  CHECK(pair.server_stats.rejected == 2);
  const auto outcome =
      pair.server.receive({pair.client.next_header(), Bye{}}, kClient, pair.now, {}, pair.server_stats);
  CHECK(outcome.departed != nullptr);
  CHECK(pair.server.members().empty());
  CHECK(pair.client.receive({{5, 1}, ForceSample{.number = 1}}, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client_stats.rejected == 1);
}

TEST_CASE("a late Welcome of a session that was left does not bring it back") {
  Pair pair;
  pair.shake_hands(77);
  const Header header{77, pair.server.holder(0)->sent};
  const Welcome welcome = pair.client.welcome();
  pair.server = ServerSessions(30, {0.005});  // restarted
  pair.now += 400ms;
  pair.shake_hands(88);
  pair.client.receive({header, welcome}, pair.now, pair.client_stats);
  CHECK(pair.send_tool(1).tool_state != nullptr);
}

TEST_CASE("two clients whose sessions draw one number are two, from one address and with one key, too") {
  const Key key = GENERATE(Key{}, Key{.number = 1, .bytes = {3}});
  ServerSessions server(30, {0.005, 0.004}, {}, key ? std::vector<Key>{key} : std::vector<Key>{});
  ClientSession first(Nonce{1}, key), second(Nonce{2}, key);
  LinkStats stats;
  const auto decoded = [](std::span<const std::byte> bytes) {
    Datagram datagram;
    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
    return datagram;
  };
  std::array<std::byte, kMaxDatagram> bytes, answer;
  for (ClientSession* client : {&first, &second}) {
    while (const auto hello = client->poll(10s)) {
      const Datagram said = decoded({bytes.data(), client->write(*hello, bytes)});
      const auto outcome = server.receive(said, kClient, 10s, {77, {5}}, stats);
      REQUIRE(outcome.answer);
      const std::size_t size = encode(outcome.answer->first, outcome.answer->second, answer);
      client->receive(decoded({answer.data(), seal(answer, size, outcome.key)}), 10s, stats);
    }
    REQUIRE(client->welcomed());
  }
  std::uint8_t tool = 0;
  for (ClientSession* client : {&first, &second}) {
    const Datagram said = decoded({bytes.data(), client->write(ToolState{.tool = tool, .tick = 1}, bytes)});
    const auto outcome = server.receive(said, kClient, 10s, {}, stats);
    REQUIRE(outcome.tool_state != nullptr);
    CHECK(outcome.tool_state->tool == tool++);
  }
}

TEST_CASE("two sessions from one address hold a tool each, with its radius, apart from each other") {
  ServerSessions server(30, {0.005, 0.003});
  ClientSession left(Nonce{1}), right(Nonce{2});
  LinkStats of_left, of_right, stats;
  Time now = 10s;
  const auto join = [&](ClientSession& client, LinkStats& of_client, std::uint64_t id) {
    REQUIRE(greet(server, client, kClient, now, id, stats, of_client));
  };
  join(left, of_left, 77);
  join(right, of_right, 88);
  CHECK(server.members().size() == 2);
  CHECK(left.welcome().tool == 0);
  CHECK(left.welcome().tool_radius == 0.005);
  CHECK(right.welcome().tool == 1);
  CHECK(right.welcome().tool_radius == 0.003);
  // A third device there is refused; asking again with a known nonce is not.
  const auto third = greet_as(3, server, kClient, now, 99, stats);
  CHECK(std::get<Refuse>(third.answer->second).reason == RefuseReason::kNoFreeTool);
  now += 400ms;
  join(right, of_right, 111);
  CHECK(server.holder(1)->session == 88);

  // Sequences and ticks are each session's own, and nobody speaks for the other's tool.
  for (ClientSession* client : {&left, &right}) {
    const ToolState state{.tool = client->welcome().tool, .tick = 1};
    CHECK(server.receive({client->next_header(), state}, kClient, now, {}, stats).tool_state != nullptr);
  }
  CHECK(server.receive({left.next_header(), ToolState{.tool = 1, .tick = 2}}, kClient, now, {}, stats)
            .tool_state == nullptr);
  CHECK(stats.rejected == 1);

  // One leaves: the other stays, and the free tool goes to who asks next.
  const auto outcome = server.receive({left.next_header(), Bye{}}, kClient, now, {}, stats);
  REQUIRE(outcome.departed != nullptr);
  CHECK(outcome.departed->tool == 0);
  CHECK(server.holder(1)->session == 88);
  CHECK(server.receive({right.next_header(), ToolState{.tool = 1, .tick = 2}}, kClient, now, {}, stats)
            .tool_state != nullptr);
  const auto next = greet_as(3, server, kClient, now, 99, stats);
  CHECK(std::get<Welcome>(next.answer->second).tool == 0);

  // One falls silent: only that one is given up.
  now += 799ms;
  server.receive({right.next_header(), ToolState{.tool = 1, .tick = 3}}, kClient, now, {}, stats);
  now += 1ms;
  const auto expired = server.expire(now);
  REQUIRE(expired.size() == 1);
  CHECK(expired[0].tool == 0);
  CHECK(server.holder(1) != nullptr);
}

TEST_CASE(
    "pages of the surface reach the client that holds the tool, each once, in whatever order they come") {
  Pair pair;
  pair.shake_hands();
  auto* member = pair.server.holder(0);
  const auto page = [&](std::uint64_t sequence, std::uint8_t tool) {
    return Datagram{{member->session, sequence}, SurfacePage{.tool = tool, .version = 1, .page = 3}};
  };
  const auto reaches = [&](const Datagram& datagram) {
    return pair.client.receive(datagram, pair.now, pair.client_stats) != nullptr;
  };
  CHECK(reaches(page(member->sent + 2, 0)));
  CHECK(reaches(page(member->sent + 1, 0)));
  CHECK_FALSE(reaches(page(member->sent + 1, 0)));
  CHECK(pair.client_stats.duplicated == 1);
  CHECK(pair.client_stats.reordered == 1);
  CHECK_FALSE(reaches(page(member->sent + 3, 1)));
  CHECK(pair.client_stats.rejected == 1);
  CHECK_FALSE(reaches({{member->session + 1, 1}, SurfacePage{.version = 1}}));
}
