// One server with two tools, a client program on each.
#include <csignal>
#include <thread>

#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

TEST_CASE("two clients on one liver: each holds a tool, one leaves and the other goes on") {
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  const std::string scene = source_dir() + "/configs/scenes/liver_two_tools.toml";
  Process server("sim_server", {"run", scene, "--listen", "127.0.0.1:0", "--report", file("server.json")});
  REQUIRE(server.wait_for("listening on "));
  const std::string& said = server.output();
  const std::size_t begin = said.find("listening on ") + 13;
  const std::string address = said.substr(begin, said.find(' ', begin) - begin);

  Process first("haptic_client",
                client_arguments(address, {"--seconds", "6", "--report", file("first.json")}));
  REQUIRE(server.wait_for("a client took tool 1 of 2"));
  // A second that presses at another place, and is killed.
  folder.write("press.csv", "t_s,x_m,y_m,z_m\n0,0.02,0.10,0\n1,0.02,0.065,0\n2,0.02,0.065,0.00001\n");
  const auto config =
      folder.write("client.toml", "server = \"" + address + "\"\n[trajectory]\nfile = \"press.csv\"\n");
  Process second("haptic_client", {"run", config.string(), "--seconds", "60"});
  REQUIRE(server.wait_for("a client took tool 2 of 2"));
  std::this_thread::sleep_for(std::chrono::milliseconds(2000));  // down, and pressing
  second.signal(SIGKILL);
  REQUIRE(server.wait_for("the client is gone; tool 2 of 2 is free", 2));
  CHECK(server.output().find("tool 1 of 2 is free") == std::string::npos);
  CHECK(first.wait() == 0);
  CHECK(first.output().find("force goes to zero") == std::string::npos);
  CHECK(server.wait_for("the client is gone; tool 1 of 2 is free", 2));
  server.signal(SIGINT);
  CHECK(server.wait() == 0);

  const Json report = read_json(file("server.json"));
  REQUIRE(report["tools"].size() == 2);
  double most = 0;
  for (const Json& tool : report["tools"]) {
    CHECK(tool["radius_m"] == 0.005);
    CHECK(tool["sessions"] == 1);
    CHECK(tool["contact_steps"].get<int>() > 10);
    most = std::max(most, tool["max_newton"].get<double>());
  }
  CHECK(report["sessions"] == 2);
  CHECK(report["max_newton"].get<double>() == most);
  CHECK(report["memory_bytes"].contains("contact of tool 2"));
}
