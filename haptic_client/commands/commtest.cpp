#include "haptic_client/commands/commtest.h"

#include <algorithm>
#include <fmt/core.h>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/realtime.h"
#include "haptic_client/commands/commtest_verdict.h"
#include "haptic_client/commands/link_causes.h"
#include "haptic_client/commands/overrides.h"
#include "haptic_client/device/devices.h"
#include "haptic_client/session/held_tool.h"
#include "haptic_client/session/link_probe.h"
#include "haptic_client/session/server_access.h"

namespace palpate::client {
namespace {

/// Waits so long, or until Ctrl-C; returns how long it was, s.
double rest(double seconds) {
  const Time begin = now();
  while (to_seconds(now() - begin) < seconds) {
    if (wait_for_interrupt(std::chrono::milliseconds(100))) break;
  }
  return to_seconds(now() - begin);
}

std::string quantiles_text(const Json& q, const char* unit) {
  return fmt::format("{:.4g} {} (p50), {:.4g} (p99), {:.4g} (p99.9), {:.4g} (max)", q["p50"].get<double>(),
                     unit, q["p99"].get<double>(), q["p999"].get<double>(), q["max"].get<double>());
}

Json probe_report(const LinkProbe::Figures& f) {
  return {{"ms", quantiles(f.round_trip_ns, 1e6)},
          {"jitter_ms", 1e-6 * f.jitter_ns},
          {"sent", f.sent},
          {"bytes_up", f.bytes_up},
          {"lost", f.lost},
          {"reordered", f.reordered}};
}

constexpr double kHeaders = 28;  // bytes of IPv4 and UDP, of each datagram

double kbit_s(double bytes, double datagrams, double seconds) {
  return 8e-3 * (bytes + kHeaders * datagrams) / seconds;
}

double percent(double part, double entire) {
  return entire > 0 ? 100 * part / entire : 0;
}

/// Share of the time in which less travelled than a session has to tell, but for its first seconds.
double slow_percent(const Json& levels) {
  constexpr double kBegins = 2;  // s
  double all = 0;
  for (const auto& [name, seconds] : levels.items()) all += seconds.get<double>();
  const double slow = all - levels[name_of(LinkLevel::kFull)].get<double>() - kBegins;
  return percent(std::max(slow, 0.0), all);
}

/// The law is the one that was at work, which need not be the one asked for.
TestedLink tested_link(const Json& tool, double seconds) {
  const Json& link = tool["link"];
  const double came = tool["force"]["samples"].get<double>(), lost = link["values_lost"].get<double>();
  const double loss = percent(lost, lost + came);
  const double up_came = link["uplink"]["came"].get<double>(),
               up_lost = link["uplink"]["lost"].get<double>();  // as the server counts them
  return {.law = tool["rendered"]["law"].get<std::string>(),
          .seconds = seconds,
          .age_p99_ms = link["age_ms"]["p99"].get<double>(),
          .stiffest_n_m = link["stiffest_n_m"].get<double>(),
          .samples_hz = came / seconds,  // of all the time, so that a server that went silent shows
          .rate_hz = tool["link"]["rate_hz"].get<double>(),
          .loss_percent = loss,
          .connected = came > 0,
          .longest_gap_ms = link["longest_gap_ms"].get<double>(),
          .gaps = link["gaps"].get<std::uint64_t>(),
          .faded = tool["safety"]["ramped"].get<std::uint64_t>(),
          .sent_mbit_s = 1e-3 * kbit_s(link["bytes_up"].get<double>(), link["sent"].get<double>(), seconds),
          .uplink_loss_percent = percent(up_lost, up_came + up_lost),
          .slow_percent = slow_percent(link["levels_s"]),
          .drops_large = link["drops_large"].get<bool>()};
}

void print_round_trip(const Json& trip, double seconds) {
  const Json& ms = trip["ms"];
  fmt::print(
      "  round trip  {:.4g} ms (p50), {:.4g} (max); jitter {:.3g} ms; {} of {} lost ({:.2f} %), "
      "{} reordered; these took {:.0f} kbit/s up beside the session\n",
      ms["p50"].get<double>(), ms["max"].get<double>(), trip["jitter_ms"].get<double>(),
      trip["lost"].get<long>(), trip["sent"].get<long>(),
      percent(trip["lost"].get<double>(), trip["sent"].get<double>()), trip["reordered"].get<long>(),
      kbit_s(trip["bytes_up"].get<double>(), trip["sent"].get<double>(), seconds));
}

void print_session(const Json& tool, double seconds) {
  const Json &link = tool["link"], &force = tool["force"];
  const Json& up = link["uplink"];
  fmt::print("  uplink      {} of {} datagrams came to the server, as it counts them\n",
             up["came"].get<long>(), up["came"].get<long>() + up["lost"].get<long>());
  fmt::print("  samples     {:.1f} a second; {} lost, {} reordered, {} doubled\n",
             tool["motion"]["sample_rate_hz"].get<double>(), link["values_lost"].get<long>(),
             link["reordered"].get<long>(), link["duplicated"].get<long>());
  fmt::print(
      "  age         {} when a sample came, since its tool was read: way there, wait, step, way back\n",
      quantiles_text(link["age_ms"], "ms"));
  fmt::print(
      "  gaps        {} of more than 100 ms between samples, the longest {:.0f} ms; the force faded {} "
      "times\n",
      link["gaps"].get<long>(), link["longest_gap_ms"].get<double>(), tool["safety"]["ramped"].get<long>());
  fmt::print("  bytes       {:.0f} kbit/s up, {:.0f} kbit/s down, {:.1f} kB in the first second\n",
             8e-3 * link["bytes_up"].get<double>() / seconds,
             8e-3 * link["bytes_down"].get<double>() / seconds,
             1e-3 * link["bytes_down_first_second"].get<double>());
  const Json& itself = link["first_itself_s"];
  fmt::print("  law         \"{}\"{}; {} pages of the surface came\n", tool["method"].get<std::string>(),
             itself.is_null() ? std::string(" never had what it needs")
                              : fmt::format(" at work {:.2f} s after the first sample", itself.get<double>()),
             force["surface_pages"].get<long>());
}

void print_causes(const Json& causes) {
  for (const Json& cause : causes) fmt::print("  look at     {}\n", cause.get<std::string>());
}

void print_verdict(const Json& verdict) {
  fmt::print("  {}        {}\n", verdict["grade"].get<std::string>(),
             verdict["reasons"].empty() ? "" : verdict["reasons"][0].get<std::string>());
  for (std::size_t i = 1; i < verdict["reasons"].size(); ++i)
    fmt::print("              {}\n", verdict["reasons"][i].get<std::string>());
  if (verdict["grade"] != name_of(Grade::kPass)) print_causes(verdict["what_to_check"]);
  std::fflush(stdout);
}

/// A hand that is none, where the client file has a motion for it.
ClientConfig with_simulated_hand(ClientConfig config) {
  config.device.name = "simulated";
  config.device.port.clear();
  config.score = std::vector<std::string>{};
  return config;
}

}  // namespace

int test_link(const ClientConfig& requested, const CommtestOptions& options) {
  const ClientConfig config = with_simulated_hand(requested);
  if (options.json) check_writable(*options.json, Contents::kReport);
  HeldTool tool(config, {}, "", options.seconds);
  LinkProbe probe(server_of(config), key_of(config));
  if (!tool.connect(from_seconds(options.wait)))
    fail_at_run_time("commtest: interrupted before a server at {} had answered", config.server);
  fmt::print("testing the link for {:g} s, with a simulated hand, which holds a tool meanwhile\n",
             options.seconds);
  std::fflush(stdout);
  probe.start();
  tool.start(nullptr);
  const double seconds = rest(options.seconds);
  tool.stop();
  probe.stop();
  const Json of_tool = tool.report();
  const TestedLink tested = tested_link(of_tool, seconds);
  const Verdict verdict = judge(tested);
  std::vector<std::string> causes = verdict.remedies;
  std::ranges::copy(link_causes(tool.local()), std::back_inserter(causes));
  const Json report = {
      {"server", config.server},
      {"seconds", seconds},
      {"round_trip", probe_report(probe.figures())},
      {"tool", of_tool},
      {"verdict",
       {{"grade", name_of(verdict.grade)}, {"reasons", verdict.reasons}, {"what_to_check", causes}}}};
  fmt::print("haptic_client: link to {}\n", config.server);
  print_round_trip(report["round_trip"], seconds);
  print_session(of_tool, seconds);
  print_verdict(report["verdict"]);
  if (options.json) write_json(*options.json, report);
  return verdict.grade == Grade::kFail ? 1 : 0;
}

int test_device(const ClientConfig& config, const CommtestOptions& options) {
  if (options.json) check_writable(*options.json, Contents::kReport);
  if (!is_plugged_in(config.device)) fail_at_run_time("{}", no_device_text(config.device));
  const DeviceRow& row = row_of(config.device);
  const double rate_hz = std::min(config.rate_hz, 1 / to_seconds(row.limits(config.device).min_period));
  const Time period = from_seconds(1 / rate_hz);
  const auto device = row.make(config.device);
  fmt::print("testing {} at {:g} Hz for {:g} s, with zero force\n", config.device.name, rate_hz,
             options.seconds);
  std::fflush(stdout);
  take_role(ThreadRole::kHaptic);
  Histogram took_ns, between_ns;
  std::uint64_t ticks = 0, usable = 0, late = 0;
  Time before{};
  for (Time due = now(), end = due + from_seconds(options.seconds); due < end; ++ticks) {
    sleep_until(due);
    const Time begin = now();
    usable += device->read(begin).valid ? 1 : 0;
    device->write(Vec3::Zero());
    took_ns.add((now() - begin).count());
    if (ticks > 0) between_ns.add((begin - before).count());
    before = begin;
    for (due += period; due < now(); due += period) ++late;
    if (ticks % 64 == 0 && wait_for_interrupt(Time{})) break;
  }
  device->stop();
  const Json report = {{"device", config.device.name},
                       {"rate_hz", rate_hz},
                       {"ticks", ticks},
                       {"missed", late},
                       {"usable", usable},
                       {"exchange_us", quantiles(took_ns, 1e3)},
                       {"period_us", quantiles(between_ns, 1e3)},
                       {"what_to_check", machine_causes()}};
  fmt::print("  exchange    {}: one reading and one force\n", quantiles_text(report["exchange_us"], "us"));
  fmt::print("  period      {}; {} of {} deadlines missed\n", quantiles_text(report["period_us"], "us"), late,
             ticks + late);
  fmt::print("  readings    {} of {} usable{}{}\n", usable, ticks,
             usable < ticks ? "; the device says: " : "", usable < ticks ? device->status() : "");
  print_causes(report["what_to_check"]);
  if (options.json) write_json(*options.json, report);
  return usable > 0 ? 0 : 1;
}

namespace {

struct TestRequest {
  std::string server, device;
  Overrides overrides;
  CommtestOptions options;
};

/// Tests the device, or where none is named the link to the server. Both go over what the client file says.
int run_commtest(const TestRequest& requested) {
  require_within(requested.options.seconds, 1, 86400, "--seconds", "s");
  require_within(requested.options.wait, 0.1, 3600, "--wait", "s");
  Overrides overrides = requested.overrides;
  overrides.server = requested.server;
  ClientConfig config = read_config(overrides);
  if (!requested.server.empty()) config.server_where = "ADDR:PORT";
  if (requested.device.empty()) return test_link(config, requested.options);
  choose_device(config.device, requested.device, "--usb");
  if (overrides.file.empty()) config.rate_hz = row_of(config.device).limits(config.device).usual_rate_hz;
  return test_device(config, requested.options);
}

}  // namespace

Command commtest_command() {
  const auto requested = std::make_shared<TestRequest>();
  Overrides& overrides = requested->overrides;
  CommtestOptions& options = requested->options;
  return {.name = "commtest",
          .summary = "Is the link to a server good enough? Or, with --usb, the loop of a device",
          .footer =
              "A session as `run` would have it, by a simulated hand that holds a tool meanwhile, and "
              "five round trips a second beside it, which take 12 kbit/s up.\n"
              "The verdict is that of the stability study: PASS, WARN, or FAIL (exit code 1).\n"
              "Examples: haptic_client commtest 192.168.1.20:45130 --client configs/clients/liver.toml "
              "--key palpate.key\n"
              "          haptic_client commtest --usb falcon",
          .options = {{"ADDR:PORT", "Of sim_server (default: that of the client file)", &requested->server},
                      {"--usb", "Test this device instead, with zero force: falcon, or falcon:PORT",
                       &requested->device},
                      {"--client", "Client file: its motion, rate and law (default: all defaults)",
                       &overrides.file},
                      {"--method", "Extrapolation law that the verdict is of", &overrides.method},
                      {"--key", "File of the key that the server has", &overrides.key},
                      insecure_option(overrides),
                      {"--seconds", "How long", &options.seconds, {.shows_default = true}},
                      {"--wait", "For the server to answer, s", &options.wait, {.shows_default = true}},
                      {"--json", "Write the same to this JSON file", &options.json}},
          .run = [requested] { return run_commtest(*requested); }};
}

}  // namespace palpate::client
