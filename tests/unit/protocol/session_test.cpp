#include "protocol/session.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

const Endpoint kClient{.port = 1000}, kOther{.port = 2000};

/// Both ends joined by hand, in virtual time.
struct Pair {
  ClientSession client{42};
  ServerSessions server{1, 30, 0.005};
  LinkStats client_stats, server_stats;
  Time now = 10s;

  /// One Hello there and the answer back.
  void shake_hands(std::uint64_t fresh_id = 77) {
    const auto hello = client.poll(now);
    REQUIRE(hello);
    const auto outcome = server.receive({{}, *hello}, kClient, now, fresh_id, server_stats);
    REQUIRE(outcome.answer);
    client.receive({outcome.answer->first, outcome.answer->second}, now, client_stats);
  }
  ServerSessions::Outcome send_tool(std::uint64_t tick) {
    return server.receive(Datagram{client.next_header(), ToolState{.tick = tick}}, kClient, now, 0,
                          server_stats);
  }
  const ForceSample* send_force(std::uint64_t number, Datagram& datagram) {
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
  CHECK(pair.server.receive(tool, kClient, pair.now, 0, pair.server_stats).tool_state != nullptr);
  CHECK(pair.server.receive(tool, kClient, pair.now, 0, pair.server_stats).tool_state ==
        nullptr);  // a duplicate
  Datagram datagram;
  CHECK(pair.send_force(1, datagram) != nullptr);
  CHECK(pair.client.receive(datagram, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client_stats.duplicated == 1);
  CHECK(pair.client_stats.lost == 0);
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
  const auto hello = pair.client.poll(pair.now);
  pair.server.receive({{}, *hello}, kClient, pair.now, 77, pair.server_stats);  // the answer is lost
  pair.now += 250ms;
  pair.shake_hands(78);
  CHECK(pair.server.members().size() == 1);
  CHECK(pair.server.holder(0)->session == 77);
}

TEST_CASE("a second client is refused with the reason, and let in when the first is gone for 800 ms") {
  Pair pair;
  pair.shake_hands();
  const auto ask = [&] {
    return pair.server.receive({{}, Hello{.nonce = 9}}, kOther, pair.now, 99, pair.server_stats).answer;
  };
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
  pair.server = ServerSessions(1, 30, 0.005);
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

TEST_CASE("Bye frees the tool at once, strangers' datagrams are counted, not obeyed") {
  Pair pair;
  pair.shake_hands();
  const Header theirs{77, 1};
  CHECK(pair.server.receive({theirs, Bye{}}, kOther, pair.now, 0, pair.server_stats).left == nullptr);
  CHECK(pair.server.receive({{123, 1}, ToolState{.tick = 1}}, kClient, pair.now, 0, pair.server_stats)
            .tool_state == nullptr);
  CHECK(pair.server_stats.rejected == 2);
  const auto outcome =
      pair.server.receive({pair.client.next_header(), Bye{}}, kClient, pair.now, 0, pair.server_stats);
  CHECK(outcome.left != nullptr);
  CHECK(pair.server.members().empty());
  CHECK(pair.client.receive({{5, 1}, ForceSample{.number = 1}}, pair.now, pair.client_stats) == nullptr);
  CHECK(pair.client_stats.rejected == 1);
}

TEST_CASE("a late Welcome of a session that was left does not bring it back") {
  Pair pair;
  const auto hello = pair.client.poll(pair.now);
  const auto first = pair.server.receive({{}, *hello}, kClient, pair.now, 77, pair.server_stats);
  pair.client.receive({first.answer->first, first.answer->second}, pair.now, pair.client_stats);
  pair.server = ServerSessions(1, 30, 0.005);  // restarted
  pair.now += 400ms;
  pair.shake_hands(88);
  pair.client.receive({first.answer->first, first.answer->second}, pair.now, pair.client_stats);
  CHECK(pair.send_tool(1).tool_state != nullptr);
}
