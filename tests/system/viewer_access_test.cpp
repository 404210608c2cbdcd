// The live page of the real server, over real sockets: to whom it is served, and that no page or stranger can
// slow it.
#ifdef PALPATE_WITH_VIEWER
#include <algorithm>
#include <csignal>
#include <list>
#include <thread>

#include "tests/support/catch.h"
#include "tests/support/watched_server.h"

using namespace palpate::test;

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

TEST_CASE("viewer: 200 connections that say nothing keep no page out, and are closed after 5 s") {
  const Watched server;
  std::list<TcpEnd> silent;
  for (int k = 0; k < 200; ++k) silent.emplace_back(server.page.port);
  CHECK(status_of(server.get("/")) == 200);
  WebPage page(server.page);
  CHECK(page.open());
  page.hello();
  CHECK(page.next_text("state").is_object());
  // The last one was opened before the page: it has 5 s, and a while for a busy machine.
  silent.back().read(1, 15);
  CHECK(silent.back().closed());
  CHECK(page.next_text("state").is_object());
}

TEST_CASE("viewer: an upgrade to anything but WebSocket is refused, and costs nothing later") {
  const Watched server;
  const auto upgrade = [&](const std::string& to) {
    return answer_to(server.page.port, "GET / HTTP/1.1\r\nHost: " + server.page.host() +
                                           "\r\nConnection: Upgrade, HTTP2-Settings\r\nUpgrade: " + to +
                                           "\r\nHTTP2-Settings: AAMAAABkAAQCAAAAAAIAAAAA\r\n\r\n");
  };
  for (int k = 0; k < 3; ++k) CHECK(status_of(upgrade("h2c")) != 101);
  CHECK(status_of(upgrade("tls/1.2")) != 101);
  const double before = server.processor_s();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  CHECK(server.processor_s() - before < 1);  // a connection that spins takes 2 s of a core
  CHECK(status_of(server.get("/")) == 200);
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
#if !defined(PALPATE_SANITIZED)  // they keep what was freed
  CHECK(server.resident_kb() - before < 1000);
#else
  static_cast<void>(before);
#endif
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

/// A page beyond this machine: refused, and with `--insecure` served, with a warning.
static void check_wants_insecure(const std::vector<std::string>& requested, const char* served) {
  const auto said = output_of("sim_server", requested, 2);
  CHECK(std::ranges::count(said, '\n') == 1);
  for (const char* part : {"--viewer: 0.0.0.0:0 is not this machine", "ssh -L", "--insecure"})
    CHECK(said.find(part) != std::string::npos);
  auto insecure = requested;
  insecure.insert(insecure.end(), {"--insecure", "--seconds", "0.1"});
  const auto warned = output_of("sim_server", insecure, 0);
  CHECK(warned.find("--viewer: 0.0.0.0:0 is not this machine") != std::string::npos);
  CHECK(warned.find(served) != std::string::npos);
}

TEST_CASE("viewer: beyond this machine the page is served to who says that it is insecure") {
  const TemporaryFolder folder;
  const std::string key = (folder.path() / "palpate.key").string();
  output_of("sim_server", {"keygen", key}, 0);
  const std::vector<std::string> requested{"run",   kScene, "--listen", "127.0.0.1:0",
                                           "--key", key,    "--viewer", "0.0.0.0:0"};
  check_wants_insecure(requested, "the live page: http://0.0.0.0:");
}

TEST_CASE("viewer: a recording, too, is served beyond this machine to who says that it is insecure") {
  const std::vector<std::string> requested{"view", source_dir() + "/tests/wireshark/session.pcap", "--viewer",
                                           "0.0.0.0:0"};
  check_wants_insecure(requested, "the page: http://0.0.0.0:");
}

TEST_CASE("viewer: a port that is taken, or an address that is none, is told in one line") {
  const Watched server;
  const std::string port = std::to_string(server.page.port);
  const auto said = output_of("sim_server", {"run", kScene, "--listen", "127.0.0.1:0", "--viewer", port}, 2);
  CHECK(said.find("--viewer: cannot listen on 127.0.0.1:" + port) != std::string::npos);
  CHECK(std::ranges::count(said, '\n') == 1);
  for (const char* wrong : {"nowhere", "70000", "1.2.3.4.5:80"}) {
    const auto published = output_of("sim_server", {"run", kScene, "--viewer", wrong}, 2);
    CHECK(published.find("--viewer") != std::string::npos);
    CHECK(std::ranges::count(published, '\n') == 1);
  }
  CHECK(output_of("sim_server", {"run", kScene, "--viewer", "192.0.2.7:8080"}, 2).find("no such address") !=
        std::string::npos);
}

#endif
