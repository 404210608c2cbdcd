// The client dies with force on the motors: somebody must switch it off.
#include <csignal>
#include <thread>

#include "tests/support/falcon_bench.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// No torque on any motor within so many seconds.
bool goes_silent(const Emulator& falcons, const std::string& port, double seconds) {
  return falcons.wait_for(
      port,
      [](const Json& s) {
        return s["dac"] == Json({0, 0, 0});
      },
      seconds);
}

/// The hand goes into the wall, and feels it.
bool leans(const Emulator& falcons, const std::string& port) {
  falcons.command("hand " + port + " target 0 0 0.105 1");
  return falcons.wait_for(port, [](const Json& s) { return s["force"][2].get<double>() > 2; });
}

/// A hand that leans on a wall, held by a client that is ready to die.
struct Leaning {
  Bench bench;
  Wall wall{bench};
  Emulator falcon{{"falcon:2-1", "falcon:3-2"}, {"--loaded", "--homed"}};
  std::unique_ptr<Process> client;

  explicit Leaning(const std::string& device) {
    falcon.command("hand 2-1 target 0 0 0.13");
    client =
        falcon.start("haptic_client", {"run", bench.client, "--device", device, "--server", wall.address});
    if (!client->wait_for("Falcon homed: ready")) throw std::runtime_error(client->output());
    if (!leans(falcon, "2-1")) throw std::runtime_error("no force: " + falcon.state("2-1").dump());
  }
  bool falls_silent() const { return goes_silent(falcon, "2-1", 2); }
  /// By the client, or by its guardian when it is dead.
  bool said(const std::string& text) const {
    for (int i = 0; i < 400 && client->output().find(text) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return client->output().find(text) != std::string::npos;
  }
};

}  // namespace

TEST_CASE(
    "guardian: the client is killed, crashes, aborts: zero torque within two seconds, once, by port or not") {
  for (const int signal : {SIGKILL, SIGSEGV, SIGABRT}) {
    for (const std::string device : {"falcon:2-1", "falcon"}) {
      CAPTURE(signal, device);
      Leaning hand(device);
      hand.client->signal(signal);
      CHECK(hand.falls_silent());
      CHECK(hand.said("zero force sent to " + device));
      CHECK(hand.client->wait() != 0);  // -signal, but for what a sanitizer makes of SIGSEGV
      CHECK(hand.falcon.state("2-1")["red"] == true);
      CHECK(hand.falcon.state("2-1")["homed"] == 7);  // the next client need not home it again
    }
  }
}

TEST_CASE("guardian: a client that ends well, or is told to, needs none") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Leaning hand("falcon:2-1");
    hand.client->signal(signal);
    CHECK(hand.client->wait() == 0);
    const Json state = hand.falcon.state("2-1");
    CHECK(state["dac"] == Json({0, 0, 0}));
    CHECK(state["opens"] == 1);
    CHECK(hand.client->output().find("the client died") == std::string::npos);
  }
}

TEST_CASE("guardian: with a port, another Falcon is left alone") {
  Leaning hand("falcon:2-1");
  hand.client->signal(SIGKILL);
  CHECK(hand.falls_silent());
  CHECK(hand.said("zero force sent to falcon:2-1"));
  CHECK(hand.falcon.state("3-2")["opens"] == 0);
}

TEST_CASE("guardian: a Falcon at a named port that is not listed at first is waited for", "[in_time]") {
  Leaning hand("falcon:2-1");
  hand.falcon.command("unplug 2-1");  // as while it is enumerated again
  hand.client->signal(SIGKILL);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  hand.falcon.command("plug 2-1");
  CHECK(hand.said("zero force sent to falcon:2-1"));
  CHECK(hand.falcon.state("3-2")["opens"] == 0);
}

TEST_CASE("guardian: a client that was stopped is ended, and its device switched off") {
  Leaning hand("falcon:2-1");
  hand.client->signal(SIGSTOP);
  CHECK(goes_silent(hand.falcon, "2-1", 4));
  CHECK(hand.said("the client stands still"));
  CHECK(hand.client->wait() == -SIGKILL);
}

TEST_CASE("guardian: a device that is gone does not keep the other waiting", "[in_time]") {
  const Bench bench;
  Wall wall(bench.folder.write("two.toml", bytes_of(bench.scene) + "[[tool]]\nradius = 0.005\n").string());
  Emulator falcons({"falcon:2-1", "falcon:3-2"}, {"--loaded", "--homed"});
  falcons.command("hand 3-2 place 0 0 0.13");
  auto client = falcons.start("haptic_client", {"run", bench.client, "--device", "falcon:2-1", "--device",
                                                "falcon:3-2", "--server", wall.address});
  REQUIRE(client->wait_for("tool 2 (falcon:3-2): Falcon homed"));
  REQUIRE(leans(falcons, "3-2"));
  falcons.command("unplug 2-1");
  REQUIRE(client->wait_for("unplugged"));
  client->signal(SIGKILL);
  CHECK(goes_silent(falcons, "3-2", 0.8));
}

TEST_CASE("guardian: each device that does not take its last zero is looked after, also one after another") {
  const Bench bench;
  Wall wall(bench.folder.write("two.toml", bytes_of(bench.scene) + "[[tool]]\nradius = 0.005\n").string());
  Emulator falcons({"falcon:2-1", "falcon:3-2"}, {"--loaded", "--homed"});
  for (const char* port : {"2-1", "3-2"}) falcons.command(std::string("hand ") + port + " place 0 0 0.13");
  auto client = falcons.start("haptic_client", {"run", bench.client, "--device", "falcon:2-1", "--device",
                                                "falcon:3-2", "--server", wall.address});
  REQUIRE(client->wait_for("tool 1 (falcon:2-1): Falcon homed"));
  REQUIRE(client->wait_for("tool 2 (falcon:3-2): Falcon homed"));
  for (const char* port : {"2-1", "3-2"}) REQUIRE(leans(falcons, port));
  for (const char* port : {"2-1", "3-2"}) falcons.command(std::string("unplug ") + port);
  REQUIRE(client->wait_for("tool 1 (falcon:2-1): the Falcon was unplugged"));
  client->signal(SIGINT);
  CHECK(client->wait() == 0);
  for (const char* port : {"2-1", "3-2"})
    CHECK(client->output().find(std::string("did not take its last zero; falcon:") + port +
                                " could not be taken over") != std::string::npos);
}

TEST_CASE("guardian: without a port, a Falcon that another program holds keeps nobody waiting", "[in_time]") {
  const Bench bench;
  Wall wall(bench);
  Emulator falcons({"falcon:2-1", "falcon:3-2"}, {"--loaded", "--homed"});
  falcons.command("fault 2-1 busy");
  falcons.command("hand 3-2 place 0 0 0.13");
  auto client =
      falcons.start("haptic_client", {"run", bench.client, "--device", "falcon", "--server", wall.address});
  REQUIRE(client->wait_for("Falcon homed: ready"));
  REQUIRE(leans(falcons, "3-2"));
  client->signal(SIGKILL);
  CHECK(goes_silent(falcons, "3-2", 0.8));
}

TEST_CASE("Ctrl-C: the force is off before anything is reported", "[in_time]") {
  Leaning hand("falcon:2-1");
  hand.client->signal(SIGINT);
  CHECK(goes_silent(hand.falcon, "2-1", 0.5));
  CHECK(hand.client->wait() == 0);
}
