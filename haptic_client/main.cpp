#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "common/error.h"
#include "common/program.h"
#include "common/text.h"
#include "haptic_client/commands/calibrate.h"
#include "haptic_client/commands/commtest.h"
#include "haptic_client/commands/devices.h"
#include "haptic_client/commands/evaluate.h"
#include "haptic_client/commands/replay.h"
#include "haptic_client/commands/run.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace {

using namespace palpate;

/// "  name   what it is" for each row of a registry, for help texts.
template <class Table>
std::string list_of(const Table& table) {
  std::string text;
  for (const auto& row : table) text += fmt::format("  {:<24}{}\n", row.name, row.summary);
  return text;
}

struct Overrides {
  std::string server, method, firmware, key;
  bool insecure = false;
  std::vector<std::string> devices;
  std::optional<double> rate_hz;
};

/// What the command line says goes over what the file says.
void apply(const Overrides& o, client::ClientConfig& config) {
  if (!o.server.empty()) {
    config.server = o.server;
    config.server_where = "--server";
  }
  if (!o.key.empty()) config.key = o.key;
  config.insecure = o.insecure;
  if (!o.firmware.empty()) config.device.falcon.firmware = o.firmware;
  if (!o.method.empty()) {
    find_row(client::extrapolators(), o.method, "method", "--method");
    config.method = o.method;
  }
  if (o.rate_hz) {
    require_at_least(*o.rate_hz, client::kMinRate, "--rate", "Hz");
    config.rate_hz = std::min(*o.rate_hz, client::kMaxRate);
  }
}

CLI::App* add_run(CLI::App& app, std::vector<std::string>& files, Overrides& overrides,
                  client::ClientOptions& options) {
  auto* command = app.add_subcommand("run", "Connect to a server and run the haptic loop until Ctrl-C");
  command->add_option("CLIENT", files,
                      "Client file (TOML), one for each tool; without one, a hand that holds still");
  command->add_option("--server", overrides.server, "ADDR:PORT of sim_server (default 127.0.0.1:45130)");
  command->add_option("--key", overrides.key, "File of the key that the server has; see `sim_server keygen`");
  command->add_flag("--insecure", overrides.insecure, "Leave this machine without a key");
  command->add_option("--device", overrides.devices, "Device, see below; once for each tool")
      ->allow_extra_args(false);
  command->add_option("--falcon-firmware", overrides.firmware,
                      "Image for a Falcon that has none since power-up");
  command->add_option("--method", overrides.method, "How to extrapolate the force, see below");
  command
      ->add_option("--rate", overrides.rate_hz,
                   "Haptic ticks per second, 100 to 4000 (default 500; 1000 for a Falcon)")
      ->check(CLI::Range(client::kMinRate, client::kMaxRate));
  command->add_option("--seconds", options.seconds, "Stop after so many seconds");
  command->add_option("--report", options.report, "Write figures of the run to this JSON file");
  command->add_option("--trace", options.trace, "Write the last minute, a row a tick, to this CSV file");
  command->add_option("--record", options.record, "Write every datagram to this capture (pcap)");
  command
      ->add_option("--record-mb", options.record_mb,
                   "Go on in a new file at this size (F-2.pcap, ...); ten are kept")
      ->check(CLI::Range(0.01, 1e6));
  command->footer(
      "Methods:\n" + list_of(client::extrapolators()) + "Devices:\n" + list_of(client::devices()) +
      "Examples: haptic_client run configs/clients/liver.toml --method constant --report report.json\n"
      "          haptic_client run left.toml right.toml          two devices, each with a tool of its own");
  return command;
}

CLI::App* add_replay(CLI::App& app, std::string& file, Overrides& overrides, client::ReplayOptions& options,
                     bool& live) {
  auto* command = app.add_subcommand("replay",
                                     "Run a captured session again: offline, the same forces bit by bit; or "
                                     "--live, its tool against a server");
  command
      ->add_option("CAPTURE", options.capture, "pcap or pcapng: of --record, sim_server record, tcpdump ...")
      ->required();
  command->add_option(
      "--client", file,
      "Client file of the session: workspace, limits and laws to score (default: all defaults)");
  command->add_option("--method", overrides.method, "How to extrapolate the force, see below");
  command->add_option("--rate", options.rate_hz,
                      "Ticks per second, 1 to 20000 (default, or within 2 %: the capture's own ticks)");
  command->add_option("--out", options.out, "CSV to write, a row a tick; with --live, of the last minute");
  command->add_option("--session", options.session, "Which session, where the capture has several");
  command->add_option("--report", options.report, "Write figures to this JSON file");
  auto* to_server = command->add_flag(
      "--live", live, "Play the captured tool to a live server, in real time; nothing is moved");
  command->add_option("--to", overrides.server, "ADDR:PORT of that server (default 127.0.0.1:45130)")
      ->needs(to_server);
  command->add_option("--key", overrides.key, "File of the key that the server has")->needs(to_server);
  command->add_flag("--insecure", overrides.insecure, "Leave this machine without a key")->needs(to_server);
  command->footer(
      "Methods:\n" + list_of(client::extrapolators()) +
      "Examples: haptic_client replay --live liver.pcap --to 192.168.1.20:45130 --key palpate.key\n"
      "          haptic_client replay liver.pcap --method constant --out forces.csv");
  return command;
}

CLI::App* add_calibrate(CLI::App& app, std::string& device, std::string& file, Overrides& overrides,
                        double& mass) {
  auto* command = app.add_subcommand(
      "calibrate", "Find the torque constant of a Falcon with a known weight hung on its grip; no server");
  command->add_option("DEVICE", device, "falcon, or falcon:PORT; stands upright on a table")->required();
  command->add_option("--mass", mass, "Of the weight, kg, 0.05 to 0.5; 0.1 does for most")->required();
  command->add_option("--client", file, "Client file: firmware and limits (default: all defaults)");
  command->add_option("--falcon-firmware", overrides.firmware,
                      "Image for a Falcon that has none since power-up");
  command->footer(
      "It says what to do: home the device, let go of the grip, hang the weight on it, wait. It takes a "
      "minute\n"
      "and ends with the line for [falcon] of the client file, which it does not change.\n"
      "Example: haptic_client calibrate falcon --mass 0.1 --falcon-firmware PATH");
  return command;
}

CLI::App* add_commtest(CLI::App& app, std::string& server, std::string& device, std::string& file,
                       Overrides& overrides, client::CommtestOptions& options) {
  auto* command = app.add_subcommand(
      "commtest", "Is the link to a server good enough? Or, with --usb, the loop of a device");
  command->add_option("ADDR:PORT", server, "Of sim_server (default: that of the client file)");
  command->add_option("--usb", device, "Test this device instead, with zero force: falcon, or falcon:PORT");
  command->add_option("--client", file, "Client file: its motion, rate and law (default: all defaults)");
  command->add_option("--method", overrides.method, "Extrapolation law that the verdict is of");
  command->add_option("--key", overrides.key, "File of the key that the server has");
  command->add_flag("--insecure", overrides.insecure, "Leave this machine without a key");
  command->add_option("--seconds", options.seconds, "How long")->capture_default_str();
  command->add_option("--wait", options.wait, "For the server to answer, s")->capture_default_str();
  command->add_option("--json", options.json, "Write the same to this JSON file");
  command->footer(
      "A session as `run` would have it, by a simulated hand that holds a tool meanwhile, and round trips "
      "beside it.\n"
      "The verdict is that of the stability study: PASS, WARN, or FAIL (exit code 1).\n"
      "Examples: haptic_client commtest 192.168.1.20:45130 --client configs/clients/liver.toml --key "
      "palpate.key\n"
      "          haptic_client commtest --usb falcon");
  return command;
}

client::ClientConfig read_config(const std::string& file, const Overrides& overrides) {
  client::ClientConfig config = file.empty() ? client::ClientConfig{} : client::read_client_config(file);
  apply(overrides, config);
  return config;
}

CLI::App* add_evaluate(CLI::App& app, client::EvaluateOptions& options) {
  auto* command = app.add_subcommand("evaluate", "Score every law on captures, against the true force");
  command->add_option("CAPTURE", options.captures, "Captures, best of sim_server record")->required();
  command->add_option(
      "--truth", options.truth,
      "Capture of the same motion at 200 samples a second or more: `sim_server record ... --rate "
      "2000 --plain` (default: the force between the samples)");
  command->add_option("--out", options.out, "Folder for summary.json and summary.csv")->required();
  command->add_option("--method", options.methods, "Laws (default: all)")->allow_extra_args(false);
  command->add_option("--world", options.world, "Name for the first column (default: the capture's)");
  command->add_option("--blend-ms", options.blend_ms, "Time constant of the blended rows (default 10 ms)");
  command
      ->add_option("--keep", options.keep,
                   "Laws get one force sample of so many: 4 makes 20 Hz of 80 Hz, and the reference the line "
                   "between those that are left, as in the paper (default 1)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--compliance", options.compliance,
                   "Laws see a surface model so many times as compliant as it was sent (default 1)")
      ->check(CLI::Range(0.01, 100.0));
  command->footer("Methods:\n" + list_of(client::extrapolators()) +
                  "Example: haptic_client evaluate liver.pcap --truth truth.pcap --out out/evaluation");
  return command;
}

/// A configuration for each tool: of each file, with the device of the same place on the command line; where
/// there are more devices than files, the last file serves the rest.
std::vector<client::ClientConfig> read_configs(const std::vector<std::string>& files,
                                               const Overrides& overrides) {
  const std::size_t tools = std::max({files.size(), overrides.devices.size(), std::size_t{1}});
  if (!overrides.devices.empty() && overrides.devices.size() < tools)
    fail("{} client files, but {} --device; give one for each, or none", files.size(),
         overrides.devices.size());
  std::vector<client::ClientConfig> configs;
  for (std::size_t i = 0; i < tools; ++i) {
    const std::string file = files.empty() ? "" : files[std::min(i, files.size() - 1)];
    configs.push_back(read_config(file, overrides));
    if (!overrides.devices.empty())
      client::choose_device(configs.back().device, overrides.devices[i], "--device");
    const client::DeviceSettings& device = configs.back().device;
    if (file.empty() && !overrides.rate_hz)
      configs.back().rate_hz = client::row_of(device).limits(device).usual_rate_hz;
  }
  return configs;
}

/// Tests the device, or where none is named the link to the server. Both go over what the client file says.
int run_commtest(const std::string& server, const std::string& device, const std::string& file,
                 Overrides& overrides, const client::CommtestOptions& options) {
  require_within(options.seconds, 1, 86400, "--seconds", "s");
  require_within(options.wait, 0.1, 3600, "--wait", "s");
  if (!server.empty()) overrides.server = server;
  client::ClientConfig config = read_config(file, overrides);
  if (!server.empty()) config.server_where = "ADDR:PORT";
  if (device.empty()) return client::test_link(config, options);
  client::choose_device(config.device, device, "--usb");
  if (file.empty()) config.rate_hz = client::row_of(config.device).limits(config.device).usual_rate_hz;
  return client::test_device(config, options);
}

int run(int argc, char** argv) {
  CLI::App app{"Drives a force-feedback device at haptic rate from forces computed by sim_server."};
  app.require_subcommand(1);
  app.footer("Example: haptic_client run configs/clients/liver.toml --seconds 20");
  std::vector<std::string> files;
  std::string file;
  Overrides overrides;
  client::ClientOptions running;
  client::ReplayOptions replaying;
  std::string device;
  double mass = 0;
  add_run(app, files, overrides, running);
  bool live = false;
  const auto* replay = add_replay(app, file, overrides, replaying, live);
  const auto* calibrate = add_calibrate(app, device, file, overrides, mass);
  std::string tested_server, tested_device;
  client::CommtestOptions testing;
  const auto* commtest = add_commtest(app, tested_server, tested_device, file, overrides, testing);
  const auto* list =
      app.add_subcommand("devices", "List the devices that are plugged in, and whether they can be used")
          ->footer("Example: haptic_client devices");
  client::EvaluateOptions evaluating;
  const auto* score = add_evaluate(app, evaluating);
  if (const auto ended = parse_arguments(app, argc, argv)) return *ended;
  if (*list) return client::print_plugged_in();
  if (*score) {
    require_within(evaluating.blend_ms, 0.1, 100, "--blend-ms", "ms");
    return client::evaluate(evaluating);
  }
  if (*calibrate) {
    client::ClientConfig config = read_config(file, overrides);
    client::choose_device(config.device, device, "DEVICE");
    return client::calibrate(config, mass);
  }
  if (*commtest) return run_commtest(tested_server, tested_device, file, overrides, testing);
  if (*replay) {
    if (replaying.rate_hz) require_within(*replaying.rate_hz, 1, 20000, "--rate", "Hz");
    if (live && replaying.rate_hz) fail("--rate: a live replay has the capture's own rate");
    return (live ? client::replay_live : client::replay)(read_config(file, overrides), replaying);
  }
  if (running.seconds) require_at_least(*running.seconds, 1e-3, "--seconds", "s");
  return client::run_client(read_configs(files, overrides), running);
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::run_program("haptic_client", argc, argv, &run);
}
