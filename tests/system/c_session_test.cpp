// A session of the C interface in this process, and a real server, on 127.0.0.1.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <thread>

#include "common/clock.h"
#include "common/trajectory.h"
#include "protocol/c_interface/palpate.h"
#include "protocol/earlier_ticks.h"
#include "protocol/link_simulator.h"
#include "protocol/udp_socket.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using namespace std::chrono_literals;

namespace {

struct Session {
  palpate_session* session = nullptr;
  palpate_rendered rendered{};
  std::size_t allocations = 0;  // in ticks

  explicit Session(const std::string& address, const char* method = nullptr) {
    palpate_session_options options{};
    options.method = method;
    options.struct_size = sizeof options;
    options.server = address.c_str();
    char error[512];
    const int code = palpate_session_open(&options, &session, error, sizeof error);
    INFO(error);
    REQUIRE(code == PALPATE_OK);
    rendered.struct_size = sizeof rendered;
  }
  ~Session() { palpate_session_close(session); }

  double tick(double y, std::uint32_t flags = 0) { return tick(palpate::Vec3(0, y, 0), flags); }
  double tick(const palpate::Vec3& p, std::uint32_t flags = 0) {
    palpate_tool_state tool{};
    tool.struct_size = sizeof tool;
    tool.flags = flags;
    std::copy(p.begin(), p.end(), tool.position);
    const AllocationGuard guard;
    const int code = palpate_session_tick(session, &tool, &rendered);
    allocations += guard.count();
    REQUIRE(code == PALPATE_OK);
    return rendered.force[1];
  }
  /// The force after so many ticks there.
  double hold(double y, int ticks) {
    double newton = 0;
    for (int i = 0; i < ticks; ++i) {
      newton = tick(y);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return newton;
  }
};

std::string rigid_block(const TemporaryFolder& folder) {
  return folder
      .write("rigid.toml", std::string("[mesh]\nfile = \"") + source_dir() +
                               "/configs/meshes/block.msh\"\n[deformation]\nmodel = \"rigid\"\nstiffness = "
                               "500\n[[tool]]\nradius = 0.006\n")
      .string();
}

/// A line of so many kbit/s each way between a client and a server without a key. It counts the pages of the
/// surface that the client requests.
class NarrowLine {
 public:
  NarrowLine(const std::string& server, double kbit_s)
      : server_(palpate::protocol::resolve(server, "test")),
        up_({.delay = 0.01, .bandwidth = 1e3 * kbit_s / 8}, 1),
        down_({.delay = 0.01, .bandwidth = 1e3 * kbit_s / 8}, 2),
        thread_([this] {
          at_client_.run(bell_, 500us,
                         {.on_datagram = [this](auto bytes, const Endpoint& from) { take(bytes, from); },
                          .on_doorbell = [] {},
                          .on_timer = [this] { pass(); }});
        }) {}
  ~NarrowLine() {
    at_client_.stop();
    thread_.join();
  }
  std::string address() const { return palpate::protocol::to_string(at_client_.local()); }
  /// Pages requested so far.
  std::uint64_t requested() const { return requested_; }

 private:
  using Endpoint = palpate::protocol::Endpoint;
  using State = palpate::protocol::ToolState;

  void take(std::span<const std::byte> bytes, const Endpoint& from) {
    client_ = from;
    palpate::protocol::Datagram datagram;
    if (decode(bytes, datagram) == palpate::protocol::Verdict::kAccepted) {
      for (const State& state : palpate::protocol::ticks_of(datagram)) {
        if ((state.flags & State::kAsksPages) != 0)
          requested_ += static_cast<std::uint64_t>(
              std::ranges::count_if(state.pages, [](std::uint32_t page) { return page != State::kNoPage; }));
      }
    }
    up_.send(bytes, palpate::now());
    pass();
  }
  void pass() {
    while (const auto bytes = up_.receive(palpate::now())) at_server_.send(*bytes, server_);
    while (const auto bytes = down_.receive(palpate::now())) at_client_.send(*bytes, client_);
  }

  Endpoint server_, client_;
  palpate::protocol::LinkSimulator up_, down_;
  palpate::protocol::UdpSocket at_client_{palpate::protocol::resolve("127.0.0.1:0", "test")};
  palpate::protocol::UdpSocket at_server_{palpate::protocol::resolve("127.0.0.1:0", "test"), at_client_,
                                          [this](auto bytes, const Endpoint&) {
                                            down_.send(bytes, palpate::now());
                                            pass();
                                          }};
  std::atomic<std::uint64_t> requested_{0};
  palpate::Doorbell bell_;
  std::thread thread_;
};

/// What a session of the C interface gets of a hand that palpates the liver of `kScene` over such a line.
struct OverNarrowLine {
  double oldest = 0;    // s, age of a force once the first two seconds are over
  double largest = 0;   // N
  int silent = 0;       // ticks after that in which no force came for too long
  double pages_hz = 0;  // requested a second, in the last half
};

OverNarrowLine palpate_over(double kbit_s, int seconds) {
  const Server server;
  NarrowLine line(server.address, kbit_s);
  Session c(line.address(), "local_contact");
  const palpate::Trajectory motion(
      palpate::motion_settings(source_dir() + "/configs/trajectories/liver_paper.csv"));
  OverNarrowLine result;
  std::uint64_t first_half = 0;
  const palpate::Time start = palpate::now();
  for (int i = 0; i < 500 * seconds; ++i) {
    palpate::sleep_until(start + i * 2ms);
    result.largest = std::max(result.largest, std::abs(c.tick(motion.at(0.002 * i))));
    if (i == 250 * seconds) first_half = line.requested();
    if (i < 1000) continue;
    result.oldest = std::max(result.oldest, c.rendered.age);
    result.silent += c.rendered.state == PALPATE_SILENT ? 1 : 0;
  }
  result.pages_hz = static_cast<double>(line.requested() - first_half) / (0.5 * seconds);
  return result;
}

constexpr double kDeep = 0.004;  // m: 2 mm below the surface at 6 mm, of 500 N/m

}  // namespace

TEST_CASE("a session of the C interface: soft start, the wall's force, none where the device is lost") {
  const TemporaryFolder folder;
  Server server({}, "127.0.0.1:0", rigid_block(folder));
  Session c(server.address);
  CHECK(c.tick(kDeep) == 0);
  CHECK(c.rendered.state == PALPATE_WAITING);
  CHECK(c.rendered.age == -1);
  CHECK(c.hold(kDeep, 100) < 0.9);
  CHECK(c.hold(kDeep, 600) == Approx(1).epsilon(0.01));
  CHECK(c.rendered.state == PALPATE_LIVE);
  CHECK(c.rendered.normal[1] == Approx(1));
  CHECK(c.tick(kDeep, PALPATE_LOST) == 0);
  CHECK(c.tick(kDeep) < 0.1);
  CHECK(c.hold(kDeep, 700) == Approx(1).epsilon(0.01));
  CHECK(c.tick(std::nan("")) == 0);
  CHECK(c.rendered.fault == PALPATE_NO_FAULT);
  CHECK(palpate_session_rearm(c.session) == PALPATE_OK);
}

TEST_CASE(
    "a session of the C interface: when the server dies, the force fades, and a tick allocates nothing") {
  const TemporaryFolder folder;
  Server server({}, "127.0.0.1:0", rigid_block(folder));
  Session c(server.address);
  CHECK(c.hold(kDeep, 700) == Approx(1).epsilon(0.01));
  server.process.signal(SIGKILL);
  CHECK(c.hold(kDeep, 300) == 0);
  CHECK(c.rendered.state == PALPATE_SILENT);
  CHECK(c.rendered.law_newton > 0.5);
  CHECK(c.allocations == 0);
}

TEST_CASE("a session of the C interface over 256 kbit/s each way has a force that never fades") {
  const OverNarrowLine result = palpate_over(256, 12);
  CAPTURE(result.oldest, result.largest, result.pages_hz);
  CHECK(result.silent == 0);
  CHECK(result.largest > 0.1);
}
