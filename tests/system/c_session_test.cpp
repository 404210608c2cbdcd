// A session of the C interface in this process, and a real server, on 127.0.0.1.
#include <cmath>
#include <csignal>
#include <thread>

#include "protocol/c_interface/palpate.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

struct Session {
  palpate_session* session = nullptr;
  palpate_rendered rendered{};
  std::size_t allocations = 0;  // in ticks

  explicit Session(const std::string& address) {
    palpate_session_options options{};
    options.struct_size = sizeof options;
    options.server = address.c_str();
    char error[512];
    const int code = palpate_session_open(&options, &session, error, sizeof error);
    INFO(error);
    REQUIRE(code == PALPATE_OK);
    rendered.struct_size = sizeof rendered;
  }
  ~Session() { palpate_session_close(session); }

  double tick(double y, std::uint32_t flags = 0) {
    palpate_tool_state tool{};
    tool.struct_size = sizeof tool;
    tool.flags = flags;
    tool.position[1] = y;
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
