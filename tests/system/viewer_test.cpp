// The live page of the real server, over real sockets: what it serves, to whom, and that no page can slow it.
#ifdef PALPATE_WITH_VIEWER
#include <algorithm>
#include <csignal>
#include <list>
#include <thread>

#include "tests/support/catch.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/web_page.h"

using namespace palpate::test;

namespace {

/// A server of the paper's liver with its page.
struct Watched : Server {
  PageAddress page;
  explicit Watched(std::vector<std::string> more = {})
      : Server([&] {
          more.insert(more.end(), {"--viewer", "0"});
          return more;
        }()),
        page(PageAddress::of(process)) {}
  std::string get(const std::string& path, const std::string& host = {},
                  const std::string& method = "GET") const {
    return answer_to(page.port, method + " " + path + " HTTP/1.1\r\nHost: " +
                                    (host.empty() ? page.host() : host) + "\r\nConnection: close\r\n\r\n");
  }
  long resident_kb() const {
    std::ifstream file("/proc/" + std::to_string(process.id()) + "/statm");
    long all = 0, resident = 0;
    file >> all >> resident;
    return resident * 4;
  }
};

int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
}
std::string body_of(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}
std::string dist(const std::string& file) {
  return bytes_of(std::filesystem::path(PALPATE_SOURCE_DIR) / "sim_server/viewer/page/dist" / file);
}

}  // namespace

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

TEST_CASE("viewer: a name that is not ours is shown nothing") {
  const Watched server;
  CHECK(status_of(server.get("/", "localhost")) == 200);
  for (const char* host : {"evil.example", "localhost.evil.example:80", "[::1"}) {
    CAPTURE(host);
    CHECK(status_of(server.get("/", host)) == 403);
  }
  CHECK(WebPage(server.page, {.host = "localhost:99"}).open());
  CHECK_FALSE(WebPage(server.page, {.host = "evil.example"}).open());
  CHECK_FALSE(WebPage(server.page, {.origin = "http://evil.example"}).open());
  CHECK_FALSE(WebPage(server.page, {.origin = "null"}).open());
  CHECK_FALSE(WebPage(server.page, {.origin = ""}).open());
  CHECK_FALSE(WebPage(server.page, {.path = "/"}).open());
  CHECK_FALSE(WebPage(server.page, {.path = "/page.js"}).open());
  CHECK_FALSE(WebPage(server.page, {.protocol = ""}).open());
  CHECK_FALSE(WebPage(server.page, {.protocol = "chat"}).open());
  CHECK(WebPage(server.page).open());
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
  CHECK(after.decoder.whole_ones == 1);
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
  CHECK(std::find(names.begin(), names.end(), "liver_breathing") != names.end());
  CHECK(std::find(names.begin(), names.end(), "liver_paper") ==
        names.end());  // which does not say what it needs
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
  nlohmann::json told;
  for (int k = 0; k < 200 && (told.is_null() || told["felt"][1] == 0); ++k) told = page.next_text("client");
  REQUIRE(told.is_object());
  CHECK(told["tool"] == 0);
  CHECK(told["law"].get<std::string>().size() > 3);
  CHECK(told["laws"].size() >= 3);
  CHECK(told["errors_percent"].size() == told["laws"].size());
  CHECK(told["interventions"].contains("clamped"));
  CHECK(told["has_motors"] == false);
  CHECK(told["p"].size() == 3);
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

  Server server({"--viewer", "0"}, "127.0.0.1:0",
                std::string(PALPATE_SOURCE_DIR) + "/configs/scenes/liver_implicit.toml");
  const PageAddress address = PageAddress::of(server.process);
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "6"}));
  WebPage looks(address), wants(address);
  looks.hello(), wants.hello();
  CHECK(wants.next_text("scene")["fields"][0] == "strain_energy");
  wants.say(R"({"want": {"field": "strain_energy"}})");
  float largest = 0;
  std::size_t size = 0;
  for (int k = 0; k < 1000 && largest < 0.1F; ++k) {
    const auto frame = wants.next();
    REQUIRE(frame);
    if (frame->kind != 2 || frame->payload[0] != 5) continue;
    std::memcpy(&largest, frame->payload.data() + 12, 4);
    size = frame->payload.size();
  }
  CHECK(largest >= 0.1F);
  CHECK(size == 16 + wants.decoder.flags.size());
  for (int k = 0; k < 100; ++k) {
    const auto frame = looks.next();
    REQUIRE(frame);
    CHECK((frame->kind != 2 || frame->payload[0] != 5));
  }
}

TEST_CASE("viewer: a page that breaks the rules is closed, and no other") {
  Watched server;
  WebPage good(server.page);
  good.hello();
  const auto code_after = [&](const auto& act, double seconds = 3) {
    WebPage page(server.page);
    REQUIRE(page.open());
    act(page);
    return page.close_code(seconds);
  };
  CHECK(code_after([](WebPage& p) { p.say("{"); }) == 1008);
  CHECK(code_after([](WebPage& p) { p.say(R"({"want": {"field": null}})"); }) == 1008);  // before hello
  CHECK(code_after([](WebPage& p) { p.hello(), p.hello(); }) == 1008);
  CHECK(code_after([](WebPage& p) { p.hello(), p.say(R"({"unknown": 1})"); }) == 1008);
  CHECK(code_after([](WebPage& p) { p.hello(), p.send_frame(0x82, "binary"); }) == 1003);
  CHECK(code_after([](WebPage& p) { p.hello(), p.say(std::string(5000, ' ')); }) == 1009);
  CHECK(code_after([](WebPage& p) {  // the same in parts, without end
          p.hello();
          p.send_frame(0x01, std::string(3000, ' '));
          p.send_frame(0x00, std::string(3000, ' '));
        }) == 1009);
  CHECK(code_after([](WebPage& p) {
          p.hello();
          for (int k = 0; k < 300; ++k) p.say(R"({"want": {"field": null}})");
        }) == 1008);
  CHECK(code_after([](WebPage& p) { p.send_frame(0x81, "not masked", false); }) != -1);
  CHECK(code_after([](WebPage& p) { p.send_frame(0xf1, "reserved bits"); }) != -1);
  CHECK(code_after([](WebPage& p) { p.send_frame(0x83, "no such opcode"); }) != -1);
  CHECK(code_after([](WebPage& p) { p.send_frame(0x80, "goes on with nothing"); }) != -1);
  CHECK(code_after([](WebPage& p) { p.send_frame(0x09, "a ping in parts"); }) != -1);
  CHECK(code_after([](WebPage&) {}, 8) == 1008);  // no hello
  CHECK(good.next_text("state").is_object());
}

TEST_CASE("viewer: bytes that are no HTTP do not hurt") {
  Watched server;
  std::string noise;
  for (int k = 0; k < 5000; ++k) noise += static_cast<char>((k * 7919) >> 3);
  for (const std::string& request :
       {noise, std::string("GET"), std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET  \r\n\r\n"),
        "GET /" + std::string(20000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(50000, 'b') + "\r\n\r\n",
        std::string("GET / HTTP/1.1\r\n\r\n"), std::string("\r\n\r\n\r\n"), std::string(100, '\0'),
        std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
        std::string("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n\r\nx"),
        std::string(
            "GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n"),
        std::string("GET /live HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nUpgrade: "
                    "websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Protocol: "
                    "palpate-view-1\r\nSec-WebSocket-Version: 99\r\nSec-WebSocket-Key: x\r\n\r\n")}) {
    CAPTURE(request.substr(0, 60));
    CHECK(status_of(answer_to(server.page.port, request)) != 200);
    CHECK(server.process.running());
  }
  CHECK(status_of(server.get("/")) == 200);
}

TEST_CASE("viewer: sixteen pages may look on, and the seventeenth when one has gone") {
  const Watched server;
  std::list<WebPage> pages;
  for (int k = 0; k < 16; ++k) {
    pages.emplace_back(server.page);
    REQUIRE(pages.back().open());
    pages.back().hello();
  }
  CHECK_FALSE(WebPage(server.page).open());
  CHECK(status_of(server.get("/")) == 200);
  pages.pop_front();
  bool open = false;
  for (int tries = 0; tries < 50 && !open; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    open = WebPage(server.page).open();
  }
  CHECK(open);
  for (WebPage& page : pages) CHECK(page.next_text("state").is_object());
}

TEST_CASE("viewer: connections that say nothing do not keep a page out for long") {
  const Watched server;
  std::list<TcpEnd> silent;
  for (int k = 0; k < 60; ++k) silent.emplace_back(server.page.port);
  // More than the server takes at once. They stay open at this end; after 10 s it lets go of who says
  // nothing.
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(15);
  while (status != 200 && std::chrono::steady_clock::now() < end) {
    status = status_of(server.get("/"));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  CHECK(status == 200);
}

TEST_CASE("viewer: a page that never reads costs no memory, and others see all") {
  const TemporaryFolder folder;
  const std::string report = (folder.path() / "server.json").string();
  Watched server({"--report", report});
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "8"}));
  std::list<WebPage> stalled;
  for (int k = 0; k < 5; ++k) {
    stalled.emplace_back(server.page, WebPage::Manners{.receive_buffer = 4096});
    stalled.back().hello();
  }
  WebPage page(server.page);
  page.hello();
  const auto look_for = [&](double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) REQUIRE(page.next());
  };
  look_for(3);
  const long before = server.resident_kb();
  const std::size_t surfaces = page.decoder.surfaces;
  look_for(4);
  CHECK(server.resident_kb() - before < 1000);
  CHECK(page.decoder.surfaces - surfaces > 60);
  // Each holds the beginning, and what the system keeps for it: no more than that.
  for (WebPage& slow : stalled) {
    while (const auto frame = slow.next(0.2)) {
      if (frame->kind == 1 && slow.decoder.step + 10 > page.decoder.step) break;
    }
    CHECK(slow.decoder.surfaces < surfaces);
  }
  CHECK(client.wait() == 0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  CHECK(read_json(report)["steps"].get<int>() > 200);
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

TEST_CASE("viewer: each run has a token of its own, with a key and without") {
  const TemporaryFolder folder;
  const std::string key = (folder.path() / "palpate.key").string();
  output_of("sim_server", {"keygen", key}, 0);
  const std::string first = Watched({"--key", key}).page.token, second = Watched({"--key", key}).page.token;
  CHECK(first.size() == 32);
  CHECK(second.size() == 32);
  CHECK(first != second);
  CHECK(Watched().page.token != Watched().page.token);
}

TEST_CASE("viewer: beyond this machine the page is served to who says that it is insecure") {
  const TemporaryFolder folder;
  const std::string key = (folder.path() / "palpate.key").string();
  output_of("sim_server", {"keygen", key}, 0);
  const std::vector<std::string> asked{"run",   kScene, "--listen", "127.0.0.1:0",
                                       "--key", key,    "--viewer", "0.0.0.0:0"};
  const auto said = output_of("sim_server", asked, 2);
  CHECK(std::ranges::count(said, '\n') == 1);
  for (const char* part : {"--viewer: 0.0.0.0:0 is not this machine", "ssh -L", "--insecure"})
    CHECK(said.find(part) != std::string::npos);
  auto insecure = asked;
  insecure.insert(insecure.end(), {"--insecure", "--seconds", "0.1"});
  const auto warned = output_of("sim_server", insecure, 0);
  CHECK(warned.find("--viewer: 0.0.0.0:0 is not this machine") != std::string::npos);
  CHECK(warned.find("the live page: http://0.0.0.0:") != std::string::npos);
}

TEST_CASE("viewer: a port that is taken, or an address that is none, is told in one line") {
  const Watched server;
  const std::string port = std::to_string(server.page.port);
  const auto said = output_of("sim_server", {"run", kScene, "--listen", "127.0.0.1:0", "--viewer", port}, 2);
  CHECK(said.find("--viewer: cannot listen on 127.0.0.1:" + port) != std::string::npos);
  CHECK(std::ranges::count(said, '\n') == 1);
  for (const char* wrong : {"nowhere", "70000", "1.2.3.4.5:80"}) {
    const auto told = output_of("sim_server", {"run", kScene, "--viewer", wrong}, 2);
    CHECK(told.find("--viewer") != std::string::npos);
    CHECK(std::ranges::count(told, '\n') == 1);
  }
  CHECK(output_of("sim_server", {"run", kScene, "--viewer", "192.0.2.7:8080"}, 2).find("no such address") !=
        std::string::npos);
}

#endif
