// Pages of the surface from the real server, on 127.0.0.1, and the real client that fetches them.
#include <optional>
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

/// A client that asks for the first eight pages of a surface.
class Asker {
 public:
  explicit Asker(const std::string& address, const Key& key = {})
      : server_(resolve(address, "test")), session_(Nonce{77}, key) {}

  /// Goes on from `socket` until eight pages or `samples` more samples came, 20 s at most.
  void run_at(UdpSocket& socket, std::uint64_t samples) {
    at_ = &socket;
    enough_ = samples_ + samples;
    palpate::Doorbell bell;
    socket.run(bell, 5ms,
               {.on_datagram = [this](auto bytes, const Endpoint&) { take(bytes); },
                .on_doorbell = [] {},
                .on_timer = [this] { tick(); }});
  }

  /// Asks in so many ticks for other pages, of a version that the server does not have.
  std::uint64_t wrong_ticks = 0;
  /// Tells which sample it used after so many more samples from now on, and not before, as a state would that
  /// somebody relays from an address that is not his.
  void tell_after(std::uint64_t samples) { told_after_ = samples_ + samples; }

  std::uint32_t version() const { return version_; }
  const std::set<std::uint32_t>& pages() const { return pages_; }
  std::optional<std::size_t> untold_pages() const { return untold_pages_; }  ///< that came before it told

 private:
  void take(std::span<const std::byte> bytes) {
    Datagram datagram;
    REQUIRE(decode(bytes, datagram) == Verdict::kAccepted);
    const Message* const message = session_.receive(datagram, palpate::now(), stats_);
    if (message == nullptr) return;
    if (const auto* sample = std::get_if<ForceSample>(message)) {
      version_ = sample->surface.version;
      newest_ = sample->number;
      ++samples_;
    }
    if (const auto* page = std::get_if<SurfacePage>(message)) {
      CHECK(page->version == version_);
      pages_.insert(page->page);
    }
  }
  void tick() {
    const palpate::Time now = palpate::now();
    if (const auto hello = session_.poll(now)) send(*hello);
    if (!session_.welcomed()) return;
    if (samples_ >= told_after_ && !untold_pages_) untold_pages_ = pages_.size();
    ToolState state{.tick = ++ticks_, .newest_sample = untold_pages_ ? newest_ : 0, .t_ns = now.count()};
    state.p_W = {-0.02, 0.1, 0};
    state.flags = ToolState::kRequestsSurface;
    if (version_ != 0) {
      const bool is_wrong = ++requests_ < wrong_ticks;
      state.flags |= ToolState::kAsksPages;
      state.surface_version = is_wrong ? version_ ^ 2 : version_;
      for (std::uint32_t i = 0; i < 8; ++i) state.pages[i] = (is_wrong ? 8 : 0) + i;
    }
    send(state);
    if ((version_ != 0 && samples_ >= enough_) || pages_.size() >= 8 || ticks_ > 4000) at_->stop();
  }
  void send(const Message& message) {
    std::array<std::byte, kMaxDatagram> bytes;
    at_->send({bytes.data(), session_.write(message, bytes)}, server_);
  }

  UdpSocket* at_ = nullptr;
  Endpoint server_;
  ClientSession session_;
  LinkStats stats_;
  std::uint64_t ticks_ = 0, requests_ = 0, newest_ = 0, samples_ = 0, enough_ = 0, told_after_ = 0;
  std::uint32_t version_ = 0;
  std::set<std::uint32_t> pages_;
  std::optional<std::size_t> untold_pages_;
};

}  // namespace

TEST_CASE("pages of a surface are those asked for, of the version that the server has, and of no other") {
  Server server;
  Asker asker(server.address);
  asker.wrong_ticks = 40;
  UdpSocket socket(resolve("127.0.0.1:0", "test"));
  asker.run_at(socket, 1000);
  CHECK(asker.version() != 0);
  CHECK(asker.pages() == std::set<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
}

TEST_CASE("pages go to a new address of a client once it has used a sample that was sent there") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "key").string();
  output_of("sim_server", {"keygen", file}, 0);
  Server server({"--key", file});
  Asker asker(server.address, read_keys(file).front());
  UdpSocket first(resolve("127.0.0.1:0", "test")), second(resolve("127.0.0.1:0", "test"));
  asker.tell_after(1000);
  asker.run_at(first, 1);
  REQUIRE(asker.version() != 0);
  REQUIRE(asker.pages().empty());
  asker.tell_after(10);  // forces come there at once
  asker.run_at(second, 1000);
  CHECK(asker.untold_pages() == 0);
  CHECK(asker.pages().size() == 8);
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
