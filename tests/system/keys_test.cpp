// Both real programs with keys, and what strangers can do to them.
#include <csignal>
#include <functional>
#include <sys/stat.h>
#include <thread>

#include "common/clock.h"
#include "protocol/capture.h"
#include "protocol/key_file.h"
#include "protocol/session.h"
#include "protocol/udp_socket.h"
#include "tests/support/programs.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using namespace palpate::protocol;
using namespace std::chrono_literals;
using Json = nlohmann::json;

namespace {

struct KeyBench {
  TemporaryFolder folder;
  std::string key = (folder.path() / "palpate.key").string(),
              report = (folder.path() / "report.json").string();

  KeyBench() { output_of("sim_server", {"keygen", key}, 0); }
  std::vector<std::string> with_key(std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--key", key});
    return more;
  }
};

}  // namespace

#ifdef PALPATE_WITH_CAPTURE
TEST_CASE("keys: with the same key a session is as ever, and every datagram of the capture has a tag of it",
          "[in_time]") {
  const KeyBench bench;
  const std::string capture = (bench.folder.path() / "F.pcap").string();
  Server server(bench.with_key());
  output_of("haptic_client",
            client_arguments(server.address, bench.with_key({"--seconds", "2", "--report", bench.report,
                                                             "--record", capture})),
            0);
  const Json tool = read_json(bench.report)["tools"][0];
  CHECK(tool["force"]["samples"].get<int>() > 15);
  CHECK(tool["link"]["rejected"] == 0);
  palpate::protocol::CaptureReader reader(capture);
  palpate::protocol::CapturedDatagram datagram;
  std::size_t captured = 0;
  for (; reader.next(datagram); ++captured) {
    constexpr std::size_t kTagBytesAt = 8;  // protocol/README.md
    REQUIRE(datagram.bytes.size() > kTagBytesAt);
    CHECK(std::to_integer<std::size_t>(datagram.bytes[kTagBytesAt]) == palpate::protocol::kTagBytes);
  }
  CHECK(captured > 500);
  // And what was captured replays as ever: payloads are readable.
  CHECK_THAT(output_of("haptic_client", {"replay", capture, "--client", kClient}, 0),
             Catch::Contains("rendered: "));
}
#endif

TEST_CASE("keys: another key, none, or one where the server has none: exit 1, and what to look at") {
  const KeyBench bench, other;
  Server keyed(bench.with_key());
  const auto said = [](const Server& server, const std::vector<std::string>& more) {
    return output_of("haptic_client", client_arguments(server.address, more), 1);
  };
  CHECK_THAT(said(keyed, {"--key", other.key}),
             Catch::Contains("is there, and answers nothing to the key in " + other.key +
                             ", so it has another key"));
  CHECK_THAT(said(keyed, {}), Catch::Contains("is there, and answers nothing without its key"));
  Server open;
  CHECK_THAT(said(open, bench.with_key()),
             Catch::Contains("answers without a key") && Catch::Contains("start it with the same key"));
  // The servers say the same of their side, once each, though eight Hellos and more came.
  keyed.process.signal(SIGINT), open.process.signal(SIGINT);
  keyed.process.wait(), open.process.wait();
  const auto count = [](const std::string& text, const std::string& part) {
    int found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  };
  CHECK(count(keyed.process.output(), "says Hello with another key") == 1);
  CHECK(count(keyed.process.output(), "says Hello without a key") == 1);
  CHECK(count(open.process.output(), "says Hello with a key, and obeys no answer") == 1);
}

TEST_CASE("keys: neither program leaves this machine without one, exit 2") {
  CHECK_THAT(output_of("sim_server", {"run", kScene, "--listen", "0.0.0.0:0"}, 2),
             Catch::Contains("keygen") && Catch::Contains("--insecure"));
  CHECK_THAT(output_of("haptic_client", client_arguments("10.255.255.1:45130", {}), 2),
             Catch::Contains("keygen") && Catch::Contains("--insecure"));
  const KeyBench bench;
  ::chmod(bench.key.c_str(), 0644);
  CHECK_THAT(output_of("sim_server", {"run", kScene, "--key", bench.key}, 2), Catch::Contains("chmod 600"));
  CHECK_THAT(output_of("sim_server", {"keygen", bench.key}, 2), Catch::Contains("is there already"));
}

#ifdef PALPATE_WITH_CAPTURE
namespace {

/// Sends what `make` gives, `per_ms` datagrams each millisecond, from a socket of its own.
class Flood {
 public:
  using Make = std::function<std::size_t(std::uint64_t k, std::span<std::byte> out)>;
  Flood(const std::string& address, int per_ms, Make make)
      : server_(resolve(address, "test")),
        per_ms_(per_ms),
        make_(std::move(make)),
        thread_([this] { run(); }) {}
  ~Flood() { stop(); }
  std::uint64_t stop() {
    if (thread_.joinable()) {
      socket_.stop();
      thread_.join();
    }
    return sent_;
  }

 private:
  void run() {
    palpate::Doorbell bell;
    socket_.run(
        bell, 1ms,
        {.on_datagram = [](auto, const Endpoint&) {}, .on_doorbell = [] {}, .on_timer = [this] { burst(); }});
  }
  void burst() {
    std::array<std::byte, kMaxDatagram> bytes;
    for (int i = 0; i < per_ms_; ++i) socket_.send({bytes.data(), make_(sent_++, bytes)}, server_);
  }

  UdpSocket socket_{resolve("127.0.0.1:0", "test")};
  Endpoint server_;
  int per_ms_;
  Make make_;
  std::uint64_t sent_ = 0;
  std::thread thread_;
};

std::size_t garbage(std::uint64_t k, std::span<std::byte> out) {
  Random random(k);
  const std::size_t size = random.bits() % out.size();
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::byte>(random.bits());
  return size;
}

/// A Hello without a key, each of another client.
std::size_t greeting(std::uint64_t k, std::span<std::byte> out) {
  return encode({}, Hello{.nonce = {k, k}, .attempt = 1}, out);
}

/// A valid tool state of a session that is not.
std::size_t state(std::uint64_t k, std::span<std::byte> out) {
  return encode({k | 1, k + 1}, ToolState{.tick = k + 1}, out);
}

}  // namespace

TEST_CASE(
    "keys: an established session keeps its rate under floods, and a client that joins under one gets in",
    "[in_time]") {
  const KeyBench bench;
  for (const bool keyed : {false, true}) {
    const auto more = [&](std::vector<std::string> all) { return keyed ? bench.with_key(all) : all; };
    for (const Flood::Make& make : {Flood::Make(garbage), Flood::Make(greeting), Flood::Make(state)}) {
      const std::string capture = (bench.folder.path() / "S.pcap").string();
      Server server(more({"--report", bench.report, "--record", capture}));
      Flood flood(server.address, 20, make);  // 20 000 a second
      const std::string report = (bench.folder.path() / "client.json").string();
      output_of("haptic_client",
                client_arguments(server.address, more({"--seconds", "2", "--report", report})), 0);
      const std::uint64_t sent = flood.stop();
      CAPTURE(keyed, sent);
      CHECK(sent > 2000);
      const Json tool = read_json(report)["tools"][0];
#if !defined(PALPATE_SANITIZED)  // with them, a flood takes the server more time than there is
      CHECK(tool["motion"]["sample_rate_hz"].get<double>() > 0.9 * 30);
#endif
      server.process.signal(SIGINT);
      CHECK(server.process.wait() == 0);
      const Json link = read_json(bench.report)["link"];
      // Without a key Hellos of strangers are answered, and never kept.
      if (keyed) CHECK(link["rejected"].get<std::uint64_t>() > 0);
      CHECK(read_json(bench.report)["sessions"] == 1);
      // Its own datagrams take less than 2 MB, those of the flood 5 to 10 MB a second.
      CHECK(read_json(bench.report)["recording"]["bytes"].get<double>() < 4e6);
    }
  }
}
#endif

TEST_CASE("commtest: a good link on loopback passes, nobody there is exit 1, wrong use is exit 2",
          "[in_time]") {
  const TemporaryFolder folder;
  const std::string json = (folder.path() / "link.json").string();
  Server server;
  const std::string said = output_of("haptic_client",
                                     {"commtest", server.address, "--client", kClient, "--method",
                                      "two_tangents", "--seconds", "2", "--json", json},
                                     0, 30);
  CHECK_THAT(said, Catch::Contains("round trip") && Catch::Contains("is stable up to"));
  const Json report = read_json(json);
  CHECK(report["verdict"]["grade"] != "FAIL");
  // Five a second, which take at most 5 % of 256 kbit/s.
  const Json& trip = report["round_trip"];
  CHECK(trip["sent"].get<int>() > 5);
  CHECK(8 * (trip["bytes_up"].get<double>() + 28 * trip["sent"].get<double>()) <
        0.05 * 256e3 * report["seconds"].get<double>());
  CHECK_THAT(said, Catch::Contains("kbit/s up beside the session"));
  CHECK(trip["lost"].get<int>() == 0);
  CHECK(report["round_trip"]["ms"]["p50"].get<double>() < 5);
  CHECK(report["tool"]["link"]["stiffest_n_m"].get<double>() > 1);
  CHECK_THAT(output_of("haptic_client", {"commtest", "127.0.0.1:9", "--wait", "1"}, 1),
             Catch::Contains("nothing listens at 127.0.0.1:9"));
  output_of("haptic_client", {"commtest", "127.0.0.1:9", "--seconds", "0"}, 2);
  output_of("haptic_client", {"commtest", "--usb", "nothing"}, 2);
  CHECK_THAT(output_of("haptic_client", {"commtest", "--usb", "simulated", "--seconds", "1"}, 0),
             Catch::Contains(" usable\n"));
}

TEST_CASE(
    "another version: the server answers its Hello, and no more than that, with the version spoken here") {
  Server server;
  UdpSocket socket(resolve("127.0.0.1:0", "test"));
  const Endpoint to = resolve(server.address, "test");
  palpate::Doorbell bell;
  std::vector<Datagram> answers;
  int polls = 0;
  const auto send = [&](const Message& message) {
    std::array<std::byte, kMaxDatagram> bytes;
    const std::size_t size = encode({}, message, bytes);
    bytes[4] = std::byte{kProtocolVersion + 1};
    socket.send({bytes.data(), size}, to);
  };
  send(Hello{.nonce = {9}, .attempt = 1});
  send(ToolState{.tick = 1});
  socket.run(bell, 100ms,
             {.on_datagram =
                  [&](auto bytes, const Endpoint&) {
                    Datagram datagram;
                    CHECK(bytes.size() < kHeaderBytes + kHelloPayload);
                    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
                    answers.push_back(datagram);
                  },
              .on_doorbell = [] {},
              .on_timer =
                  [&] {
                    if (++polls == 5) socket.stop();
                  }});
  REQUIRE(answers.size() == 1);
  CHECK(std::get<Refuse>(answers[0].message).reason == RefuseReason::kVersion);
}

TEST_CASE("pages: what one ask names several times is sent once, and asks without end get a budget of them",
          "[in_time]") {
  Server server;
  UdpSocket socket(resolve("127.0.0.1:0", "test"));
  const Endpoint to = resolve(server.address, "test");
  ClientSession session(Nonce{5});
  LinkStats stats;
  palpate::Doorbell bell;
  std::uint32_t version = 0;
  std::uint64_t tick = 0, pages = 0;
  int phase = 0, asks = 0;
  std::vector<std::uint64_t> came{0, 0};
  const auto send = [&](const Message& message) {
    std::array<std::byte, kMaxDatagram> bytes;
    socket.send({bytes.data(), session.write(message, bytes)}, to);
  };
  const auto ask = [&](auto page_of) {
    ToolState state{.tick = ++tick, .t_ns = palpate::now().count(), .p_W = {0, 0.2, 0}};
    state.flags = ToolState::kRequestsSurface | (version != 0 ? ToolState::kAsksPages : 0);
    state.surface_version = version;
    for (std::uint32_t i = 0; i < 8; ++i) state.pages[i] = page_of(i);
    send(state);
  };
  socket.run(bell, 10ms,
             {.on_datagram =
                  [&](auto bytes, const Endpoint&) {
                    Datagram datagram;
                    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
                    const Message* const message = session.receive(datagram, palpate::now(), stats);
                    while (const auto hello = session.poll(palpate::now())) send(*hello);
                    if (message == nullptr) return;
                    if (const auto* sample = std::get_if<ForceSample>(message))
                      version = sample->surface.version;
                    pages += std::holds_alternative<SurfacePage>(*message) ? 1 : 0;
                  },
              .on_doorbell = [] {},
              .on_timer =
                  [&] {
                    while (const auto hello = session.poll(palpate::now())) send(*hello);
                    if (!session.welcomed()) return;
                    if (version == 0) return ask([](std::uint32_t) { return ToolState::kNoPage; });
                    if (phase == 0 && ++asks <= 10) return ask([](std::uint32_t) { return 3u; });
                    if (phase == 0 && asks == 20) {
                      came[0] = pages;
                      pages = 0;
                      phase = 1;
                      for (int i = 0; i < 500; ++i) ask([](std::uint32_t page) { return page; });
                    }
                    if (phase == 1 && ++asks == 60) {
                      came[1] = pages;
                      socket.stop();
                    }
                  }});
  CHECK(came[0] == 10);
  CHECK(came[1] >= 32);
  CHECK(came[1] < 500);  // of 4000, in some tens of milliseconds
}
