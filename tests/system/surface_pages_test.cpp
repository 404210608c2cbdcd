// Pages of the surface from the real server, on 127.0.0.1, and the real client that fetches them.
#include <set>

#include "common/clock.h"
#include "protocol/key_file.h"
#include "protocol/udp_socket.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using namespace palpate::protocol;
using namespace std::chrono_literals;
using Json = nlohmann::json;

namespace {

/// A client that asks first for pages of a version that the server does not have, then of the one it has.
struct Asker {
  explicit Asker(const std::string& address) : server(resolve(address, "test")) {}

  void run() {
    palpate::Doorbell bell;
    socket.run(bell, 5ms,
               {.on_datagram = [this](auto bytes, const Endpoint&) { take(bytes); },
                .on_doorbell = [] {},
                .on_timer = [this] { tick(); }});
  }
  void take(std::span<const std::byte> bytes) {
    Datagram datagram;
    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
    const Message* const message = session.receive(datagram, palpate::now(), stats);
    if (message == nullptr) return;
    if (const auto* sample = std::get_if<ForceSample>(message)) version = sample->surface.version;
    if (const auto* page = std::get_if<SurfacePage>(message)) {
      CHECK(page->version == version);
      came.insert(page->page);
    }
  }
  void tick() {
    const palpate::Time now = palpate::now();
    if (const auto hello = session.poll(now)) send(*hello);
    if (!session.welcomed()) return;
    ToolState state{.tick = ++ticks, .t_ns = now.count(), .p_W = {-0.02, 0.1, 0}};
    state.flags = ToolState::kRequestsSurface;
    if (version != 0) {
      const bool wrong = ++requested < 40;
      state.flags |= ToolState::kAsksPages;
      state.surface_version = wrong ? version ^ 2 : version;
      for (std::uint32_t i = 0; i < 8; ++i) state.pages[i] = (wrong ? 8 : 0) + i;
    }
    send(state);
    if (came.size() >= 8 || ticks > 2000) socket.stop();
  }
  void send(const Message& message) {
    std::array<std::byte, kMaxDatagram> bytes;
    socket.send({bytes.data(), session.write(message, bytes)}, server);
  }

  UdpSocket socket{resolve("127.0.0.1:0", "test")};
  Endpoint server;
  ClientSession session{Nonce{77}};
  LinkStats stats;
  std::uint64_t ticks = 0, requested = 0;
  std::uint32_t version = 0;
  std::set<std::uint32_t> came;
};

}  // namespace

TEST_CASE("pages of a surface are those asked for, of the version that the server has, and of no other") {
  Server server;
  Asker asker(server.address);
  asker.run();
  CHECK(asker.version != 0);
  CHECK(asker.came == std::set<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
}

namespace {

/// A client with a key that moves to another address once it knows the version of the surface. It first
/// reports no sample that was sent there, as a state would that somebody relays from an address that is not
/// his.
struct Mover {
  explicit Mover(const std::string& address, const Key& key)
      : server(resolve(address, "test")), session(Nonce{78}, key) {}

  void run_at(UdpSocket& socket) {
    at = &socket;
    palpate::Doorbell bell;
    socket.run(bell, 5ms,
               {.on_datagram = [this](auto bytes, const Endpoint&) { take(bytes); },
                .on_doorbell = [] {},
                .on_timer = [this] { tick(); }});
  }
  void take(std::span<const std::byte> bytes) {
    Datagram datagram;
    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
    const Message* const message = session.receive(datagram, palpate::now(), stats);
    if (message == nullptr) return;
    pages += std::holds_alternative<SurfacePage>(*message) ? 1 : 0;
    const auto* const sample = std::get_if<ForceSample>(message);
    if (sample == nullptr) return;
    version = sample->surface.version;
    ++samples, newest = sample->number;
  }
  void tick() {
    const palpate::Time now = palpate::now();
    if (const auto hello = session.poll(now)) send(*hello);
    if (!session.welcomed()) return;
    ToolState state{.tick = ++ticks, .newest_sample = pages_untold ? newest : 0, .t_ns = now.count()};
    state.p_W = {-0.02, 0.1, 0};
    state.flags = ToolState::kRequestsSurface;
    if (version != 0) {
      state.flags |= ToolState::kAsksPages;
      state.surface_version = version;
      for (std::uint32_t i = 0; i < 8; ++i) state.pages[i] = i;
    }
    send(state);
    if (samples >= told_after && !pages_untold) pages_untold = pages;
    if ((version != 0 && samples >= enough) || pages >= 8 || ticks > 4000) at->stop();
  }
  void send(const Message& message) {
    std::array<std::byte, kMaxDatagram> bytes;
    at->send({bytes.data(), session.write(message, bytes)}, server);
  }

  UdpSocket* at = nullptr;
  Endpoint server;
  ClientSession session;
  LinkStats stats;
  std::uint64_t ticks = 0, newest = 0, samples = 0, enough = 1;
  std::uint32_t version = 0;
  int pages = 0;
  std::uint64_t told_after = 1000;  ///< samples; from then on it reports them
  std::optional<int> pages_untold;  ///< that came before that
};

}  // namespace

TEST_CASE("pages go to a new address of a client once it has used a sample that was sent there") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "key").string();
  output_of("sim_server", {"keygen", file}, 0);
  Server server({"--key", file});
  Mover mover(server.address, read_keys(file).front());
  UdpSocket first(resolve("127.0.0.1:0", "test")), second(resolve("127.0.0.1:0", "test"));
  mover.run_at(first);
  REQUIRE(mover.version != 0);
  REQUIRE(mover.pages == 0);
  mover.told_after = mover.samples + 10;  // forces come there at once
  mover.enough = 1000;
  mover.run_at(second);
  CHECK(mover.pages_untold == 0);
  CHECK(mover.pages >= 8);
}

TEST_CASE("a session on a liver that tells its surface: its pages come, and the law solves contact with them",
          "[in_time]") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "report.json").string();
  Server server;
  Process client("haptic_client", client_arguments(server.address, {"--method", "local_contact", "--seconds",
                                                                    "5", "--report", file}));
  CHECK(client.wait() == 0);
  const Json tool = read_json(file)["tools"][0];
  CHECK(tool["method"] == "local_contact");
  CHECK(tool["force"]["surface_pages"].get<int>() > 100);
  // So were they all in the last half, they would still be fewer than half of that.
  CHECK(tool["force"]["stepped_down"].get<double>() < 0.25 * tool["loop"]["ticks"].get<double>());
  CHECK(tool["force"]["max_newton"].get<double>() > 0.2);
}
