// Emulated 3Dconnexion mice, through the real libusb and both real programs: they palpate the liver.
#include <csignal>
#include <sstream>

#include "tests/emulation/emulator.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

const std::string kMouseClient = source_dir() + "/configs/clients/spacemouse.toml";
constexpr double kStart[] = {-0.03, 0.09, 0.01};  // m, of that file
constexpr double kSpeed = 0.05;                   // m/s, of that file

/// Positions of the tool, world, a row a tick.
std::vector<std::array<double, 3>> positions(const std::filesystem::path& trace) {
  std::vector<std::array<double, 3>> rows;
  std::istringstream in(bytes_of(trace));
  std::string line;
  std::getline(in, line);
  REQUIRE(line.rfind("tick,t_s,px_m,py_m,pz_m", 0) == 0);
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::array<double, 5> numbers{};
    for (double& number : numbers) {
      row >> number;
      row.ignore(1);
    }
    rows.push_back({numbers[2], numbers[3], numbers[4]});
  }
  return rows;
}

/// Waits for so many reports of a mouse: 125 a second, or twice that of one with two reports.
bool reports_more(const Emulator& mice, const std::string& port, int reports) {
  const int before = mice.state(port)["reports"].get<int>();
  return mice.wait_for(port, [&](const Json& s) { return s["reports"].get<int>() >= before + reports; });
}

struct Session {
  TemporaryFolder folder;
  std::filesystem::path trace = folder.path() / "trace.csv", report = folder.path() / "report.json";
  std::vector<std::string> arguments(const std::string& device, const std::string& server) const {
    return {"run",  kMouseClient, "--device",     device,     "--server",
            server, "--trace",    trace.string(), "--report", report.string()};
  }
};

}  // namespace

TEST_CASE(
    "SpaceMouse: reports of 7 and of 13 bytes, and of a second interface, move the tool, the light is on "
    "meanwhile") {
  Server server;
  Emulator mice({"spacemouse:1-1", "spacemouse13:1-2", "spacemouse_receiver:1-3"});
  for (const std::string port : {"1-1", "1-2", "1-3"}) {
    CAPTURE(port);
    const std::string other = port == "1-1" ? "1-2" : "1-1";
    const Session session;
    auto client = mice.start("haptic_client", session.arguments("spacemouse:" + port, server.address));
    REQUIRE(client->wait_for("SpaceMouse ready"));
    REQUIRE(mice.wait_for(port, [](const Json& s) { return s["led"] == true; }));
    CHECK(mice.state(other)["led"] == false);
    CHECK(mice.command("driver " + port) == "usbfs");
    mice.command("mouse " + port + " 0 0 350 0 0 0");  // down, into the liver
    REQUIRE(reports_more(mice, port, 150));
    mice.command("mouse " + port + " -350 0 0 200 200 200");  // left, turned as well
    REQUIRE(reports_more(mice, port, 50));
    mice.command("mouse " + port + " 0 0 0 0 0 0");
    client->signal(SIGINT);
    CHECK(client->wait() == 0);
    CHECK(mice.state(port)["led"] == false);
    CHECK(mice.command("driver " + port) == "usbhid");
    const auto path = positions(session.trace);
    REQUIRE(path.size() > 100);
    CHECK(path.front() == std::array{kStart[0], kStart[1], kStart[2]});
    CHECK(path.back()[0] < kStart[0] - 0.005);
    CHECK(path.back()[1] < kStart[1] - 0.015);
    CHECK(path.back()[2] == kStart[2]);
    CHECK(read_json(session.report)["tools"][0]["force"]["max_newton"].get<double>() > 0);
  }
}

TEST_CASE("SpaceMouse: unplugged in motion and back, the tool goes on where it was") {
  Server server;
  Emulator mice({"spacemouse:1-1"});
  const Session session;
  auto client = mice.start("haptic_client", session.arguments("spacemouse", server.address));
  REQUIRE(client->wait_for("SpaceMouse ready"));
  mice.command("mouse 1-1 350 0 0 0 0 0");
  REQUIRE(reports_more(mice, "1-1", 60));
  mice.command("unplug 1-1");
  REQUIRE(client->wait_for("the SpaceMouse was unplugged"));
  mice.command("plug 1-1");
  REQUIRE(mice.wait_for("1-1", [](const Json& s) { return s["led"] == true; }));
  REQUIRE(reports_more(mice, "1-1", 60));
  mice.command("mouse 1-1 0 0 0 0 0 0");
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
  const auto path = positions(session.trace);
  CHECK(path.back()[0] > kStart[0] + 0.4 * kSpeed);  // half a second of motion at least
  double largest = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    largest = std::max(largest, std::abs(path[i][0] - path[i - 1][0]));
  CHECK(largest <= kSpeed * 0.1);  // the most that a silence, or a stalled loop, counts
}

TEST_CASE("SpaceMouse: locked, and the rule that is printed is the one that ships") {
  Emulator mice({"spacemouse:1-1", "spacemouse13:1-2", "falcon:2-1"});
  for (const char* port : {"1-1", "1-2"}) mice.command(std::string("fault ") + port + " permission");
  auto list = mice.start("haptic_client", {"devices"});
  CHECK(list->wait() == 0);
  const std::string said = list->output();
  CAPTURE(said);
  CHECK(said.find("SpaceNavigator ") != std::string::npos);
  CHECK(said.find("SpaceMouse Wireless ") != std::string::npos);
  CHECK(said.find("--device spacemouse:1-1    no permission") != std::string::npos);
  std::istringstream rules(bytes_of(source_dir() + "/configs/udev/70-palpate.rules"));
  int found = 0;
  for (std::string rule; std::getline(rules, rule);) {
    if (rule.empty() || rule[0] == '#') continue;
    const bool falcon = rule.find("\"0403\"") != std::string::npos;  // is not locked
    CHECK((said.find(rule) != std::string::npos) == !falcon);
    ++found;
  }
  CHECK(found == 3);
}
