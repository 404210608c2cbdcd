// An emulated Novint Falcon in the hand, through the real libusb and both real programs.
#include <csignal>

#include "tests/support/falcon_bench.h"
#include "tests/support/paths.h"

using namespace palpate::test;
using Json = nlohmann::json;

TEST_CASE("Falcon: firmware, homing, then a wall of 800 N/m under a hand of 400 N/m") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcon({"falcon:2-1"});
  falcon.command("hand 2-1 stiffness 400 damping 8 mass 0.2");
  falcon.command("hand 2-1 target 0 0 0.13");
  const std::string report = (bench.folder.path() / "report.json").string();
  auto client = falcon.start("haptic_client", {"run", bench.client, "--server", wall.address, "--seconds",
                                               "25", "--report", report});
  REQUIRE(client->wait_for("pull the grip fully out"));
  CHECK(falcon.state("2-1")["loaded"] == true);
  CHECK(falcon.state("2-1")["red"] == true);
  falcon.command("homing 2-1 home");
  REQUIRE(client->wait_for("Falcon homed: ready"));
  REQUIRE(
      falcon.wait_for("2-1", [](const Json& s) { return s["hand_at_rest"] == true && s["green"] == true; }));
  CHECK(falcon.state("2-1")["largest_dac_unhomed"] == 0);
  // 20 mm into the wall: 400 (20 mm - x) = 800 x, so x = 6.67 mm and F = 5.33 N.
  falcon.command("hand 2-1 target 0 0 0.10 3");
  double depth = 0, force = 0;
  const bool settled = falcon.wait_for(
      "2-1",
      [&](const Json& s) {
        depth = 0.120 - s["position"][2].get<double>();
        force = s["force"][2].get<double>();
        return std::abs(depth / 0.0066667 - 1) < 0.01 && std::abs(force / 5.3333 - 1) < 0.01 &&
               std::abs(s["velocity"][2].get<double>()) < 1e-3;
      },
      12);
  CAPTURE(depth, force);
  CHECK(settled);
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
  const Json state = falcon.state("2-1");
  CHECK(state["dac"] == Json({0, 0, 0}));  // the last word is zero
  CHECK(state["largest_dac"] <= kGoodCount);
  const Json tool = read_json(report)["tools"][0];
  CHECK(tool["safety"]["not_finite"] == 0);
  CHECK(tool["safety"]["storms"] == 0);
  CHECK(tool["safety"]["lost"] > 0);  // until it was homed
  CHECK(tool["force"]["max_newton"].get<double>() <= 8);
}

TEST_CASE("Falcon: a loader that needs three tries, spoilt echoes, split replies and rubbish are got over") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcon({"falcon:2-1"});
  for (const char* fault :
       {"loader_silent 3", "loader_xoff", "echo_corrupt 2", "split", "garbage 5", "status_flood 3"})
    falcon.command(std::string("fault 2-1 ") + fault);
  auto client = falcon.start("haptic_client", {"run", bench.client, "--server", wall.address});
  REQUIRE(client->wait_for("pull the grip fully out"));
  falcon.command("homing 2-1 now");
  REQUIRE(client->wait_for("Falcon homed: ready"));
  CHECK(falcon.state("2-1")["resets"].get<int>() >= 3);
  CHECK(falcon.state("2-1")["largest_dac_unhomed"] == 0);
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
}

TEST_CASE(
    "Falcon: unplugged, silent, and back: no force meanwhile, said once, home again before any torque") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcon({"falcon:2-1"});
  auto client = falcon.start("haptic_client", {"run", bench.client, "--server", wall.address});
  REQUIRE(client->wait_for("pull the grip fully out"));
  falcon.command("unplug 2-1");  // before it is homed
  REQUIRE(client->wait_for("the Falcon was unplugged"));
  falcon.command("plug 2-1");
  REQUIRE(falcon.wait_for("2-1", [](const Json& s) { return s["red"] == true; }));
  falcon.command("homing 2-1 now");
  REQUIRE(client->wait_for("Falcon homed: ready"));
  falcon.command("unplug 2-1");  // in the hand
  falcon.command("plug 2-1");
  REQUIRE(falcon.wait_for("2-1", [](const Json& s) { return s["red"] == true && !homed(s); }));
  falcon.command("homing 2-1 now");
  REQUIRE(falcon.wait_for("2-1", [](const Json& s) { return s["green"] == true; }));
  falcon.command("fault 2-1 mute");
  REQUIRE(client->wait_for("stopped answering"));
  falcon.command("fault 2-1 mute 0");
  REQUIRE(falcon.wait_for("2-1", [](const Json& s) { return s["green"] == true || s["red"] == true; }));
  CHECK(falcon.state("2-1")["largest_dac_unhomed"] == 0);
  CHECK(client->running());
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
}

TEST_CASE("Falcon: no firmware, no permission, no image: each says what to do") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcon({"falcon:2-1"});
  auto bare = falcon.start("haptic_client", {"run", "--device", "falcon", "--server", wall.address});
  CHECK(bare->wait_for("--falcon-firmware PATH"));
  bare->signal(SIGINT);
  CHECK(bare->wait() == 0);
  falcon.command("fault 2-1 permission");
  auto locked = falcon.start("haptic_client", {"run", bench.client, "--server", wall.address});
  CHECK(locked->wait_for("no permission for the USB device"));
  locked->signal(SIGINT);
  CHECK(locked->wait() == 0);
  CHECK(output_of("haptic_client", {"run", "--device", "falcon", "--falcon-firmware", "none.bin"}, 2)
            .find("none.bin: no such firmware") != std::string::npos);
}

TEST_CASE("devices: what is plugged in, and the rule that gives access where it is missing") {
  Emulator falcons({"falcon:2-1", "falcon:3-2", "falcon:4-3", "spacemouse:1-1"});
  falcons.command("fault 3-2 permission");
  falcons.command("fault 4-3 busy");
  auto list = falcons.start("haptic_client", {"devices"});
  CHECK(list->wait() == 0);
  const std::string said = list->output();
  CAPTURE(said);
  CHECK(said.find("--device falcon:2-1    ready to use") != std::string::npos);
  CHECK(said.find("--device falcon:3-2    no permission") != std::string::npos);
  CHECK(said.find("--device falcon:4-3    another program holds") != std::string::npos);
  // The rule that is printed is the one that ships.
  const std::string rules = bytes_of(source_dir() + "/configs/udev/70-palpate.rules");
  const std::size_t rule = rules.find("SUBSYSTEM");
  CHECK(said.find(rules.substr(rule, rules.find('\n', rule) - rule)) != std::string::npos);
}

TEST_CASE("devices: none that is known is told by the exit code too") {
  Emulator falcons({"falcon:2-1"});
  falcons.command("unplug 2-1");
  auto list = falcons.start("haptic_client", {"devices"});
  CHECK(list->wait() == 1);
  CHECK(list->output().find("no device that Palpate knows") != std::string::npos);
}

TEST_CASE("Falcon: asked for at a port where none is, it says where there is one, and fails in the end") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcons({"falcon:2-1"}, {"--loaded", "--homed"});
  auto client = falcons.start("haptic_client", {"run", bench.client, "--device", "falcon:9-9", "--server",
                                                wall.address, "--seconds", "0.5"});
  CHECK(client->wait() == 1);
  const std::string said = client->output();
  CAPTURE(said);
  CHECK(said.find("--device: no falcon at port 9-9; there are: 2-1") != std::string::npos);
  CHECK(said.find("no falcon came to port 9-9") != std::string::npos);
}

TEST_CASE("Falcon: without a client file it runs at its own 1000 Hz") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcons({"falcon:2-1"}, {"--loaded", "--homed"});
  const std::string report = (bench.folder.path() / "report.json").string();
  auto client = falcons.start("haptic_client", {"run", "--device", "falcon", "--server", wall.address,
                                                "--seconds", "0.5", "--report", report});
  CHECK(client->wait() == 0);
  CHECK(Json::parse(bytes_of(report))["tools"][0]["loop"]["rate_hz"] == 1000);
}

TEST_CASE("Falcon: of two, the one that was asked for") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcons({"falcon:2-1", "falcon:3-2"}, {"--loaded", "--homed"});
  auto client = falcons.start("haptic_client",
                              {"run", bench.client, "--device", "falcon:3-2", "--server", wall.address});
  REQUIRE(client->wait_for("Falcon homed: ready"));
  CHECK(falcons.state("3-2")["green"] == true);
  CHECK(falcons.state("2-1")["opens"] == 0);
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
}

TEST_CASE("Falcon: of three, the first that is neither locked nor held by another program") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcons({"falcon:2-1", "falcon:3-2", "falcon:4-3"}, {"--loaded", "--homed"});
  falcons.command("fault 2-1 permission");
  falcons.command("fault 3-2 busy");
  auto client =
      falcons.start("haptic_client", {"run", bench.client, "--device", "falcon", "--server", wall.address});
  REQUIRE(client->wait_for("Falcon homed: ready"));
  CHECK(falcons.state("4-3")["green"] == true);
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
}

TEST_CASE("Falcon: found when it is plugged in later, and when the program that held it lets it go") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcon({"falcon:2-1"}, {"--loaded", "--homed"});
  falcon.command("unplug 2-1");
  falcon.command("fault 2-1 busy");
  auto client = falcon.start("haptic_client", {"run", bench.client, "--server", wall.address});
  REQUIRE(client->wait_for("looking for a Falcon"));
  falcon.command("plug 2-1");
  REQUIRE(client->wait_for("another program holds the USB device"));
  falcon.command("fault 2-1 busy 0");
  REQUIRE(falcon.wait_for("2-1", [](const Json& s) { return s["red"] == true || s["green"] == true; }));
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
}

TEST_CASE("Falcon: its centre button is the clutch: held, nothing is felt, let go, the force comes back") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcon({"falcon:2-1"}, {"--loaded", "--homed"});
  const std::string file =
      bench.folder.write("clutch.toml", bytes_of(bench.client) + "[workspace]\nclutch = 4\n").string();
  const std::string report = (bench.folder.path() / "report.json").string();
  falcon.command("hand 2-1 place 0 0 0.13");
  auto client = falcon.start("haptic_client", {"run", file, "--server", wall.address, "--report", report});
  REQUIRE(client->wait_for("Falcon homed: ready"));
  falcon.command("hand 2-1 target 0 0 0.115 1");
  const auto pushes = [](const Json& s) { return s["force"][2].get<double>() > 0.5; };
  const auto silent = [](const Json& s) { return s["dac"] == Json({0, 0, 0}); };
  REQUIRE(falcon.wait_for("2-1", pushes));
  falcon.command("buttons 2-1 11");  // all but the clutch
  CHECK(pushes(falcon.state("2-1")));
  falcon.command("buttons 2-1 4");
  CHECK(falcon.wait_for("2-1", silent));
  falcon.command("buttons 2-1 0");
  CHECK(falcon.wait_for("2-1", pushes));
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
  CHECK(read_json(report)["tools"][0]["safety"]["clutched"].get<int>() > 0);
}
