// What the reports of a session say: of bytes that are of strangers, of a way that drops large datagrams, of
// the error of the mesh at both ends, and the threads that carry it.
#include <filesystem>
#include <sched.h>
#include <sys/resource.h>
#include <thread>

#include "common/clock.h"
#include "common/realtime.h"
#include "protocol/session.h"
#include "protocol/udp_socket.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using namespace palpate::protocol;
using namespace std::chrono_literals;
using Json = nlohmann::json;

namespace {

/// A server without a simulation, which answers a tick in 16 with a force; `surface`: it names a surface,
/// and sends no page of it. It runs until it goes.
class EmptyServer {
 public:
  explicit EmptyServer(bool surface) : surface_(surface) {
    thread_ = std::thread([this] {
      socket_.run(bell_, 20ms,
                  {.on_datagram = [this](auto bytes, const Endpoint& from) { take(bytes, from); },
                   .on_doorbell = [] {},
                   .on_timer = [] {}});
    });
  }
  ~EmptyServer() { stop(); }
  void stop() {
    if (!thread_.joinable()) return;
    socket_.stop();
    thread_.join();
  }
  std::string address() const { return to_string(socket_.local()); }
  std::size_t bytes() const { return bytes_; }                       ///< that it sent; after `stop`
  std::size_t bytes_of_strangers() const { return strange_bytes_; }  ///< that others sent to its client

 private:
  void take(std::span<const std::byte> bytes, const Endpoint& from) {
    Datagram datagram;
    if (decode(bytes, datagram) != Verdict::kAccepted) return;
    const auto outcome = sessions_.receive(datagram, from, palpate::now(), {7, {1}}, stats_);
    if (outcome.answer) send(outcome.answer->first, outcome.answer->second, from);
    if (outcome.tool_state == nullptr || outcome.tool_state->tick < answered_ + 16) return;
    answered_ = outcome.tool_state->tick;
    ForceSample sample{.number = ++samples_,
                       .tool_tick = outcome.tool_state->tick,
                       .tool_t_ns = outcome.tool_state->t_ns,
                       .p_W = outcome.tool_state->p_W};
    if (surface_) {
      sample.flags |= ForceSample::kHasSurface;
      sample.surface = {.version = 5, .vertices = 100, .triangles = 196, .tool_radius = 0.005};
    }
    auto& member = *sessions_.holder(0);
    const Header header{member.session, ++member.sent};
    send(header, sample, from);
    be_a_stranger(header, sample, from);
  }
  void send(const Header& header, const Message& message, const Endpoint& to) {
    std::array<std::byte, kMaxDatagram> out;
    const std::size_t size = encode(header, message, out);
    socket_.send({out.data(), size}, to);
    bytes_ += size;
  }
  /// Noise, and a sample of the very session, from another address.
  void be_a_stranger(const Header& header, const Message& message, const Endpoint& to) {
    std::array<std::byte, kMaxDatagram> out{};
    stranger_.send(out, to);
    const std::size_t size = encode({header.session, header.sequence + 1}, message, out);
    stranger_.send({out.data(), size}, to);
    strange_bytes_ += kMaxDatagram + size;
  }

  bool surface_;
  UdpSocket socket_{resolve("127.0.0.1:0", "test")}, stranger_{resolve("127.0.0.1:0", "test")};
  ServerSessions sessions_{30, {0.005}};
  LinkStats stats_;
  palpate::Doorbell bell_;
  std::thread thread_;
  std::uint64_t answered_ = 0, samples_ = 0;
  std::size_t bytes_ = 0, strange_bytes_ = 0;
};

/// How the system schedules a thread.
struct Scheduled {
  int priority = 0, nice = 0;
  bool operator==(const Scheduled&) const = default;
};

/// The threads of a process that have a name of ours.
std::map<std::string, Scheduled> threads_of(pid_t process) {
  std::map<std::string, Scheduled> threads;
  for (const auto& entry : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process))) {
    std::string name = bytes_of(entry.path() / "comm");
    if (!name.starts_with("palpate-")) continue;
    name.pop_back();  // the end of the line
    const auto number = static_cast<pid_t>(std::stol(entry.path().filename().string()));
    sched_param param{};
    sched_getparam(number, &param);
    threads[name] = {param.sched_priority, getpriority(PRIO_PROCESS, static_cast<id_t>(number))};
  }
  return threads;
}

/// True if this process, and so those that it starts, may have real-time priority.
bool may_be_realtime() {
  bool may = false;
  std::thread([&] { may = palpate::take_role(palpate::ThreadRole::kHaptic).empty(); }).join();
  return may;
}

}  // namespace

TEST_CASE("report: bytes of strangers at the client's port are none of the session's") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "report.json").string();
  EmptyServer server(false);
  output_of("haptic_client", client_arguments(server.address(), {"--seconds", "1", "--report", file}), 0);
  server.stop();
  const Json link = read_json(file)["tools"][0]["link"];
  CHECK(link["received"].get<int>() > 20);
  CHECK(link["rejected"].get<int>() > 20);
  CHECK(link["bytes_down"].get<std::size_t>() <= server.bytes());
  CHECK(link["bytes_down"].get<std::size_t>() > server.bytes() / 2);
  CHECK(server.bytes_of_strangers() > 5 * server.bytes());
}

TEST_CASE("run: pages that were requested and never come are told, with the cause and what helps") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "report.json").string();
  EmptyServer server(true);
  const std::string said = output_of(
      "haptic_client",
      client_arguments(server.address(), {"--method", "local_contact", "--seconds", "4.5", "--report", file}),
      0);
  for (const char* part : {"datagrams of 937 bytes do not get through", "IP fragments",
                           "ip link set dev IF mtu 1280", "--method two_tangents", "  narrow  "})
    CHECK_THAT(said, Catch::Contains(part));
  CHECK(said.find("937 bytes") != said.rfind("937 bytes"));  // while it runs, and in the report
  CHECK(read_json(file)["tools"][0]["link"]["drops_large"] == true);
}

TEST_CASE("report: client and server tell one error of the mesh of one session") {
  const TemporaryFolder folder;
  const std::string here = (folder.path() / "client.json").string(),
                    there = (folder.path() / "server.json").string();
  Server server({"--report", there});
  output_of("haptic_client", client_arguments(server.address, {"--seconds", "6", "--report", here}), 0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  const Json felt = read_json(here)["tools"][0]["rendered"], made = read_json(there)["tools"][0]["rendered"];
  REQUIRE(felt["mesh_percent"].is_number());
  CHECK(felt["mesh_percent"].get<double>() == Approx(made["mesh_percent"].get<double>()));
  CHECK(felt["motion_percent"].get<double>() == Approx(made["motion_percent"].get<double>()));
}

TEST_CASE("threads of both programs ask for the priorities of their roles") {
  using palpate::ThreadRole;
  Server server({"--viewer", "0"});
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "20"}));
  REQUIRE(client.wait_for("connected to"));
  const auto expected = [realtime = may_be_realtime()](ThreadRole role) {
    const palpate::ThreadRow& row = palpate::row_of(role);
    const int own = getpriority(PRIO_PROCESS, static_cast<id_t>(getpid()));
    return Scheduled{realtime ? row.realtime : 0, std::min(own + row.nice, 19)};
  };
  const auto name = [](ThreadRole role) { return std::string(palpate::row_of(role).name); };
  std::map<std::string, Scheduled> of_client, of_server = threads_of(server.process.id());
  const palpate::Time patience = palpate::now() + 5s;
  while (!of_client.contains(name(ThreadRole::kHaptic)) && palpate::now() < patience)
    of_client = threads_of(client.id());
  of_client = threads_of(client.id());
  for (const ThreadRole role : {ThreadRole::kHaptic, ThreadRole::kNetwork}) {
    REQUIRE(of_client.contains(name(role)));
    CHECK(of_client[name(role)] == expected(role));
  }
  for (const ThreadRole role : {ThreadRole::kNetwork, ThreadRole::kSimulation, ThreadRole::kPage}) {
    REQUIRE(of_server.contains(name(role)));
    CHECK(of_server[name(role)] == expected(role));
  }
}
