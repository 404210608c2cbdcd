#pragma once
/// A client with an emulated Falcon whose every fault is tested alike.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <sstream>
#include <thread>

#include "tests/support/falcon_bench.h"
#include "tests/support/trace_rows.h"

namespace palpate::test {

inline constexpr double kPush = 16.0 / 3;  // N, of the hand below 20 mm inside the wall
inline const std::vector<std::string> kHomedAlready{"--loaded", "--homed"};

/// A Falcon in a hand of 400 N/m, a wall of 800 N/m at z = 120 mm, and a client.
struct Session {
  Bench bench;
  Wall wall{bench};
  Emulator usb;
  std::string report = (bench.folder.path() / "report.json").string(),
              trace = (bench.folder.path() / "trace.csv").string();
  std::unique_ptr<Process> client;

  /// `faults`: as "mute" or "stale 16", before the client starts.
  explicit Session(const std::vector<std::string>& options = {}, const std::vector<std::string>& faults = {})
      : usb({"falcon:2-1"}, options) {
    usb.command("hand 2-1 stiffness 400 damping 8 mass 0.2");
    usb.command("hand 2-1 place 0 0 0.13");
    for (const std::string& each : faults) fault(each);
    client = start(wall.address);
  }
  std::unique_ptr<Process> start(const std::string& address,
                                 const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run",      bench.client, "--server", address,
                                       "--report", report,       "--trace",  trace};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return usb.start("haptic_client", arguments);
  }
  void fault(const std::string& what) const { usb.command("fault 2-1 " + what); }
  nlohmann::json state() const { return usb.state("2-1"); }
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
  /// Out of it and in: what the motors owe is forgotten where nothing pushes. Within 1 s: a hand of 0.2 kg
  /// that comes within 0.3 s goes 11 mm deep before it rests, and feels 8 N there.
  bool press_again() const {
    usb.command("hand 2-1 target 0 0 0.13 0.3");
    const bool out = wait([](const nlohmann::json& s) {
      return s["dac"] == nlohmann::json({0, 0, 0}) && s["hand_at_rest"] == true;
    });
    usb.command("hand 2-1 target 0 0 0.10 1");
    return out && pushes();
  }
  bool pushes(double seconds = 10) const {
    return wait(
        [](const nlohmann::json& s) { return std::abs(s["force"][2].get<double>() / kPush - 1) < 0.02; },
        seconds);
  }
  bool silent(double seconds) const {
    return wait([](const nlohmann::json& s) { return s["dac"] == nlohmann::json({0, 0, 0}); }, seconds);
  }
  /// True when the device got that many packets more: the ticks go on.
  bool ticks_go_on(int packets) const {
    const int before = count("packets");
    return wait([&](const nlohmann::json& s) { return s["packets"].get<int>() > before + packets; }, 5);
  }

  /// Ends the client; what must hold after every fault. Returns its report of the tool. `alone`: no other
  /// client waits for the device, which would push with it at once.
  nlohmann::json end(bool alone = true) {
    client->signal(SIGINT);
    const int code = client->wait();
    CAPTURE(client->output());
    CHECK(code == 0);
    const nlohmann::json last = state();
    if (alone) CHECK(last["dac"] == nlohmann::json({0, 0, 0}));
    CHECK(last["largest_dac_unhomed"] == 0);
    nlohmann::json tool = read_json(report)["tools"][0];
    CHECK(tool["force"]["max_newton"].get<double>() <= 8);
    CHECK(tool["safety"]["storms"] == 0);
    CHECK(tool["safety"]["not_finite"] == 0);
    return tool;
  }
  /// What the client said of the device, and nothing else.
  std::vector<std::string> said() const { return said_by(*client); }
  /// Waits until it said so for this many times.
  bool says(const std::string& text, int times) const {
    return wait([&](const nlohmann::json&) {
      const std::vector<std::string> lines = said();
      return std::ranges::count_if(lines, [&](const std::string& line) {
               return line.find(text) != std::string::npos;
             }) >= times;
    });
  }
  static std::vector<std::string> said_by(Process& client) {
    std::vector<std::string> lines;
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

inline void pause(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// Whether these are the lines, each known by a part of it.
inline void check_lines(const std::vector<std::string>& lines, const std::vector<std::string>& parts) {
  CAPTURE(lines);
  REQUIRE(lines.size() == parts.size());
  for (std::size_t i = 0; i < lines.size(); ++i) CHECK(lines[i].find(parts[i]) != std::string::npos);
}

/// Never faster than the slew limit; and where the force begins, but for the first `walls` times, when the
/// grip came to the wall, it rises over a second. `starts`: how often it begins at least (a machine that
/// stalls longer than the device may be silent adds one).
inline void check_soft_starts(const std::string& trace, int walls, int starts) {
  constexpr double kReply = 0.03;  // s, generously: the gain rises while the first force is on its way
  const std::vector<TraceRow> rows = read_trace(trace);
  int begins = 0;
  double above = 0, jump = 0;  // N: beyond what a soft start, or the slew limit, gives
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double dt = std::min(rows[i].t - rows[i - 1].t, 0.01);
    jump = std::max(jump, rows[i].newton() - rows[i - 1].newton() - 2000 * dt);
    if (rows[i - 1].newton() > 0 || rows[i].newton() <= 0 || ++begins <= walls) continue;
    for (std::size_t k = i; k < rows.size() && rows[k].t < rows[i].t + 0.2; ++k)
      above = std::max(above, rows[k].newton() - 8 * (rows[k].t - rows[i - 1].t + kReply));
  }
  CHECK(begins >= starts);
  CHECK(above <= 0);
  CHECK(jump <= 1e-9);
}

}  // namespace palpate::test
