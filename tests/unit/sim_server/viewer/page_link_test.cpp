#include "sim_server/viewer/page_link.h"

#include <nlohmann/json.hpp>

#include "sim_server/viewer/showing_maker.h"
#include "tests/support/catch.h"
#include "tests/support/page_decoder.h"

using namespace palpate;
using namespace palpate::sim;
using namespace std::chrono_literals;

namespace {

/// A tetrahedron with one tool, and a page that looks at it.
struct Session {
  SceneFacts scene;
  std::unique_ptr<ViewerFeed> feed;
  std::unique_ptr<ShowingMaker> maker;
  PageLink link{1s};
  Time time = 1s;
  test::PageDecoder page;
  std::vector<std::string> texts;

  Session() {
    scene.title = "A tetrahedron";
    scene.tools.resize(1);
    scene.gallery = {"a", "b"};
    scene.pausable = true;
    scene.organ.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    scene.organ.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    scene.organ.flags = {1, 0, 0, 2};
    feed = std::make_unique<ViewerFeed>(scene.organ.rest);
    feed->pages = 1;
    maker = std::make_unique<ShowingMaker>(scene, *feed, true);
  }
  void step(std::uint64_t number, float x = 0) {
    time += 20ms;
    Picture& picture = feed->pictures.back();
    picture.step = number;
    picture.simulated = 0.02 * static_cast<double>(number);
    picture.positions = {x, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    picture.tools[0].sample = {number, 0.02 * static_cast<double>(number), 2.5F, 0};
    feed->pictures.publish();
    maker->update(time);
  }
  /// All that the page gets now; how many messages.
  int take_all() {
    Bytes message;
    int count = 0;
    while (const auto kind = link.next(maker->showing(), time, message)) {
      ++count;
      REQUIRE(count < 50);
      if (*kind == PageLink::Kind::kBinary) {
        page.take(message);
      } else {
        texts.emplace_back(reinterpret_cast<const char*>(message.data()), message.size());
      }
    }
    return count;
  }
  nlohmann::json last_text() const { return nlohmann::json::parse(texts.back()); }
};

}  // namespace

TEST_CASE("viewer: a page gets nothing before it says hello, which it must within 5 s") {
  Session session;
  session.step(1);
  CHECK(session.take_all() == 0);
  CHECK_FALSE(session.link.too_quiet(6s));
  CHECK(session.link.too_quiet(6001ms));
  session.link.greet(false);
  CHECK_FALSE(session.link.too_quiet(100s));
}

TEST_CASE("viewer: a page gets the scene, the topology, the state and the whole surface, then what is new") {
  Session session;
  session.link.greet(false);
  session.step(1, 0.25F);
  CHECK(session.take_all() == 5);  // and the sample
  REQUIRE(session.texts.size() == 2);
  const auto scene = nlohmann::json::parse(session.texts[0])["scene"];
  CHECK(scene["title"] == "A tetrahedron");
  CHECK(scene["control"] == false);
  CHECK(scene["pausable"] == false);
  CHECK_FALSE(scene.contains("scenes"));
  CHECK(session.last_text()["state"]["step"] == 1);
  CHECK(session.page.entire_ones == 1);
  CHECK(session.page.positions[0] == Approx(0.25).margin(1e-4));
  CHECK(session.page.sample_forces == std::vector<double>{2.5});
  CHECK(session.take_all() == 0);
  session.step(2, 0.5F);
  CHECK(session.take_all() == 3);
  CHECK(session.page.named == 5);
  CHECK(session.page.positions[0] == Approx(0.5).margin(1e-4));
}

TEST_CASE("viewer: a page is told how many samples it missed, and none of those that were never made") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  session.step(2);
  session.step(3);
  session.step(5);  // 2, 3 and 4 were made, too
  session.take_all();
  session.step(6);
  session.take_all();
  session.step(1);  // another session
  session.take_all();
  CHECK(session.page.samples_missed == std::vector<int>{0, 3, 0, 0});
}

TEST_CASE("viewer: a page that takes nothing for a while gets the newest, not what it missed") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  for (std::uint64_t step = 2; step <= 100; ++step) session.step(step, 0.001F * static_cast<float>(step));
  CHECK(session.take_all() == 3);
  CHECK(session.page.surfaces == 2);
  CHECK(session.page.step == 100);
  CHECK(session.page.positions[0] == Approx(0.1).margin(1e-4));
}

TEST_CASE("viewer: while nothing steps a page gets states, and no surfaces") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  const std::size_t before = session.texts.size();
  for (int update = 0; update < 100; ++update) {
    session.time += 10ms;
    session.maker->update(session.time);
    session.take_all();
  }
  CHECK(session.texts.size() - before >= 5);
  CHECK(session.texts.size() - before <= 7);
  CHECK(session.page.surfaces == 1);
  CHECK(session.last_text()["state"]["rate_hz"] == 0);
}

TEST_CASE("viewer: a page that tells what it drew has at most four surfaces on their way") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  session.link.shown(1);
  const auto run = [&](std::uint64_t from) {
    for (std::uint64_t step = from; step < from + 20; ++step) {
      session.step(step, 0.001F * static_cast<float>(step));
      session.take_all();
    }
  };
  run(2);
  CHECK(session.page.surfaces == 1 + 4);
  CHECK(session.page.step == 5);
  session.link.shown(4);  // one is still on its way
  run(22);
  CHECK(session.page.surfaces == 1 + 4 + 3);
  session.link.shown(24);
  session.step(50);
  session.take_all();
  CHECK(session.page.step == 50);
}

TEST_CASE(
    "viewer: a step that is shown again, as when other pages come and go while paused, is on its way once") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  session.link.shown(1);
  for (int other = 0; other < 10; ++other) {
    session.step(2);
    session.take_all();
  }
  session.step(3, 0.5F);
  session.take_all();
  CHECK(session.page.step == 3);
  CHECK(session.page.positions[0] == Approx(0.5).margin(1e-4));
}

TEST_CASE("viewer: a page that is gone holds no button down") {
  PageLink link(1s);
  CHECK(link.released().empty());
  link.pointed({.tool = 0, .p_W = {1, 0, 0}, .buttons = 1, .number = 1});
  link.pointed({.tool = 1, .p_W = {2, 0, 0}, .buttons = 1, .number = 2});
  link.pointed({.tool = 1, .p_W = {3, 0, 0}, .buttons = 0, .number = 3});
  link.pointed({.tool = 0, .p_W = {4, 0, 0}, .buttons = 2, .number = 4});
  REQUIRE(link.released().size() == 1);
  CHECK(link.released()[0].tool == 0);
  CHECK(link.released()[0].p_W == Vec3(4, 0, 0));
  CHECK(link.released()[0].buttons == 0);
}

TEST_CASE("viewer: what is cut away is told place by place, and wholly to a page that comes late") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  std::vector<Triangle> now = session.scene.organ.triangles;
  const auto cut = [&](std::uint64_t step, std::uint32_t cuts) {
    for (int i = 0; i < 3; ++i) {  // each of the three pictures is filled in anew
      Picture& picture = session.feed->pictures.back();
      picture.cuts = cuts;
      picture.triangles = now;
      session.step(step);
    }
    session.take_all();
  };
  const auto shown = [](const test::PageDecoder& page) {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < page.corners.size(); i += 3)
      triangles.push_back({static_cast<int>(page.corners[i]), static_cast<int>(page.corners[i + 1]),
                           static_cast<int>(page.corners[i + 2])});
    return triangles;
  };
  now = {{0, 2, 1}, {3, 1, 0}, {0, 3, 2}};
  cut(2, 1);
  CHECK(session.page.version == 2);
  CHECK(session.page.cuts == 1);
  CHECK(session.page.entire_cuts == 0);
  CHECK(shown(session.page) == now);
  now = {{1, 2, 3}};
  cut(3, 5);  // pictures between were not shown
  CHECK(shown(session.page) == now);
  CHECK(session.page.step == 3);
  CHECK(session.page.entire_ones == 1);
  now.clear();
  cut(4, 6);
  CHECK(shown(session.page).empty());
  now = {{0, 1, 2}, {0, 2, 1}};
  cut(5, 7);
  PageLink late(session.time);
  late.greet(false);
  test::PageDecoder page;
  Bytes message;
  while (late.next(session.maker->showing(), session.time + 100ms, message)) {
    if (message[0] != std::byte{'{'}) page.take(message);
  }
  CHECK(shown(page) == now);
  CHECK(page.step == 5);
  CHECK(page.version == 8);
}

TEST_CASE("viewer: who has the token is told what it may do, and of what was not obeyed") {
  Session session;
  session.link.greet(true);
  session.link.refuse("first");
  session.link.refuse("second");
  session.step(1);
  session.take_all();
  CHECK(session.texts[0] == R"({"refused":"second"})");
  const auto scene = nlohmann::json::parse(session.texts[1])["scene"];
  CHECK(scene["control"] == true);
  CHECK(scene["pausable"] == true);
  CHECK(scene["scenes"] == std::vector<std::string>{"a", "b"});
}

TEST_CASE("viewer: more than 200 messages a second are too many") {
  Session session;
  int taken = 0;
  for (int k = 0; k < 1000; ++k) taken += session.link.may_say(10s) ? 1 : 0;
  CHECK(taken == 200);
  CHECK_FALSE(session.link.may_say(10s + 4ms));
  CHECK(session.link.may_say(10s + 6ms));
}

TEST_CASE("viewer: rates are measured over the last second") {
  Session session;
  session.link.greet(false);
  for (std::uint64_t step = 1; step <= 200; ++step) session.step(step);
  CHECK(session.maker->showing().rates.steps_hz == Approx(50).epsilon(0.1));
  CHECK(session.maker->showing().rates.real_time_factor == Approx(1).epsilon(0.1));

  // While nobody looked, steps went on: they are not of the second in which a page comes back.
  session.feed->pages = 0;
  session.maker->update(session.time);
  session.feed->pages = 1;
  session.time += 10s;
  session.maker->update(session.time);
  session.take_all();
  CHECK(session.last_text()["state"]["rate_hz"].is_null());
  for (std::uint64_t step = 701; step <= 760; ++step) session.step(step);
  CHECK(session.maker->showing().rates.steps_hz == Approx(50).epsilon(0.1));
}

TEST_CASE("viewer: what a client tells reaches a page once") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  SeenClient client{.tool = 0, .laws = 2};
  client.law = SeenClient::Name{"linear_position"};
  client.law_names = {SeenClient::Name{"constant"}, SeenClient::Name{"linear_position"}};
  client.errors_percent = {12.5F, std::nanf("")};
  client.parts_percent = {50.25F, 0.5F, std::nanf("")};
  client.part_names = {SeenClient::Name{}, SeenClient::Name{"fades"}, SeenClient::Name{"limits"}};
  client.age_ms = 20;
  client.states = 1;
  client.state_names[0] = SeenClient::Name{"clutched"};
  client.interventions = 1;
  client.intervention_names = {SeenClient::Name{"clamped"}};
  client.intervention_counts = {3};
  session.feed->clients[0] = client;
  ++session.feed->client_events[0];
  session.maker->update(session.time);
  CHECK(session.take_all() == 0);  // of a client that has left
  session.feed->peers[0].held = true;
  ClientTicks ticks{.tool = 0, .laws = 2, .count = 1};
  for (int k = 0; k < 20; ++k) {
    session.feed->ticks.push_back(ticks);
  }
  session.maker->update(session.time);
  // Of the ticks the newest sixteen.
  CHECK(session.take_all() == 1 + 16);
  const auto published = session.last_text()["client"];
  CHECK(published["law"] == "linear_position");
  CHECK(published["errors_percent"][0] == 12.5);
  CHECK(published["errors_percent"][1].is_null());
  CHECK(published["total_percent"] == 50.25);
  CHECK(published["parts_percent"].size() == 2);
  CHECK(published["parts_percent"]["fades"] == 0.5);
  CHECK(published["parts_percent"]["limits"].is_null());
  CHECK_THAT(published["beside"].get<std::string>(), Catch::Contains("20 ms old: late in a damper"));
  CHECK(published["interventions"]["clamped"] == 3);
  CHECK(published["states"] == std::vector<std::string>{"clutched"});
  session.maker->update(session.time);
  CHECK(session.take_all() == 0);
}

TEST_CASE("viewer: a page learns how many samples did not settle, and of strain in the report's words") {
  Session session;
  session.link.greet(false);
  session.step(1);
  session.take_all();
  CHECK(session.last_text()["state"]["strain"] == "");
  CHECK(session.last_text()["state"]["tools"][0]["flagged_samples"] == 0);
  StrainRange strain(ElasticLaw::kLinear);
  strain.add(0.45), strain.add(0.1);
  for (int buffer = 0; buffer < 3; ++buffer) {  // pictures take turns
    session.feed->pictures.back().strain = strain;
    session.feed->pictures.back().tools[0].flagged_samples = 7;
    session.step(2 + static_cast<std::uint64_t>(buffer), 0.1F * static_cast<float>(buffer));
  }
  session.take_all();
  const auto state = session.last_text()["state"];
  CHECK(state["tools"][0]["flagged_samples"] == 7);
  CHECK(state["strain"] == strain.to_text());
  CHECK_THAT(state["strain"].get<std::string>(), Catch::Contains("strain up to 45 %") &&
                                                     Catch::Contains("1 of 2") &&
                                                     Catch::Contains("neo_hookean"));
}
