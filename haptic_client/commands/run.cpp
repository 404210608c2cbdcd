#include "haptic_client/commands/run.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <list>
#include <memory>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <set>
#include <unistd.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/log.h"
#include "common/overwrite.h"
#include "common/realtime.h"
#include "common/text.h"
#include "haptic_client/commands/overrides.h"
#include "haptic_client/device/devices.h"
#include "haptic_client/session/client_report.h"
#include "haptic_client/session/guardian.h"
#include "haptic_client/session/held_tool.h"

namespace palpate::client {
namespace {

using Path = std::filesystem::path;

/// F.csv, or F-2.csv for the second of several tools.
std::optional<Path> numbered(const std::optional<Path>& file, std::size_t number, std::size_t of) {
  if (!file || of == 1) return file;
  Path name = *file;
  return name.replace_filename(
      fmt::format("{}-{}{}", file->stem().string(), number, file->extension().string()));
}

std::string name_of_tool(const ClientConfig& config, std::size_t number, std::size_t of) {
  if (of == 1) return "";
  const DeviceSettings& device = config.device;
  return fmt::format("tool {} ({}{}{}): ", number, device.name, device.port.empty() ? "" : ":", device.port);
}

/// Two tools need two devices, and one server.
void check_together(const std::vector<ClientConfig>& configs) {
  std::set<std::pair<std::string, std::string>> taken;
  for (const ClientConfig& config : configs) {
    const DeviceSettings& device = config.device;
    if (config.server != configs.front().server) {
      fail("{}: server \"{}\", but the first tool has \"{}\"; all tools of one run are at one server",
           config.server_where, config.server, configs.front().server);
    }
    if (configs.size() == 1 || device.name == "simulated") continue;
    const bool several = std::ranges::count_if(configs, [&](const ClientConfig& other) {
                           return other.device.name == device.name;
                         }) > 1;
    if (several && device.port.empty())
      fail(
          "{}: of several devices \"{}\" each needs its port, such as {}:2-1; `haptic_client devices` lists "
          "them",
          device.where, device.name, device.name);
    if (!taken.insert({device.name, device.port}).second)
      fail("{}: two tools cannot hold the same device {}:{}", device.where, device.name, device.port);
  }
}

std::vector<ToolFiles> files_of_tools(const ClientOptions& options, std::size_t tools) {
  std::vector<ToolFiles> files;
  for (std::size_t i = 1; i <= tools; ++i)
    files.push_back({numbered(options.trace, i, tools), numbered(options.record, i, tools), options.record_mb,
                     options.force});
  return files;
}

/// That the files of a run can be written, and none over another or over a motion that is read.
void check_files(const std::optional<Path>& report, const std::vector<ToolFiles>& files,
                 const std::vector<ClientConfig>& configs) {
  std::vector<NamedFile> written{{"--report", report}};
  for (const ToolFiles& tool : files)
    written.insert(written.end(), {{"--trace", tool.trace}, {"--record", tool.record}});
  require_distinct(written);
  for (const ClientConfig& config : configs) {  // several may follow the same one
    if (!config.device.trajectory) continue;
    std::vector<NamedFile> with_motion = written;
    with_motion.push_back({"the [trajectory] of the client file", config.device.trajectory->file});
    require_distinct(with_motion);
  }
  if (report) check_writable(*report, Contents::kReport);
  for (const ToolFiles& tool : files) {
    if (tool.trace) check_writable(*tool.trace, Contents::kTable);
  }
}

/// A device may be plugged in later; but one that is looked for in the wrong place never will be.
void report_missing_ports(const std::vector<ClientConfig>& configs) {
  for (const ClientConfig& config : configs) {
    const DeviceSettings& device = config.device;
    if (device.port.empty() || row_of(device).ports == nullptr) continue;
    const std::vector<std::string> ports = row_of(device).ports();
    if (std::ranges::count(ports, device.port) > 0) continue;
    log::warning(
        "{}: no {} at port {}; {}; waiting for it to be plugged in", device.where, device.name, device.port,
        ports.empty() ? "there is none at any other" : fmt::format("there are: {}", fmt::join(ports, ", ")));
  }
}

/// True if the device gave nothing in the whole run, and is not there at its end.
bool never_there(const ClientConfig& config, const Json& tool) {
  const DeviceSettings& device = config.device;
  if (tool["loop"]["ticks"] == 0 || tool["safety"]["lost"] != tool["loop"]["ticks"]) return false;
  return !is_plugged_in(device);
}

/// True if a line can be printed without waiting: nobody who reads slowly may keep us from Ctrl-C.
bool takes_output() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) > 0 && (out.revents & POLLOUT) != 0;
}

void watch(std::list<HeldTool>& tools, std::optional<double> seconds) {
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  const double period = terminal ? 0.2 : 5;  // s
  double next = 0;
  for (const Time start = now();;) {
    const double elapsed = to_seconds(now() - start);
    if (seconds && elapsed >= *seconds) break;
    for (HeldTool& tool : tools) tool.look();
    if (elapsed >= next && takes_output()) {
      next = (std::floor(elapsed / period) + 1) * period;
      fmt::print("{}haptic_client: {:6.1f} s", terminal ? "\r" : "", elapsed);
      for (const HeldTool& tool : tools) fmt::print("  {}", tool.progress());
      fmt::print("{}", terminal ? "  " : "\n");
      std::fflush(stdout);
    }
    const double remaining = seconds ? *seconds - elapsed : 0.1;
    if (wait_for_interrupt(from_seconds(std::min(remaining, 0.1)))) break;
    if (take_rearm_request()) {
      for (HeldTool& tool : tools) tool.rearm();
    }
  }
  if (terminal) fmt::print("\n");
}

}  // namespace

int run_client(const std::vector<ClientConfig>& configs, const ClientOptions& options) {
  check_together(configs);
  const std::vector<ToolFiles> files = files_of_tools(options, configs.size());
  check_files(options.report, files, configs);
  report_missing_ports(configs);
  Guardian guardian(configs);  // before any thread; goes after the tools
  std::list<HeldTool> tools;
  for (std::size_t i = 0; i < configs.size(); ++i)
    tools.emplace_back(configs[i], files[i], name_of_tool(configs[i], i + 1, configs.size()),
                       options.seconds);
  // One after the other, so that the first tool of the scene is the first one here.
  const bool connected = std::ranges::all_of(tools, [](HeldTool& tool) { return tool.connect(); });
  if (connected) {
    std::size_t i = 0;
    for (HeldTool& tool : tools) tool.start(guardian.heartbeat(i++));
    // After the threads, whose stacks a small limit would not hold.
    if (const std::string refused = lock_memory(); !refused.empty()) log::warning("{}", refused);
    watch(tools, options.seconds);
  }
  for (HeldTool& tool : tools) tool.halt();
  guardian.dismiss();
  for (HeldTool& tool : tools) tool.stop();
  Json report = {{"server", configs.front().server}, {"tools", Json::array()}};
  for (const HeldTool& tool : tools) report["tools"].push_back(tool.report());
  // Files first: what is printed may go to a pipe that has been closed.
  if (options.report) write_json(*options.report, report);
  for (const HeldTool& tool : tools) tool.write_files();
  if (connected)
    print_report(report);
  else
    fmt::print("haptic_client: ended before a server at {} had answered; nothing was rendered\n",
               configs.front().server);
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const DeviceSettings& device = configs[i].device;
    if (never_there(configs[i], report["tools"][i])) fail_at_run_time("{}", no_device_text(device));
  }
  return 0;
}

namespace {

struct RunRequest {
  std::vector<std::string> files, devices;
  Overrides overrides;
  ClientOptions options;
};

/// A configuration for each tool: of each file, with the device of the same place on the command line; where
/// there are more devices than files, the last file serves the rest.
std::vector<ClientConfig> read_configs(const RunRequest& requested) {
  const std::size_t tools = std::max({requested.files.size(), requested.devices.size(), std::size_t{1}});
  if (!requested.devices.empty() && requested.devices.size() < tools)
    fail("{} client files, but {} --device; give one for each, or none", requested.files.size(),
         requested.devices.size());
  std::vector<ClientConfig> configs;
  for (std::size_t i = 0; i < tools; ++i) {
    Overrides overrides = requested.overrides;
    if (!requested.files.empty()) overrides.file = requested.files[std::min(i, requested.files.size() - 1)];
    configs.push_back(read_config(overrides));
    if (!requested.devices.empty()) choose_device(configs.back().device, requested.devices[i], "--device");
    const DeviceSettings& device = configs.back().device;
    if (overrides.file.empty() && !overrides.rate_hz)
      configs.back().rate_hz = row_of(device).limits(device).usual_rate_hz;
  }
  return configs;
}

}  // namespace

Command run_command() {
  const auto requested = std::make_shared<RunRequest>();
  Overrides& overrides = requested->overrides;
  ClientOptions& options = requested->options;
  return {
      .name = "run",
      .summary = "Connect to a server and run the haptic loop until Ctrl-C",
      .footer =
          list_of_laws() + "Devices:\n" + help_rows(devices()) +
          "Examples: haptic_client run configs/clients/liver.toml --method constant --report report.json\n"
          "          haptic_client run left.toml right.toml          two devices, each with a tool of its "
          "own",
      .options = {{"CLIENT", "Client file (TOML), one for each tool; without one, a hand that holds still",
                   &requested->files},
                  {"--server", "ADDR:PORT of sim_server (default 127.0.0.1:45130)", &overrides.server},
                  {"--key", "File of the key that the server has; see `sim_server keygen`", &overrides.key},
                  insecure_option(overrides),
                  {"--device",
                   "Device, see below; once for each tool",
                   &requested->devices,
                   {.one_at_a_time = true}},
                  firmware_option(overrides),
                  {"--method", "How to extrapolate the force, see below", &overrides.method},
                  {"--rate",
                   "Haptic ticks per second, 100 to 4000 (default 500; 1000 for a Falcon)",
                   &overrides.rate_hz,
                   {.within = Bounds{kMinRate, kMaxRate}}},
                  {"--seconds", "Stop after so many seconds", &options.seconds},
                  {"--report", "Write figures of the run to this JSON file", &options.report},
                  {"--trace", "Write the last minute, a row a tick, to this CSV file", &options.trace},
                  {"--record", "Write every datagram to this capture (pcap)", &options.record},
                  {"--record-mb",
                   "Go on in a new file at this size (F-2.pcap, ...); ten are kept",
                   &options.record_mb,
                   {.within = Bounds{0.01, 1e6}}},
                  force_option(options.force)},
      .run = [requested] {
        if (requested->options.seconds) require_at_least(*requested->options.seconds, 1e-3, "--seconds", "s");
        return run_client(read_configs(*requested), requested->options);
      }};
}

}  // namespace palpate::client
