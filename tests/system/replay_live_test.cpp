// Captures from elsewhere, played to real programs in real time.
#ifdef PALPATE_WITH_CAPTURE
#include <csignal>

#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// Three seconds of the motion that ships, pressed into the liver in virtual time.
struct Recorded {
  TemporaryFolder folder;
  std::string file = path("F.pcap");
  double max_newton = 0;

  Recorded() {
    output_of("sim_server",
              {"record", kScene, "--trajectory", kClient, "--rate", "33.3", "--seconds", "3", "--out", file,
               "--report", path("record.json")},
              0);
    max_newton = read_json(path("record.json"))["max_newton"].get<double>();
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
};

}  // namespace

TEST_CASE("replay --live: the captured tool presses the live organ as it pressed the recorded one",
          "[in_time]") {
  const Recorded recorded;
  Server server({"--report", recorded.path("server.json")});
  output_of("haptic_client",
            {"replay", "--live", recorded.file, "--to", server.address, "--method", "two_tangents",
             "--report", recorded.path("client.json")},
            0);
  server.process.signal(SIGINT);
  REQUIRE(server.process.wait() == 0);
  REQUIRE(recorded.max_newton > 0.1);
  // Its steps are at other places of the same path, 15 mm/s and 30 ms apart.
  CHECK(read_json(recorded.path("server.json"))["max_newton"].get<double>() ==
        Approx(recorded.max_newton).epsilon(0.05));
  const Json tool = read_json(recorded.path("client.json"))["tools"][0];
  CHECK(tool["loop"]["ticks"].get<int>() > 1400);
  CHECK(tool["force"]["max_newton"].get<double>() == Approx(recorded.max_newton).epsilon(0.05));
}

TEST_CASE(
    "replay --serve: a live client feels the captured forces in their own time, and the player ends with "
    "them",
    "[in_time]") {
  const Recorded recorded;
  Process player("sim_server", {"replay", "--serve", recorded.file, "--listen", "127.0.0.1:0"});
  REQUIRE(player.wait_for("listening on "));
  const std::string& said = player.output();
  const std::size_t begin = said.find("listening on ") + 13;
  const std::string address = said.substr(begin, said.find(' ', begin) - begin);
  // A hand that rests: a law that holds the force feels exactly those that came, over their soft start.
  const std::string report = recorded.path("felt.json");
  output_of("haptic_client",
            {"run", "--server", address, "--method", "constant", "--seconds", "4", "--report", report}, 0);
  CHECK(player.wait() == 0);
  CHECK(player.output().find("played 100 of 100 forces") != std::string::npos);
  const Json tool = read_json(report)["tools"][0];
  CHECK(tool["force"]["samples"].get<int>() >= 95);
  CHECK(tool["force"]["max_newton"].get<double>() > 0.5 * recorded.max_newton);
  CHECK(tool["force"]["max_newton"].get<double>() < 1.01 * recorded.max_newton);
}

TEST_CASE("replay of nothing, or without what it needs: one line, exit 2") {
  const Recorded recorded;
  const std::string text = recorded.folder.write("text.pcap", "this is no capture at all, but text").string();
  CHECK_THAT(output_of("sim_server", {"replay", "--serve", text}, 2), Catch::Contains("is not a capture"));
  CHECK_THAT(output_of("haptic_client", {"replay", "--live", text}, 2), Catch::Contains("is not a capture"));
  output_of("haptic_client", {"replay", recorded.file, "--to", "127.0.0.1:9"}, 2);
  CHECK_THAT(output_of("haptic_client", {"replay", "--live", recorded.file, "--rate", "100"}, 2),
             Catch::Contains("--rate"));
}
#endif
