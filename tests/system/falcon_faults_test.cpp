// Everything that goes wrong with a Falcon, through the real libusb and both real programs: what the client
// says (one line an event), what the device got, and that it comes back by itself.
#include "tests/support/falcon_session.h"

using namespace palpate::test;
using Json = nlohmann::json;
using Lines = std::vector<std::string>;

TEST_CASE(
    "Falcon faults: echoes that stop, odd bytes, empty transfers, an old session's bytes: loaded at the "
    "third try") {
  Session session({}, {"loader_fails 2", "loader_zero", "zero_in 5", "stale 20", "join"});
  REQUIRE(session.client->wait_for("pull the grip fully out"));
  CHECK(session.count("resets") == 3);
  CHECK(session.count("image_bytes") == 8000);
  CHECK(session.count("opens") == 1);
  session.usb.command("homing 2-1 now");
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  session.end();
  check_lines(session.said(), {"loading the Falcon's firmware", "pull the grip", "homed: ready"});
}

TEST_CASE("Falcon faults: an image that is too short or too long is refused, half of one is told of once") {
  Session session({}, {"permission"});  // so that the first client keeps off
  const auto image = [&](std::size_t size) {
    return session.bench.folder.write("other.bin", std::string(size, '\1')).string();
  };
  for (const std::size_t size : {0u, 900u, 70000u}) {
    CAPTURE(size);
    CHECK(output_of("haptic_client", {"run", "--device", "falcon", "--falcon-firmware", image(size)}, 2)
              .find("a firmware image of the Falcon has 1024 to 65536") != std::string::npos);
  }
  session.end();
  session.fault("permission 0");
  session.client = session.start(session.wall.address, {"--falcon-firmware", image(3000)});
  REQUIRE(session.client->wait_for("does not take its firmware"));
  CHECK(session.count("resets") == 5);
  CHECK(session.wait([](const Json& s) { return s["resets"] == 6; }));  // and it tries again
  CHECK(session.count("largest_dac") == 0);
  session.end();
  check_lines(session.said(), {"loading the Falcon's firmware", "is the image the right file?"});
}

TEST_CASE("Falcon faults: a control request stalls: told as such, and not as unplugged, then it works") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  session.usb.command("unplug 2-1");
  REQUIRE(session.client->wait_for("the Falcon was unplugged"));
  session.fault("stall 1");
  session.usb.command("plug 2-1");
  REQUIRE(session.client->wait_for("a USB transfer failed"));
  REQUIRE(session.client->wait_for("pull the grip fully out"));
  CHECK(session.count("opens") == 3);
  session.end();
  check_lines(session.said(), {"homed: ready", "unplugged", "a USB transfer failed", "loading the Falcon's",
                               "pull the grip"});
}

TEST_CASE("Falcon faults: split, joined, flooded and spoilt replies: nothing lost, never more force",
          "[in_time]") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  // Places come late, and the wall may go softer.
  for (const std::string fault : {"split", "join", "status_flood 12", "garbage 40", "zero_in 40"}) {
    CAPTURE(fault);
    session.fault(fault);
    CHECK(session.ticks_go_on(200));
    session.fault(fault.substr(0, fault.find(' ')) + " 0");
  }
  CHECK(session.press_again());
  CHECK(session.count("opens") == 1);
  CHECK(session.end()["force"]["max_newton"].get<double>() < 1.2 * kPush);
  check_lines(session.said(), {"homed: ready"});
}

TEST_CASE("Falcon faults: a flood without end does not hold the loop, told once, and over when it ends") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("status_flood 1000000");
  CHECK(session.silent(2));
  CHECK(session.ticks_go_on(300));
  REQUIRE(session.client->wait_for("stopped answering"));
  session.fault("status_flood 0");
  CHECK(session.pushes());
  session.end();
  check_lines(session.said(), {"homed: ready", "stopped answering", "homed: ready"});
  check_soft_starts(session.trace, 1, 2);
}

TEST_CASE("Falcon faults: without mains it never homes: no torque, and what to check") {
  Session session({"--loaded"});
  session.usb.command("power 2-1 off");
  REQUIRE(session.client->wait_for("check that its mains adaptor is plugged in"));
  session.usb.command("homing 2-1 home");
  REQUIRE(session.wait([](const Json& s) { return s["hand_at_rest"] == true; }));
  CHECK(session.state()["red"] == true);
  CHECK(session.count("homed") == 0);
  CHECK(session.count("largest_dac") == 0);
  session.usb.command("power 2-1 on");
  session.usb.command("homing 2-1 home");
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  session.end();
  check_lines(session.said(), {"pull the grip", "homed: ready"});
}

TEST_CASE("Falcon faults: homed deep inside the wall, where its encoders jump: a soft start and no blow") {
  Session session({"--loaded"});
  REQUIRE(session.client->wait_for("pull the grip fully out"));
  session.usb.command("hand 2-1 target 0 0 0.10");
  CHECK(session.ticks_go_on(300));
  CHECK(session.count("largest_dac") == 0);
  session.usb.command("homing 2-1 now");
  CHECK(session.pushes());
  session.end();
  check_soft_starts(session.trace, 0, 1);
  check_lines(session.said(), {"pull the grip", "homed: ready"});
}

TEST_CASE(
    "Falcon faults: unplugged while it is probed, in the boot loader, in the upload: one line each, and "
    "loaded in the end") {
  Session session({}, {"mute"});
  int times = 0;
  const auto replug = [&](const std::string& next) {
    session.usb.command("unplug 2-1");
    REQUIRE(session.says("the Falcon was unplugged", ++times));
    session.fault(next);
    session.usb.command("plug 2-1");
  };
  REQUIRE(session.wait([](const Json& s) { return s["writes"] > 0; }));  // it is probed
  replug("mute 0");
  session.fault("loader_silent 1000");
  REQUIRE(session.says("loading the Falcon's firmware", 1));
  CHECK(session.count("resets") == 1);
  replug("loader_silent 0");
  session.fault("loader_fails 1");
  REQUIRE(session.wait([](const Json& s) { return s["image_bytes"].get<int>() > 1000; }));
  REQUIRE(session.says("loading the Falcon's firmware", 2));
  replug("mute 0");
  REQUIRE(session.client->wait_for("pull the grip fully out"));
  CHECK(session.count("image_bytes") == 8000);
  CHECK(session.count("largest_dac") == 0);
  session.end();
  const std::string removed = "the Falcon was unplugged", loading = "loading the Falcon's firmware";
  check_lines(session.said(), {removed, loading, removed, loading, removed, loading, "pull the grip"});
}

TEST_CASE(
    "Falcon faults: unplugged unhomed and in full push: nothing before it is homed again, then softly") {
  Session session({"--loaded"});
  REQUIRE(session.client->wait_for("pull the grip fully out"));
  session.usb.command("unplug 2-1");
  REQUIRE(session.client->wait_for("the Falcon was unplugged"));
  session.usb.command("plug 2-1");
  REQUIRE(session.client->wait_for("loading the Falcon's firmware"));
  REQUIRE(session.wait([](const Json& s) { return s["loaded"] == true && s["red"] == true; }));
  session.usb.command("homing 2-1 now");
  REQUIRE(session.press());
  session.usb.command("unplug 2-1");
  const int before = session.count("packets");
  pause(0.2);
  CHECK(session.count("packets") == before);
  session.usb.command("plug 2-1");
  CHECK(session.state()["dac"] == Json({0, 0, 0}));
  REQUIRE(session.wait([](const Json& s) { return s["loaded"] == true && s["red"] == true; }));
  CHECK(session.ticks_go_on(100));
  CHECK(session.silent(0.1));
  session.usb.command("homing 2-1 now");
  CHECK(session.pushes());
  const Json tool = session.end();
  CHECK(tool["safety"]["lost"] > 500);
  check_soft_starts(session.trace, 1, 2);
}

TEST_CASE("Falcon faults: a round trip of 20 ms all at once, and back: no storm, no latch, the ticks go on",
          "[in_time]") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("latency 20");
  session.usb.command("hand 2-1 target 0.01 0 0.105 0.3");
  CHECK(session.ticks_go_on(1000));
  CHECK(session.wait([](const Json& s) { return s["force"][2] > 0.1; }));  // softer, but still a wall
  session.fault("latency 0");
  CHECK(session.press_again());
  const Json tool = session.end();
  CHECK(session.count("opens") == 1);
  CHECK(tool["safety"]["lost"].get<int>() < 300);  // before it was ready
  check_lines(session.said(), {"homed: ready"});
}

TEST_CASE("Falcon faults: packets stop for a moment: no force without a place, nothing said, then softly",
          "[in_time]") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("mute");
  pause(0.2);
  session.fault("mute 0");
  CHECK(session.ticks_go_on(50));
  CHECK(session.newton() < 2);
  CHECK(session.pushes());
  session.end();
  CHECK(session.count("opens") == 1);
  check_lines(session.said(), {"homed: ready"});
  check_soft_starts(session.trace, 1, 2);
}

TEST_CASE(
    "Falcon faults: packets stop for good: reset, which ends its torque, and loaded when it hears again") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("mute");
  CHECK(session.silent(4));
  CHECK(session.count("resets") == 1);
  session.fault("mute 0");
  REQUIRE(session.client->wait_for("pull the grip fully out"));
  session.end();
  check_lines(session.said(),
              {"homed: ready", "stopped answering", "loading the Falcon's firmware", "pull the grip"});
}

TEST_CASE("Falcon faults: its IN transfers hang: zero at once, and back without a new homing", "[in_time]") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("hang");
  CHECK(session.silent(0.5));
  REQUIRE(session.client->wait_for("stopped answering"));
  session.fault("hang 0");
  CHECK(session.pushes());
  CHECK(session.count("resets") == 0);
  session.end();
  check_lines(session.said(), {"homed: ready", "stopped answering", "homed: ready"});
  check_soft_starts(session.trace, 1, 2);
}

TEST_CASE("Falcon faults: frozen encoders under force are told of, once, the force stays what it was") {
  Session session(kHomedAlready);
  session.usb.command("hand 2-1 tremor 0.0005 tremor_rate 9");
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("freeze");
  CHECK(session.ticks_go_on(100));
  const double frozen = session.newton();
  session.usb.command("hand 2-1 target 0 0 0.13 0.5");
  REQUIRE(session.client->wait_for("no encoder of the Falcon moved"));
  CHECK(session.newton() == Approx(frozen).epsilon(0.3));  // the lever arms change, not the command
  session.fault("freeze 0");
  CHECK(session.wait([](const Json& s) { return s["force"][2].get<double>() < 0.1; }));
  session.end();
  check_lines(session.said(), {"homed: ready", "no encoder of the Falcon moved"});
}

TEST_CASE("Falcon faults: locked, then held by another client, then free: the client gets it by itself") {
  Session session(kHomedAlready, {"permission"});
  REQUIRE(session.client->wait_for("no permission for the USB device"));
  session.fault("permission 0");
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  Wall other(session.bench);
  const auto second =
      session.usb.start("haptic_client", {"run", session.bench.client, "--server", other.address});
  REQUIRE(second->wait_for("another program holds the USB device"));
  CHECK(session.press());  // the first one goes on
  session.end(false);
  REQUIRE(second->wait_for("Falcon homed: ready"));
  CHECK(session.pushes());
  second->signal(SIGINT);
  CHECK(second->wait() == 0);
  check_lines(session.said(), {"no permission", "homed: ready"});
  check_lines(Session::said_by(*second), {"another program holds", "homed: ready"});
}
