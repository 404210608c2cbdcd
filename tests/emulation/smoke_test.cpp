// Emulator, shim and the real libusb together: usb_smoke is an ordinary program that knows of none of them.
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>

#include "tests/emulation/emulator.h"
#include "tests/support/catch.h"

using palpate::test::Emulator;
using palpate::test::Environment;
using palpate::test::Process;

namespace {

bool says(Process& process, const std::string& text) {
  return process.output().find(text) != std::string::npos;
}

/// Runs usb_smoke to its end, checks its exit code and returns what it said.
std::string smoke(const Emulator& emulator, const std::vector<std::string>& arguments, int code = 0) {
  const auto client = emulator.start("usb_smoke", arguments);
  const int got = client->wait(60);
  CAPTURE(client->output());
  CHECK(got == code);
  return client->output();
}

bool contains(const std::string& text, const std::string& part) {
  CAPTURE(text, part);
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("libusb lists the emulated devices, and only those") {
  const Emulator emulator({"falcon:2-1", "spacemouse:3-2", "spacemouse13:3-4", "falcon:3-1.2"});
  const std::string said = smoke(emulator, {"list"});
  CHECK(contains(said, "devices 7\n"));  // with two root hubs and the hub at 3-1
  CHECK(contains(said, "device 3-0 address 1 id 1d6b:0002 class 09 endpoints 1 speed 2 product Root hub\n"));
  CHECK(contains(said, "device 3-1.2 address 5 id 0403:cb48 class ff"));
  CHECK(contains(said,
                 "device 2-1 address 2 id 0403:cb48 class ff endpoints 2 speed 2 product FALCON HAPTIC\n"));
  CHECK(contains(said,
                 "device 3-2 address 2 id 046d:c626 class 03 endpoints 1 speed 2 product SpaceNavigator\n"));
  CHECK(
      contains(said, "device 3-4 address 3 id 256f:c62e class 03 endpoints 1 speed 2 product SpaceMouse W"));
}

TEST_CASE("without USBSHIM the shim does nothing") {
  Process bare("usb_smoke", {"list"});
  CHECK(bare.wait() == 0);
  const Emulator emulator({"falcon:2-1"});
  auto variables = emulator.environment();
  std::erase_if(variables, [](const auto& variable) { return variable.first == "USBSHIM"; });
  const Environment environment(variables);
  Process preloaded("usb_smoke", {"list"});
  CHECK(preloaded.wait() == 0);
  CHECK(preloaded.output() == bare.output());
}

TEST_CASE("a Falcon is opened, loaded, homed, and answers 2000 packets") {
  const Emulator emulator({"falcon:2-1"});
  emulator.command("homing 2-1 home");
  const std::string said = smoke(emulator, {"falcon", "2000"});
  CHECK(contains(said, "loaded 8192\n"));
  CHECK(contains(said, "homed_after "));
  std::cout << said.substr(said.find("round_trips"));
  const auto state = emulator.state("2-1");
  CAPTURE(state.dump());
  CHECK(state["loaded"] == true);
  CHECK(state["image_bytes"] == 8192);
  CHECK(state["homed"] == 7);
  CHECK(state["green"] == true);
  CHECK(state["red"] == false);
  CHECK(state["largest_dac"] == 0);
  CHECK(state["packets"].get<int>() > 2000);
  CHECK(state["time"].get<double>() == Approx(1e-3 * state["packets"].get<int>()));
  CHECK(state["position"][2].get<double>() == Approx(0.110).margin(1e-4));
}

TEST_CASE("in virtual time the same seed gives the same numbers, to the last digit") {
  std::string first;
  for (int run = 0; run < 2; ++run) {
    const Emulator emulator({"falcon:2-1"}, {"--seed", "7"});
    emulator.command("homing 2-1 home");
    const std::string said = smoke(emulator, {"falcon", "100"});
    const std::string homed = said.substr(0, said.find("round_trips")) + emulator.command("state 2-1");
    if (run == 0) first = homed;
    CHECK(homed == first);
  }
}

TEST_CASE(
    "unplugged with a transfer under way, and plugged in again: callbacks and errors as of real hardware") {
  const Emulator emulator({"falcon:2-1"});
  const auto client = emulator.start("usb_smoke", {"hotplug"});
  REQUIRE(client->wait_for("waiting"));
  emulator.command("unplug 2-1");
  CHECK(client->wait_for("left 2-1"));
  CHECK(client->wait_for("after LIBUSB_ERROR_NO_DEVICE"));
  CHECK(says(*client, "transfer_status 5\n"));  // LIBUSB_TRANSFER_NO_DEVICE
  emulator.command("plug 2-1");
  CHECK(client->wait() == 0);
  CHECK(says(*client, "arrived 2-1\n"));
  CHECK(says(*client, "open_again 1\n"));
  CHECK_THROWS(emulator.command("plug 2-1"));
}

TEST_CASE("a client whose emulator dies sees its device go") {
  Emulator emulator({"falcon:2-1"});
  const auto client = emulator.start("usb_smoke", {"hotplug"});
  REQUIRE(client->wait_for("waiting"));
  emulator.process().signal(SIGKILL);
  CHECK(client->wait_for("after LIBUSB_ERROR_NO_DEVICE"));
}

TEST_CASE("SpaceMouse: six axes in two reports of 7 bytes, or in one of 13, buttons, LED") {
  const Emulator emulator({"spacemouse:3-2", "spacemouse13:3-4"});
  for (const char* port : {"3-2", "3-4"})
    emulator.command(std::string("mouse ") + port + " 1 -2 300 4 5 -350");
  const std::string two = smoke(emulator, {"mouse", "4"}), one = smoke(emulator, {"mouse13", "2"});
  CHECK(contains(two, "kernel_driver 1\n"));
  CHECK(contains(two, "report 01 01 00 fe ff 2c 01\nreport 02 04 00 05 00 a2 fe\nreport 01"));
  CHECK(contains(two, "kernel_driver_after 1\n"));
  CHECK(contains(one, "report 01 01 00 fe ff 2c 01 04 00 05 00 a2 fe\nreport 01"));
  CHECK(emulator.state("3-2")["led"] == true);
  emulator.command("mouse 3-4 0 0 0 0 0 0");
  emulator.command("buttons 3-4 3");
  const std::string released = smoke(emulator, {"mouse13", "2"});
  CHECK(contains(released, "report 03 03 00\n"));
  CHECK(contains(released, "report 01 00 00 00 00 00 00 00 00 00 00 00 00\n"));
}

TEST_CASE("permission denied, busy, stalled, silent: libusb's own errors") {
  const Emulator emulator({"falcon:2-1"});
  const auto with_fault = [&](const std::string& fault) {
    emulator.command("fault 2-1 " + fault);
    const std::string said = smoke(emulator, {"falcon", "10"}, 1);
    emulator.command("fault 2-1 " + fault.substr(0, fault.find(' ')) + " 0");
    return said;
  };
  CHECK(contains(with_fault("permission 1"), "error open LIBUSB_ERROR_ACCESS"));
  CHECK(contains(with_fault("busy 1"), "error claim LIBUSB_ERROR_BUSY"));
  CHECK(contains(with_fault("stall 1"), "error control LIBUSB_ERROR_PIPE"));
  CHECK(contains(with_fault("mute 1"), "error receive nothing"));
  CHECK(contains(with_fault("echo_corrupt 1"), "error echo"));
  CHECK(contains(with_fault("loader_fails 1"), "error receive nothing"));
  CHECK_THROWS(emulator.command("fault 2-1 nonsense"));
  CHECK_THROWS(emulator.command("unplug 9-9"));
}

TEST_CASE("a device that hangs: transfers time out and are cancelled, and the next ones work") {
  const Emulator emulator({"falcon:2-1"});
  emulator.command("fault 2-1 hang");
  const std::string said = smoke(emulator, {"timeouts"});
  CHECK(contains(said, "timeout LIBUSB_ERROR_TIMEOUT\ntimeout LIBUSB_ERROR_TIMEOUT\n"));
  emulator.command("fault 2-1 hang 0");
  CHECK(contains(smoke(emulator, {"timeouts"}), "timeout LIBUSB_SUCCESS"));
}

TEST_CASE("64 transfers under way at once: none is lost, none ends twice") {
  const Emulator emulator({"falcon:2-1"});
  CHECK(contains(smoke(emulator, {"storm", "20000"}), "storm_over 0\n"));
}

TEST_CASE("an interface belongs to one program at a time, two devices to two") {
  const Emulator emulator({"falcon:2-1", "spacemouse:3-1"});
  const auto holder = emulator.start("usb_smoke", {"hotplug"});
  REQUIRE(holder->wait_for("waiting"));
  CHECK(contains(smoke(emulator, {"falcon", "1"}, 1), "error claim LIBUSB_ERROR_BUSY"));
  emulator.command("mouse 3-1 1 1 1 1 1 1");
  CHECK(contains(smoke(emulator, {"mouse", "2"}), "report 02"));
  holder->signal(SIGKILL);
  holder->wait();
  CHECK(contains(smoke(emulator, {"timeouts"}), "timeout"));
}

TEST_CASE("on the wall clock: the same session, at the pace of the hardware", "[in_time]") {
  const Emulator emulator({"falcon:2-1"}, {"--clock", "wall"});
  const auto client = emulator.start("usb_smoke", {"falcon", "300"});
  CHECK(client->wait_for("loaded 8192"));
  emulator.command("homing 2-1 home");
  CHECK(client->wait(60) == 0);
  std::cout << "wall clock: " << client->output().substr(client->output().find("round_trips"));
  CHECK(emulator.state("2-1")["homed"] == 7);
}

TEST_CASE("nothing is left behind: no process, no socket, no folder") {
  std::string folder;
  pid_t id = 0;
  {
    Emulator emulator({"falcon:2-1"});
    folder = std::filesystem::path(emulator.socket()).parent_path();
    id = emulator.process().id();
    CHECK(std::filesystem::exists(folder));
  }
  CHECK_FALSE(std::filesystem::exists(folder));
  CHECK(kill(id, 0) != 0);
}

TEST_CASE("wrong use of falcon_emulator: one line, exit 2") {
  const auto wrong = [](const std::vector<std::string>& arguments, const std::string& text) {
    Process process("falcon_emulator", arguments);
    CHECK(process.wait() == 2);
    CHECK(contains(process.output(), text));
  };
  wrong({}, "--socket and at least one --device are needed");
  wrong({"--socket", "/tmp/x", "--device", "falcon"}, "--device is MODEL:PORT");
  wrong({"--socket", "/tmp/x", "--device", "phantom:2-1"}, "unknown model phantom");
  wrong({"--socket", "/tmp/x", "--device", "falcon:21"}, "is no port");
  wrong({"--socket", "/tmp/x", "--device", "falcon:2-1", "--device", "falcon:2-1"}, "is taken");
  wrong({"--clock", "sun"}, "--clock is virtual or wall");
  Process help("falcon_emulator", {"--help"});
  CHECK(help.wait() == 0);
  CHECK(help.output().find("status_flood") != std::string::npos);
}
