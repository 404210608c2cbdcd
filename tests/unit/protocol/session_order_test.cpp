// Whatever happened, in whatever order: once the network is good again, values pass both ways within 1.1 s.
#include <deque>
#include <functional>
#include <random>

#include "protocol/session.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

constexpr Time kTick = 10ms, kSample = 30ms, kHealed = 1100ms, kPollPeriod = 200ms;
constexpr std::uint64_t kUnbounded = std::uint64_t{1} << 62;
const Endpoint kClient{.port = 1000};

/// Both ends and what happens between them, in virtual time, a tick of the client every 10 ms.
struct World {
  ClientSession client{Nonce{42}};
  ServerSessions server{30, {0.005}};
  LinkStats client_stats, server_stats;
  Time now = 10s;
  std::uint64_t tick = 0, sample = 0, fresh = 100, attempts = 0;
  int states_passed = 0, samples_passed = 0;  // since `count`
  std::optional<Datagram> first_welcome, old_state, old_sample;

  void to_client(const Datagram& datagram) {
    const Message* message = client.receive(datagram, now, client_stats);
    samples_passed += message != nullptr && std::holds_alternative<ForceSample>(*message) ? 1 : 0;
  }
  void to_server(const Datagram& datagram, bool answers_arrive = true) {
    const auto outcome = server.receive(datagram, kClient, now, {++fresh}, server_stats);
    states_passed += outcome.tool_state != nullptr ? 1 : 0;
    if (!outcome.answer || !answers_arrive) return;
    const Datagram answer{outcome.answer->first, outcome.answer->second};
    if (!first_welcome && std::holds_alternative<Welcome>(answer.message)) first_welcome = answer;
    to_client(answer);
  }
  /// Time goes on; what a side sends arrives or is lost.
  void pass(Time span, bool up = true, bool down = true) {
    for (Time end = now + span; now < end; now += kTick) {
      ++tick;
      while (const auto hello = client.poll(now)) {
        attempts = hello->attempt;
        if (up) to_server({{}, *hello}, down);
      }
      if (client.welcomed()) {
        const Datagram state{client.next_header(), ToolState{.tick = tick}};
        if (!old_state) old_state = state;
        if (up) to_server(state, down);
      }
      server.expire(now);
      auto* const member = server.holder(0);
      if (member == nullptr || now.count() % kSample.count() != 0) continue;
      const Datagram force{{member->session, ++member->sent}, ForceSample{.number = ++sample}};
      if (!old_sample) old_sample = force;
      if (down) to_client(force);
    }
  }
  std::uint64_t session() { return server.holder(0) != nullptr ? server.holder(0)->session : 0; }
  std::uint64_t of_client() { return client.next_header().session; }
  std::uint64_t sent() { return server.holder(0) != nullptr ? server.holder(0)->sent : 0; }
};

struct Event {
  const char* name;
  std::function<void(World&)> happen;
};

/// `number`: of a sample or tick, or of the datagram itself.
std::vector<Event> events() {
  std::vector<Event> all{
      {"0.1 s goes by", [](World& w) { w.pass(100ms); }},
      {"nothing arrives at the server for 0.4 s", [](World& w) { w.pass(400ms, false, true); }},
      {"nothing arrives at the client for 0.4 s", [](World& w) { w.pass(400ms, true, false); }},
      {"nothing arrives for 0.9 s", [](World& w) { w.pass(900ms, false, false); }},
      {"the server starts again",
       [](World& w) {
         w.server = ServerSessions(30, {0.005});
         w.sample = 0;
       }},
      {"the client is told that its session is unknown",
       [](World& w) {
         w.to_client({{w.of_client(), 1}, Refuse{{}, 0, RefuseReason::kUnknownSession}});
       }},
      {"a Bye to the client",
       [](World& w) {
         w.to_client({{w.of_client(), w.sent() + 1}, Bye{}});
       }},
      {"a Bye to the server",
       [](World& w) {
         w.to_server({w.client.next_header(), Bye{}});
       }},
      {"the first Welcome once more",
       [](World& w) {
         if (w.first_welcome) w.to_client(*w.first_welcome);
       }},
      {"a Welcome of nobody",
       [](World& w) {
         w.to_client({{9, 1}, Welcome{{42}, w.attempts, {}, 0, 30, 0.005}});
       }},
      {"an old tool state once more",
       [](World& w) {
         if (w.old_state) w.to_server(*w.old_state);
       }},
      {"an old sample once more", [](World& w) {
         if (w.old_sample) w.to_client(*w.old_sample);
       }}};
  for (const std::uint64_t ahead :
       {std::uint64_t{20}, std::uint64_t{500}, kUnbounded, ~std::uint64_t{0} - 1000}) {
    all.push_back({"a sample with a wild sequence", [ahead](World& w) {
                     w.to_client({{w.of_client(), w.sent() + ahead}, ForceSample{.number = w.sample + 1}});
                   }});
    all.push_back({"a sample with a wild number", [ahead](World& w) {
                     w.to_client({{w.of_client(), w.sent() + 1}, ForceSample{.number = w.sample + ahead}});
                   }});
    all.push_back({"a tool state with a wild sequence", [ahead](World& w) {
                     w.to_server({{w.session(), w.client.next_header().sequence + ahead},
                                  ToolState{.tick = w.tick + 1}});
                   }});
    all.push_back({"a tool state with a wild tick", [ahead](World& w) {
                     w.to_server({w.client.next_header(), ToolState{.tick = w.tick + ahead}});
                   }});
  }
  // Four in a row begin anew there, wherever the sender really is.
  all.push_back({"four samples in a row with wild sequences and numbers", [](World& w) {
                   for (std::uint64_t i = 0; i < 4; ++i) {
                     w.to_client({{w.of_client(), kUnbounded + i}, ForceSample{.number = kUnbounded + i}});
                   }
                 }});
  all.push_back({"four tool states in a row with wild sequences and ticks", [](World& w) {
                   for (std::uint64_t i = 0; i < 4; ++i)
                     w.to_server({{w.session(), kUnbounded + i}, ToolState{.tick = kUnbounded + i}});
                 }});
  return all;
}

/// Whether values pass both ways at the end of 1.1 s of a good network.
bool heals(World world) {
  world.pass(kHealed - kPollPeriod);
  world.states_passed = world.samples_passed = 0;
  world.pass(kPollPeriod);
  return world.states_passed > 0 && world.samples_passed > 0;
}

/// Tries all orders of so many more events; tells the first that does not heal.
bool all_heal(const World& world, const std::vector<Event>& events, int more, std::string& order) {
  for (const Event& event : events) {
    World next = world;
    event.happen(next);
    if (!heals(next) || (more > 1 && !all_heal(next, events, more - 1, order))) {
      order = order.empty() ? event.name : event.name + (", then " + order);
      return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE(
    "session: after any three events in any order, values pass both ways within 1.1 s of a good network") {
  World fresh, live;
  live.pass(500ms);
  for (const World& world : {fresh, live}) {
    std::string order;
    CHECK(all_heal(world, events(), 3, order));
    CHECK(order == "");
  }
}

TEST_CASE("session: after any set of datagrams, values pass both ways within 1.1 s of its end") {
  // Without a key whoever knows the session may say anything in its name.
  std::mt19937_64 random(59);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  const auto number = [&](std::uint64_t near) {
    switch (below(4)) {
      case 0:
        return near + below(70);
      case 1:
        return near - std::min(near, below(200));
      case 2:
        return (std::uint64_t{1} << 63) + below(8);
      default:
        return static_cast<std::uint64_t>(random());
    }
  };
  for (int set = 0; set < 3000; ++set) {
    World world;
    world.pass(kSample * static_cast<int>(below(40)));
    const std::uint64_t datagrams = 1 + below(40), row = number(100);
    for (std::uint64_t i = 0; i < datagrams; ++i) {
      const bool in_a_row = below(2) == 0;
      const std::uint64_t to_client = in_a_row ? row + i : number(world.sent()),
                          to_server = in_a_row ? row + i : number(world.tick);
      switch (below(8)) {
        case 0:
          world.to_server({{world.session(), to_server}, Bye{}});
          break;
        case 1:
          world.to_client({{world.of_client(), to_client}, Bye{}});
          break;
        case 2:
          world.to_client({{world.of_client(), to_client}, Refuse{{}, 0, RefuseReason::kUnknownSession}});
          break;
        case 3:
          world.to_client({{world.of_client(), to_client}, Welcome{{42}, world.attempts, {}, 0, 30, 0.005}});
          break;
        case 4:
        case 5:
          world.to_server({{world.session(), to_server}, ToolState{.tick = to_server}});
          break;
        default:
          world.to_client({{world.of_client(), to_client}, ForceSample{.number = to_client}});
      }
      if (below(4) == 0) world.pass(kTick * static_cast<int>(below(10)));
    }
    CAPTURE(set);
    REQUIRE(heals(std::move(world)));
  }
}
