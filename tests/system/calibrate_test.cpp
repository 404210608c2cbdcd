// `haptic_client calibrate` with an emulated Falcon, through the real libusb.
#include <csignal>

#include "tests/support/falcon_bench.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

const Json kZero({0, 0, 0});

/// A Falcon whose grip nobody holds, and a calibration that has begun.
struct Calibrating {
  Emulator falcon{{"falcon:2-1"}, {"--loaded", "--torque-constant", "4000"}};
  std::unique_ptr<Process> client;

  Calibrating() {
    client = falcon.start("haptic_client", {"calibrate", "falcon:2-1", "--mass", "0.2"});
    if (!client->wait_for("pull the grip fully out")) throw std::runtime_error(client->output());
    falcon.command("homing 2-1 home");
    if (!client->wait_for("let go of the grip")) throw std::runtime_error(client->output());
    falcon.command("hand 2-1 stiffness 0 damping 0");
    if (!client->wait_for("swings")) throw std::runtime_error(client->output());
  }
  /// The weight hangs there, held by the motors.
  void hang() {
    if (!client->wait_for("hang the weight of 0.2 kg", 40)) throw std::runtime_error(client->output());
    falcon.command("hand 2-1 weight 0.2");
    const bool held = falcon.wait_for("2-1", [](const Json& s) { return s["force"][1].get<double>() > 1; });
    if (!held) throw std::runtime_error(falcon.state("2-1").dump());
  }
  bool silent() const {
    return falcon.wait_for(
        "2-1", [](const Json& s) { return s["dac"] == kZero; }, 2);
  }
};

}  // namespace

TEST_CASE("calibrate: from homing to the line for the client file, no force before homing, none at the end") {
  Calibrating table;
  table.hang();
  CHECK(table.client->wait(60) == 0);
  const std::string said = table.client->output();
  CAPTURE(said);
  const std::size_t line = said.find("[falcon]\ntorque_constant = ");
  REQUIRE(line != std::string::npos);
  CHECK(std::stod(said.substr(line + 27)) == Approx(4000).epsilon(0.02));
  CHECK(said.find("put this into the client file") != std::string::npos);
  const Json state = table.falcon.state("2-1");
  CHECK(state["largest_dac_unhomed"] == 0);
  CHECK(state["dac"] == kZero);
  CHECK(state["opens"] == 1);  // the guardian had nothing to do
}

TEST_CASE("calibrate: Ctrl-C with the weight on it: zero force, one line, no result") {
  for (const int signal : {SIGINT, SIGTERM}) {
    Calibrating table;
    table.hang();
    table.client->signal(signal);
    CHECK(table.client->wait() == 1);
    CHECK(table.falcon.state("2-1")["dac"] == kZero);
    CHECK(table.falcon.state("2-1")["opens"] == 1);
    CHECK(table.client->output().find("interrupted") != std::string::npos);
    CHECK(table.client->output().find("torque_constant =") == std::string::npos);
  }
}

TEST_CASE("calibrate: killed with the weight on it: the guardian switches the force off") {
  Calibrating table;
  table.hang();
  table.client->signal(SIGKILL);
  CHECK(table.silent());
  CHECK(table.client->wait() == -SIGKILL);
  CHECK(table.falcon.state("2-1")["opens"] == 2);
}

TEST_CASE("calibrate: unplugged in the middle: it says so and ends") {
  Calibrating table;
  table.falcon.command("unplug 2-1");
  CHECK(table.client->wait() == 1);
  CHECK(table.client->output().find("gave no position any more") != std::string::npos);
}

TEST_CASE("calibrate: wrong use is one clear line") {
  const auto said = [](const std::vector<std::string>& arguments) {
    return output_of("haptic_client", arguments, 2);
  };
  CHECK(said({"calibrate", "falcon"}).find("--mass is required") != std::string::npos);
  for (const char* mass : {"0.04", "0.6", "nan"})
    CHECK(said({"calibrate", "falcon", "--mass", mass}).find("--mass") != std::string::npos);
  CHECK(said({"calibrate", "spacemouse", "--mass", "0.2"}).find("no torque constant") != std::string::npos);
  CHECK(said({"calibrate", "falkon", "--mass", "0.2"}).find("falcon") != std::string::npos);
  CHECK(output_of("haptic_client", {"calibrate", "--help"}, 0).find("Example: ") != std::string::npos);
}

TEST_CASE("calibrate: where no Falcon is plugged in, one line says so, and what else there is") {
  Emulator falcon{{"falcon:2-1"}, {"--loaded"}};
  const auto client = falcon.start("haptic_client", {"calibrate", "falcon:3-7", "--mass", "0.2"});
  CHECK(client->wait(12) == 1);
  CHECK_THAT(client->output(), Catch::Contains("no falcon came to port 3-7; `haptic_client devices` lists"));
}
