// Two emulated devices in one client, through the real libusb: each a tool of its own.
#include <csignal>

#include "tests/support/falcon_bench.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// The wall of the bench with two tools.
std::string two_tools(Bench& bench) {
  std::string scene = bytes_of(bench.scene);
  return bench.folder.write("two.toml", scene + "[[tool]]\nradius = 0.005\n").string();
}

struct Pair {
  Bench bench;
  Wall wall;
  std::string report = (bench.folder.path() / "report.json").string();
  Emulator usb;
  Pair(const std::vector<std::string>& devices, const std::vector<std::string>& more)
      : wall(two_tools(bench)), usb(devices, more) {}
  std::unique_ptr<Process> start(const std::vector<std::string>& devices) {
    std::vector<std::string> arguments{"run", bench.client, "--server", wall.address, "--report", report};
    for (const std::string& device : devices) arguments.insert(arguments.end(), {"--device", device});
    return usb.start("haptic_client", arguments);
  }
};

double push(const Json& state) {
  return state["force"][2].get<double>();
}

}  // namespace

TEST_CASE("two Falcons: each feels its own wall only, one is unplugged, and the other does not notice") {
  Pair pair({"falcon:2-1", "falcon:3-2"}, {"--loaded", "--homed"});
  for (const std::string port : {"2-1", "3-2"}) {
    pair.usb.command("hand " + port + " stiffness 400 damping 8 mass 0.2");
    pair.usb.command("hand " + port + " place 0 0 0.13");
  }
  auto client = pair.start({"falcon:2-1", "falcon:3-2"});
  for (const std::string said : {"tool 1 (falcon:2-1): Falcon homed", "tool 2 (falcon:3-2): Falcon homed"})
    REQUIRE(client->wait_for(said));
  pair.usb.command("hand 2-1 target 0 0 0.10 1");
  REQUIRE(pair.usb.wait_for("2-1", [](const Json& s) { return std::abs(push(s) / 5.3333 - 1) < 0.02; }));
  CHECK(pair.usb.state("3-2")["largest_dac"] == 0);  // nothing crossed over
  pair.usb.command("hand 3-2 target 0 0 0.11 1");    // 400 N/m x 10 mm against 800 N/m: 2.67 N
  REQUIRE(pair.usb.wait_for("3-2", [](const Json& s) { return std::abs(push(s) / 2.6667 - 1) < 0.02; }));
  CHECK(push(pair.usb.state("2-1")) == Approx(5.3333).epsilon(0.02));

  const auto packets = [&] { return pair.usb.state("3-2")["packets"].get<int>(); };
  pair.usb.command("unplug 2-1");
  REQUIRE(client->wait_for("tool 1 (falcon:2-1): the Falcon was unplugged"));
  const int before = packets();
  for (int i = 0; i < 50; ++i) {
    const Json other = pair.usb.state("3-2");
    CHECK(push(other) == Approx(2.6667).epsilon(0.05));
    CHECK(other["green"] == true);
  }
  CHECK(pair.usb.wait_for(
      "3-2", [&](const Json& s) { return s["packets"].get<int>() > before + 500; }, 2));
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
  CHECK(client->output().find("tool 2 (falcon:3-2): the Falcon") == std::string::npos);

  const Json tools = read_json(pair.report)["tools"];
  REQUIRE(tools.size() == 2);
  CHECK(tools[0]["port"] == "2-1");
  CHECK(tools[1]["port"] == "3-2");
  CHECK(tools[0]["safety"]["lost"] > 0);
  for (const Json& tool : tools) {
    CHECK(tool["loop"]["ticks"].get<int>() > 1000);
    CHECK(tool["link"]["received"].get<int>() > 100);
    CHECK(tool["safety"]["storms"] == 0);
  }
}

TEST_CASE("a Falcon and a SpaceMouse: the mouse moves its tool, the Falcon alone feels") {
  Pair pair({"falcon:2-1", "spacemouse:1-1"}, {"--loaded", "--homed"});
  pair.usb.command("hand 2-1 place 0 0 0.13");
  auto client = pair.start({"falcon:2-1", "spacemouse"});
  REQUIRE(client->wait_for("Falcon homed"));
  REQUIRE(pair.usb.wait_for("1-1", [](const Json& s) { return s["led"] == true; }));
  pair.usb.command("mouse 1-1 350 0 0 0 0 0");
  REQUIRE(pair.usb.wait_for("1-1", [](const Json& s) { return s["reports"].get<int>() > 100; }));
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
  const Json tools = read_json(pair.report)["tools"];
  CHECK(tools[1]["device"] == "spacemouse");
  CHECK(tools[1]["motion"]["max_speed_m_s"].get<double>() > 0.05);
  CHECK(tools[0]["motion"]["max_speed_m_s"].get<double>() < 0.02);
  CHECK(pair.usb.state("2-1")["largest_dac"] == 0);
}

TEST_CASE("two devices that cannot be told apart, or a tool too many: one line, nothing moved") {
  const auto refused = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return output_of("haptic_client", arguments, 2);
  };
  CHECK(refused({"--device", "falcon", "--device", "falcon:2-1"}).find("each needs its port") !=
        std::string::npos);
  CHECK(refused({"--device", "falcon:2-1", "--device", "falcon:2-1"}).find("the same device falcon:2-1") !=
        std::string::npos);
  const TemporaryFolder folder;
  const std::string at_tool = folder.write("a.toml", "server = \"127.0.0.1:1\"\n").string(),
                    there = folder.write("b.toml", "server = \"127.0.0.1:2\"\n").string();
  CHECK(refused({at_tool, there}).find("b.toml:1: server \"127.0.0.1:2\"") != std::string::npos);
  CHECK(refused({at_tool, at_tool, "--device", "simulated"}).find("2 client files, but 1 --device") !=
        std::string::npos);
  const Server one_tool;
  CHECK(output_of("haptic_client",
                  {"run", "--server", one_tool.address, "--device", "simulated", "--device", "simulated"}, 1)
            .find("has no free tool") != std::string::npos);
}
