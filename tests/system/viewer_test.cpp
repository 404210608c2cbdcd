// The live page of the real server, over real sockets: what it shows, and what it may do.
#ifdef PALPATE_WITH_VIEWER
#include <algorithm>
#include <csignal>
#include <fmt/core.h>
#include <thread>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/watched_server.h"

using namespace palpate::test;

TEST_CASE("viewer: the page is served as it is in the source, and nothing else is") {
  const Watched server;
  const std::string page = server.get("/");
  CHECK(status_of(page) == 200);
  CHECK(body_of(page) == dist("index.html"));
  CHECK(body_of(server.get("/index.html?x=1")) == dist("index.html"));
  CHECK(body_of(server.get("/page.js")) == dist("page.js"));
  CHECK(body_of(server.get("/page.css")) == dist("page.css"));
  for (const char* header :
       {"content-type: text/html", "x-content-type-options: nosniff", "cache-control: no-store",
        "content-security-policy: default-src 'none'; script-src 'self';"}) {
    CAPTURE(header, page);
    CHECK(page.find(header) != std::string::npos);
  }
  const std::string head = server.get("/page.js", "", "HEAD");
  CHECK(status_of(head) == 200);
  CHECK(head.find("content-length: " + std::to_string(dist("page.js").size())) != std::string::npos);
  CHECK(body_of(head).empty());
  for (const char* path : {"/nothing", "/../CMakeLists.txt", "/%2e%2e/x", "/live", "/session", "/page.js/"}) {
    CAPTURE(path);
    CHECK(status_of(server.get(path)) != 200);
  }
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "NONSENSE"}) {
    CAPTURE(method);
    CHECK(status_of(server.get("/", "", method)) != 200);
  }
}

TEST_CASE("viewer: a page opened before, during and after a session sees the organ move and rest") {
  Watched server;
  WebPage before(server.page);
  before.hello();
  const auto scene = before.next_text("scene");
  CHECK(scene["title"] == "Palpate a liver on the mesh of 1999");
  CHECK(scene["model"] == "quasi_static");
  CHECK(scene["control"] == false);
  CHECK(before.next_text("state")["tools"][0]["held"] == false);
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "4"}));
  nlohmann::json state;
  for (int k = 0; k < 200 && !(state.is_object() && state["tools"][0]["contact"] == true); ++k)
    state = before.next_text("state");
  REQUIRE(state["tools"][0]["contact"] == true);
  CHECK(state["tools"][0]["held"] == true);
  CHECK(state["tools"][0]["errors"]["mesh"]["source"] == "estimated");
  CHECK(state["tools"][0]["errors"]["mesh"]["percent"] > 50);  // of elements longer than the tip is wide
  CHECK(state["tools"][0]["errors"]["time_step"]["source"] == "none by construction");
  CHECK(state["tools"][0]["loads"].size() >= 1);
  // The loads add up to the force on the tool, the other way round.
  double sum[3]{};
  for (const auto& load : state["tools"][0]["loads"]) {
    for (int i = 0; i < 3; ++i) sum[i] += load[static_cast<std::size_t>(i) + 1].get<double>();
  }
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(sum[i] == Approx(-state["tools"][0]["f"][i].get<double>()).margin(1e-4));
  WebPage during(server.page);
  during.hello();
  CHECK(during.next_text("state")["tools"][0]["held"] == true);
  CHECK(client.wait() == 0);

  // Both, and one that comes now, end with the same surface.
  server.process.wait_for("the client is gone");
  WebPage after(server.page);
  after.hello();
  for (WebPage* page : {&before, &during, &after}) {
    for (int quiet = 0; quiet < 4;) {
      const auto frame = page->next(1);
      REQUIRE(frame);
      quiet = frame->kind == 1 ? quiet + 1 : 0;
    }
  }
  CHECK(before.decoder.surfaces > 20);
  CHECK(before.decoder.sample_forces.size() > 20);
  CHECK(*std::ranges::max_element(before.decoder.sample_forces) > 0.1);
  CHECK(before.decoder.positions == after.decoder.positions);
  CHECK(during.decoder.positions == after.decoder.positions);
  CHECK(after.decoder.entire_ones == 1);
}

TEST_CASE("viewer: who has the token pauses, steps once, and goes on") {
  Watched server;
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "30"}));
  WebPage reader(server.page), owner(server.page);
  reader.hello("0123456789abcdef0123456789abcdef");
  owner.hello(server.page.token);
  CHECK(reader.next_text("scene")["control"] == false);
  const auto scene = owner.next_text("scene");
  CHECK(scene["control"] == true);
  CHECK(scene["pausable"] == true);
  const auto& names = scene["scenes"];
  CHECK(std::ranges::find(names, "liver_breathing") != names.end());
  CHECK(std::ranges::find(names, "liver_paper") == names.end());  // which does not say what it needs
  CHECK(std::ranges::is_sorted(names));
  reader.say(R"({"pause": true})");
  CHECK(reader.next_text("refused").is_string());
  owner.say(R"({"step": 1})");
  CHECK(owner.next_text("refused").is_string());

  const auto state_where = [&](const auto& holds) {
    nlohmann::json state;
    for (int k = 0; k < 300; ++k) {
      state = owner.next_text("state");
      if (state.is_null() || holds(state)) return state;
    }
    return nlohmann::json(nullptr);
  };
  REQUIRE(state_where([](const auto& s) { return s["step"] > 10; }).is_object());
  owner.say(R"({"pause": true})");
  REQUIRE(state_where([](const auto& s) { return s["paused"] == true; }).is_object());
  for (int k = 0; k < 5; ++k) owner.next_text("state");  // what was under way
  const auto held = owner.next_text("state")["step"].get<int>();
  for (int k = 0; k < 12; ++k) {
    const auto state = owner.next_text("state");
    CHECK(state["step"] == held);
    CHECK(state["tools"][0]["held"] == true);  // its client is told, and stays
  }
  owner.say(R"({"step": 1})");
  owner.say(R"({"step": 1})");
  REQUIRE(state_where([&](const auto& s) { return s["step"] == held + 2; }).is_object());
  for (int k = 0; k < 5; ++k) CHECK(owner.next_text("state")["step"] == held + 2);
  CHECK(server.process.output().find("paused by a page") != std::string::npos);
  owner.say(R"({"pause": false})");
  CHECK(state_where([&](const auto& s) { return s["step"] > held + 10; })["paused"] == false);
  CHECK(server.process.wait_for("goes on"));
  client.signal(SIGINT);
  CHECK(client.wait() == 0);
  REQUIRE(server.process.wait_for("the client is gone"));
  owner.say(R"({"pause": true})");
  REQUIRE(state_where([](const auto& s) { return s["paused"] == true; }).is_object());
  const Process late("haptic_client", client_arguments(server.address, {"--seconds", "30"}));
  CHECK(server.process.wait_for("a client took the tool; a page has paused"));
}

TEST_CASE("viewer: a page is told what only the client knows, and by whom a tool is held") {
  Watched server;
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "5"}));
  WebPage page(server.page);
  page.hello();
  nlohmann::json published;
  for (int k = 0; k < 200 && (published.is_null() || published["felt"][1] == 0); ++k)
    published = page.next_text("client");
  REQUIRE(published.is_object());
  CHECK(published["tool"] == 0);
  CHECK(published["law"].get<std::string>().size() > 3);
  CHECK(published["laws"].size() >= 3);
  CHECK(published["errors_percent"].size() == published["laws"].size());
  CHECK(published["interventions"].contains("clamped"));
  CHECK(published["has_motors"] == false);
  CHECK(published["p"].size() == 3);
  const auto& ticks = page.decoder;
  while (ticks.tick_times.size() < 500) REQUIRE(page.next());
  CHECK(*std::ranges::max_element(ticks.tick_forces) > 0.05);
  // They follow each other by the period of the loop, but where messages meet, as the clocks are not one.
  double apart = 0;
  for (std::size_t k = 1; k < ticks.tick_times.size(); ++k) {
    const double dt = ticks.tick_times[k] - ticks.tick_times[k - 1];
    CHECK(dt > -0.1);
    apart += dt;
  }
  CHECK(apart / static_cast<double>(ticks.tick_times.size() - 1) == Approx(0.002).epsilon(0.3));
  const auto state = page.next_text("state");
  REQUIRE(state["peers"].size() == 1);
  CHECK(state["peers"][0]["address"].get<std::string>().starts_with("127.0.0.1:"));
  CHECK(state["peers"][0]["rate_hz"].get<double>() > 100);
  CHECK(state["peers"][0]["loss_percent"].get<double>() < 20);
}

TEST_CASE("viewer: a drag in the page moves the tool of a client whose device is that mouse") {
  Watched server;
  Process client("haptic_client",
                 client_arguments(server.address, {"--seconds", "20", "--device", "browser"}));
  WebPage owner(server.page);
  owner.hello(server.page.token);
  const auto tool_at = [&] {
    const auto state = owner.next_text("state");
    return state["tools"][0]["held"] == true ? state["tools"][0]["p"][1].get<double>() : std::nan("");
  };
  double y = tool_at();
  for (int k = 0; k < 300 && !std::isfinite(y); ++k) y = tool_at();
  REQUIRE(std::isfinite(y));
  int number = 0;
  double moved = y;
  for (int k = 0; k < 300 && std::abs(moved - (y + 0.01)) > 1e-3; ++k) {
    owner.say(fmt::format(R"({{"pointer": {{"tool": 0, "p": [0, {}, 0], "buttons": 1, "number": {}}}}})",
                          y + 0.01, ++number));
    moved = tool_at();
  }
  CHECK(moved == Approx(y + 0.01).margin(1e-3));
  owner.say(R"({"pointer": {"tool": 3, "p": [0, 0, 0], "buttons": 0, "number": 1}})");
  CHECK(owner.next_text("refused").is_string());
}

TEST_CASE("viewer: strain energy is sent to who wants it, where the model knows what is inside") {
  const Watched surface_only;
  WebPage none(surface_only.page);
  none.hello();
  CHECK(none.next_text("scene")["fields"].empty());
  none.say(R"({"want": {"field": "strain_energy"}})");
  CHECK(none.next_text("refused").is_string());

  const std::string scene = GENERATE("liver_implicit", "liver_tensor_mass");
  CAPTURE(scene);
  Server server({"--viewer", "0"}, "127.0.0.1:0", source_dir() + "/configs/scenes/" + scene + ".toml");
  const PageAddress address = PageAddress::of(server.process);
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "6"}));
  WebPage polls(address), request(address);
  polls.hello(), request.hello();
  CHECK(request.next_text("scene")["fields"][0] == "strain_energy");
  request.say(R"({"want": {"field": "strain_energy"}})");
  float largest = 0;
  std::size_t size = 0;
  for (int k = 0; k < 1000 && largest < 0.1F; ++k) {
    const auto frame = request.next();
    REQUIRE(frame);
    if (frame->kind != 2 || frame->payload[0] != 5) continue;
    std::memcpy(&largest, frame->payload.data() + 12, 4);
    size = frame->payload.size();
  }
  CHECK(largest >= 0.1F);
  CHECK(size == 16 + request.decoder.flags.size());
  for (int k = 0; k < 100; ++k) {
    const auto frame = polls.next();
    REQUIRE(frame);
    CHECK((frame->kind != 2 || frame->payload[0] != 5));
  }
}

TEST_CASE("viewer: another scene of the gallery is served on the same ports, with the same token") {
  Watched server;
  WebPage owner(server.page);
  owner.hello(server.page.token);
  owner.next_text("scene");
  owner.say(R"({"choose": "../../etc/passwd"})");
  CHECK(owner.next_text("refused").is_string());
  owner.say(R"({"choose": "minimal"})");
  CHECK(owner.close_code(10) != -1);
  REQUIRE(server.process.wait_for("\"The least that is a scene\" ready", 60));
  WebPage again(server.page);
  again.hello(server.page.token);
  const auto scene = again.next_text("scene");
  CHECK(scene["title"] == "The least that is a scene");
  CHECK(scene["control"] == true);
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "2"}));
  CHECK(client.wait() == 0);
  while (again.decoder.surfaces <= 10) REQUIRE(again.next());
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
}

#endif
