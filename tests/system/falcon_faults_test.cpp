// Everything that goes wrong with a Falcon, through the real libusb and both real programs: what the client
// says (one line an event), what the device got, and that it comes back by itself.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <sstream>
#include <thread>

#include "tests/support/falcon_bench.h"
#include "tests/support/trace_rows.h"

using namespace palpate::test;
using Json = nlohmann::json;
using Lines = std::vector<std::string>;

namespace {

constexpr double kPush = 16.0 / 3;  // N, of the hand below 20 mm inside the wall
const std::vector<std::string> kHomedAlready{"--loaded", "--homed"};

/// A Falcon in a hand of 400 N/m, a wall of 800 N/m at z = 120 mm, and a client.
struct Session {
  Bench bench;
  Wall wall{bench};
  Emulator usb;
  std::string report = (bench.folder.path() / "report.json").string(),
              trace = (bench.folder.path() / "trace.csv").string();
  std::unique_ptr<Process> client;

  /// `faults`: as "mute" or "stale 16", before the client starts.
  explicit Session(const std::vector<std::string>& options = {}, const Lines& faults = {})
      : usb({"falcon:2-1"}, options) {
    usb.command("hand 2-1 stiffness 400 damping 8 mass 0.2");
    usb.command("hand 2-1 place 0 0 0.13");
    for (const std::string& each : faults) fault(each);
    client = start(wall.address);
  }
  std::unique_ptr<Process> start(const std::string& address, const Lines& more = {}) const {
    Lines arguments{"run", bench.client, "--server", address, "--report", report, "--trace", trace};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return usb.start("haptic_client", arguments);
  }
  void fault(const std::string& what) const { usb.command("fault 2-1 " + what); }
  Json state() const { return usb.state("2-1"); }
  int count(const char* key) const { return state()[key].get<int>(); }
  double newton() const { return state()["force"][2].get<double>(); }
  template <class Condition>
  bool wait(Condition condition, double seconds = 10) const {
    return usb.wait_for("2-1", condition, seconds);
  }
  /// Into the wall, until the force is what it must be there.
  bool press() const {
    usb.command("hand 2-1 target 0 0 0.10 0.3");
    return pushes();
  }
  /// Out of it and in: what the motors owe is forgotten where nothing pushes.
  bool press_again() const {
    usb.command("hand 2-1 target 0 0 0.13 0.3");
    return wait([](const Json& s) {
             return s["dac"] == Json({0, 0, 0}) && s["hand_at_rest"] == true;
           }) &&
           press();
  }
  bool pushes() const {
    return wait([](const Json& s) { return std::abs(s["force"][2].get<double>() / kPush - 1) < 0.02; });
  }
  bool silent(double seconds) const {
    return wait([](const Json& s) { return s["dac"] == Json({0, 0, 0}); }, seconds);
  }
  /// True when the device got that many packets more: the ticks go on.
  bool ticks_go_on(int packets) const {
    const int before = count("packets");
    return wait([&](const Json& s) { return s["packets"].get<int>() > before + packets; }, 5);
  }

  /// Ends the client; what must hold after every fault. Returns its report of the tool.
  Json end() {
    client->signal(SIGINT);
    CHECK(client->wait() == 0);
    const Json last = state();
    CHECK(last["dac"] == Json({0, 0, 0}));
    CHECK(last["largest_dac_unhomed"] == 0);
    Json tool = read_json(report)["tools"][0];
    CHECK(tool["force"]["max_newton"].get<double>() <= 8);
    CHECK(tool["safety"]["storms"] == 0);
    CHECK(tool["safety"]["not_finite"] == 0);
    return tool;
  }
  /// What the client said of the device, and nothing else.
  Lines said() const { return said_by(*client); }
  /// Waits until it said so for this many times.
  bool says(const std::string& text, int times) const {
    return wait([&](const Json&) {
      const Lines lines = said();
      return std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
               return line.find(text) != std::string::npos;
             }) >= times;
    });
  }
  static Lines said_by(Process& client) {
    Lines lines;
    std::istringstream all(client.output());
    const std::string name = "haptic_client: ";
    for (std::string line; std::getline(all, line);) {
      if (line.rfind(name, 0) != 0 || line == name + "looking for a Falcon") continue;
      if (line.find("Falcon") != std::string::npos || line.find("USB") != std::string::npos)
        lines.push_back(line.substr(name.size()));
    }
    return lines;
  }
};

void pause(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// Whether these are the lines, each known by a part of it.
void check_lines(const Lines& lines, const Lines& parts) {
  CAPTURE(lines);
  REQUIRE(lines.size() == parts.size());
  for (std::size_t i = 0; i < lines.size(); ++i) CHECK(lines[i].find(parts[i]) != std::string::npos);
}

/// Never faster than the slew limit; and where the force begins, but for the first `walls` times, when the
/// grip came to the wall, it rises over a second. `starts`: how often it begins.
void check_soft_starts(const std::string& trace, int walls, int starts) {
  constexpr double kReply = 0.03;  // s, generously: the gain rises while the first force is on its way
  const std::vector<TraceRow> rows = read_trace(trace);
  int begins = 0;
  double above = 0, jump = 0;  // N: beyond what a soft start, or the slew limit, gives
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double dt = std::min(rows[i].t - rows[i - 1].t, 0.01);
    jump = std::max(jump, rows[i].newton() - rows[i - 1].newton() - 160 * dt);
    if (rows[i - 1].newton() > 0 || rows[i].newton() <= 0 || ++begins <= walls) continue;
    for (std::size_t k = i; k < rows.size() && rows[k].t < rows[i].t + 0.2; ++k)
      above = std::max(above, rows[k].newton() - 8 * (rows[k].t - rows[i - 1].t + kReply));
  }
  CHECK(begins == starts);
  CHECK(above <= 0);
  CHECK(jump <= 1e-9);
}

}  // namespace

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
    return session.bench.folder.write("other.bin", std::string(size, 'x')).string();
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

TEST_CASE("Falcon faults: a control request stalls: told as such, then it works") {
  Session session(kHomedAlready, {"stall 1"});
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  CHECK(session.count("opens") == 2);
  session.end();
  check_lines(session.said(), {"a USB transfer failed", "homed: ready"});
}

TEST_CASE(
    "Falcon faults: split, joined, flooded and spoilt replies: no tick without a place, no more force") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  for (const std::string fault : {"split", "join", "status_flood 12", "garbage 40", "zero_in 40"}) {
    CAPTURE(fault);
    session.fault(fault);
    CHECK(session.ticks_go_on(200));
    CHECK(session.newton() > 1);  // places come late: the wall may go softer
    session.fault(fault.substr(0, fault.find(' ')) + " 0");
  }
  CHECK(session.press_again());
  CHECK(session.count("opens") == 1);
  CHECK(session.end()["force"]["max_newton"].get<double>() < 1.2 * kPush);
  check_lines(session.said(), {"homed: ready"});
  check_soft_starts(session.trace, 2, 2);
}

TEST_CASE("Falcon faults: a flood without end does not hold the loop; told once, and over when it ends") {
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
  REQUIRE(session.wait([](const Json& s) { return s["opens"] == 1; }));
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
  const std::string gone = "the Falcon was unplugged", loading = "loading the Falcon's firmware";
  check_lines(session.said(), {gone, loading, gone, loading, gone, loading, "pull the grip"});
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

TEST_CASE("Falcon faults: a round trip of 20 ms all at once, and back: no storm, no latch, the ticks go on") {
  Session session(kHomedAlready);
  REQUIRE(session.client->wait_for("Falcon homed: ready"));
  REQUIRE(session.press());
  session.fault("latency 20");
  session.usb.command("hand 2-1 target 0.01 0 0.105 0.3");
  CHECK(session.ticks_go_on(1000));
  CHECK(session.newton() > 0.1);  // softer: a late wall would throw the hand about
  session.fault("latency 0");
  CHECK(session.press_again());
  const Json tool = session.end();
  CHECK(session.count("opens") == 1);
  CHECK(tool["safety"]["lost"].get<int>() < 300);  // before it was ready
  check_lines(session.said(), {"homed: ready"});
}

TEST_CASE("Falcon faults: packets stop for a moment: no force without a place, nothing said, then softly") {
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

TEST_CASE("Falcon faults: its IN transfers hang: zero at once, and back without a new homing") {
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

TEST_CASE("Falcon faults: frozen encoders under force are told of, once; the force stays what it was") {
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
  session.end();
  REQUIRE(second->wait_for("Falcon homed: ready"));
  CHECK(session.pushes());
  second->signal(SIGINT);
  CHECK(second->wait() == 0);
  check_lines(session.said(), {"no permission", "homed: ready"});
  check_lines(Session::said_by(*second), {"another program holds", "homed: ready"});
}
