#include "haptic_client/commands/calibrate.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <thread>
#include <unistd.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/latest_value.h"
#include "common/log.h"
#include "common/program.h"
#include "common/realtime.h"
#include "common/text.h"
#include "common/units.h"
#include "haptic_client/calibration/calibration.h"
#include "haptic_client/commands/overrides.h"
#include "haptic_client/device/devices.h"
#include "haptic_client/session/guardian.h"
#include "haptic_client/session/haptic_loop.h"

namespace palpate::client {
namespace {

using Stage = CalibrationStage;
using Trouble = CalibrationTrouble;

constexpr double kLeastMass = 0.05, kMostMass = 0.5;  // kg
constexpr double kMostTilt = 10;                      // degrees
constexpr int kPatience = 30;                         // looks of 100 ms
constexpr int kPollsPerClock = 10, kAbsences = 5;     // looks between two at what is plugged in; of those

/// Haptic thread: ticks until the calibration has ended or is asked to stop; writes zero force last.
void run_loop(const std::stop_token& stop, Device& device, Calibration& calibration, Time period,
              LatestValue<CalibrationProgress>& progress, Heartbeat* heartbeat) noexcept {
  for (Time deadline = now(); !stop.stop_requested() && !calibration.ended();) {
    sleep_until(deadline);
    device.write(calibration.tick(device.read(now())));
    progress.write(calibration.progress());
    if (heartbeat != nullptr) heartbeat->beat();
    deadline = std::max(deadline + period, now());  // what is late is given up
  }
  const bool at_rest = device.stop();
  if (heartbeat != nullptr) heartbeat->end(at_rest);
}

std::string what_to_do(const CalibrationProgress& progress, double mass) {
  if (progress.held) return "something holds the grip: let go of it";
  switch (progress.stage) {
    case Stage::kHome:
      return "1/5 home the Falcon; it stands upright, nothing hangs on the grip";
    case Stage::kCentre:
      return "2/5 let go of the grip; it goes to the middle by itself";
    case Stage::kWeighGrip:
      return "3/5 do not touch it: it swings by 4 mm, to weigh the grip alone";
    case Stage::kHang:
      return fmt::format("4/5 hang the weight of {:g} kg on the grip and let go of both, slowly", mass);
    case Stage::kWeighBoth:
      return "5/5 do not touch it: it swings by 4 mm, to weigh both";
    case Stage::kLetDown:
      return "hold the weight: the force goes off now";
    case Stage::kEnd:
      break;
  }
  return "";
}

/// Looks once a second, until there is a reading, whether the device is there; throws `Error` when it was not
/// five times in a row (as it is away for a moment when it gets its firmware).
class Presence {
 public:
  explicit Presence(const DeviceSettings& settings) : settings_(settings) {}
  void look(const CalibrationProgress& progress) {
    if (progress.stage != Stage::kHome || ++polls_ % kPollsPerClock != 0) return;
    absences_ = is_plugged_in(settings_) ? 0 : absences_ + 1;
    if (absences_ == kAbsences) fail_at_run_time("{}", no_device_text(settings_));
  }

 private:
  const DeviceSettings& settings_;
  int polls_ = 0, absences_ = 0;
};

/// Talks to the user while the loop runs; true on Ctrl-C. Throws `Error` where there is no device.
bool guide(LatestValue<CalibrationProgress>& newest, const Device& device, const DeviceSettings& settings,
           double mass) {
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  std::string said, status;
  CalibrationProgress progress;
  Presence presence(settings);
  for (int standstills = 0; progress.stage != Stage::kEnd;) {
    if (wait_for_interrupt(std::chrono::milliseconds(100))) return true;
    standstills = newest.read(progress) ? 0 : standstills + 1;
    if (standstills == kPatience) {  // its last force may still be on the motors
      log::error("the haptic loop stands still; the guardian takes the device over");
      std::abort();
    }
    presence.look(progress);
    const std::string text = what_to_do(progress, mass);
    if (!text.empty() && text != said) fmt::print("{}{}\n", terminal ? "\r\033[K" : "", said = text);
    if (device.status() != status)
      fmt::print("{}  {}\n", terminal ? "\r\033[K" : "", status = device.status());
    if (terminal)
      fmt::print("\r    {:4.2f} N asked for, {:3.0f} s left \033[K", progress.newton, progress.seconds);
    std::fflush(stdout);
  }
  if (terminal) fmt::print("\r\033[K");
  return false;
}

/// Throws the `Error` for what went wrong.
[[noreturn]] void explain(const Calibration& calibration, const ClientConfig& config, double mass,
                          const char* status) {
  const double most = config.device_limits().max_force,
               largest = std::floor(calibration.largest_mass() * 100) / 100;
  switch (calibration.trouble()) {
    case Trouble::kNotHomed:
      fail_at_run_time("the Falcon was not homed within two minutes ({}); begin again", status);
    case Trouble::kNotMoved:
      fail_at_run_time(
          "the grip did not come to rest in the middle with up to {:g} N; let go of it, take off what hangs "
          "on it, "
          "and see that the mains adaptor is plugged in",
          most);
    case Trouble::kHeld:
      fail_at_run_time(
          "the grip did not move freely: a hand held it, or its joints are stiff; let go of it, and begin "
          "again");
    case Trouble::kUnsteady:
      fail_at_run_time("the readings did not agree within a minute; nothing may touch or shake the device");
    case Trouble::kNoWeight:
      fail_at_run_time(
          "no weight of {:g} kg came to rest on the grip within a minute: the force changed by {:.2f} N, and "
          "must "
          "by more than {:.2f} N; hang it on and let go, or give the right --mass",
          mass, calibration.difference().norm(), mass * Calibration::kGravity / 2);
    case Trouble::kImplausible:
      fail_at_run_time(
          "a weight of {:g} kg would mean a torque constant of {:.0f}, and Falcons have some {:g} to {:g}; "
          "weigh what hangs on the grip, and give it as --mass",
          mass, calibration.torque_constant(), Calibration::kLowestTorqueConstant,
          Calibration::kHighestTorqueConstant);
    case Trouble::kTooHeavy:
      if (largest < kLeastMass || largest >= mass)
        fail_at_run_time("all of the {:g} N did not lift the weight; nothing may hold it or hang beside it",
                         most);
      fail_at_run_time("the weight is too heavy for the {:g} N at hand; one of {:g} kg or less does for sure",
                       most, largest);
    case Trouble::kOscillates:
      fail_at_run_time("the grip oscillated, and the limiter switched the force off; nothing may touch it");
    default:
      fail_at_run_time("the Falcon gave no position any more ({}); begin again", status);
  }
}

void print_result(const Calibration& calibration) {
  const double tilt = calibration.tilt() / kDegree;
  fmt::print(
      "torque constant {:.0f} DAC units per N m, +-{:.1f} % by the spread of the readings; the weight pulled "
      "{:.0f} "
      "degrees off the vertical\n",
      calibration.torque_constant(), 100 * calibration.uncertainty(), tilt);
  if (tilt > kMostTilt) {
    log::warning(
        "the weight did not pull straight down (-y): the device does not stand upright, something touched "
        "it, or "
        "its geometry is not that of a Falcon");
  }
  fmt::print("put this into the client file:\n\n[falcon]\ntorque_constant = {:.0f}\n",
             calibration.torque_constant());
}

}  // namespace

int calibrate(ClientConfig config, double mass) {
  if (config.device.name != "falcon")
    fail("calibrate: device \"{}\" has no torque constant; only falcon or falcon:PORT has",
         config.device.name);
  require_within(mass, kLeastMass, kMostMass, "--mass", "kg");
  FalconSettings& falcon = config.device.falcon;
  falcon.torque_constant = std::min(falcon.torque_constant, Calibration::kLowestTorqueConstant);
  Guardian guardian({&config, 1});  // before any thread; goes after the device
  const DeviceRow& row = find_row(devices(), config.device.name, "device", config.device.where);
  const std::unique_ptr<Device> device = row.make(config.device);
  Calibration calibration(
      {.mass = mass, .assumed = falcon.torque_constant, .limits = config.device_limits()});
  LatestValue<CalibrationProgress> progress;
  bool interrupted = false;
  {
    std::jthread loop([&](const std::stop_token& stop) {
      run_loop(stop, *device, calibration, row.limits(config.device).min_period, progress,
               guardian.heartbeat(0));
    });
    if (const auto refused = give_role(loop.native_handle(), ThreadRole::kHaptic); !refused.empty())
      log::warning("{}", refused);
    if (const auto refused = lock_memory(); !refused.empty()) log::warning("{}", refused);
    interrupted = guide(progress, *device, config.device, mass);
  }
  if (interrupted) fail_at_run_time("interrupted; nothing was measured");
  if (calibration.trouble() != Trouble::kNone) explain(calibration, config, mass, device->status());
  print_result(calibration);
  return 0;
}

Command calibrate_command() {
  struct Requested {
    std::string device;
    Overrides overrides;
    double mass = 0;
  };
  const auto requested = std::make_shared<Requested>();
  return {.name = "calibrate",
          .summary = "Find the torque constant of a Falcon with a known weight hung on its grip; no server",
          .footer =
              "It says what to do: home the device, let go of the grip, hang the weight on it, wait. It "
              "takes a minute\n"
              "and ends with the line for [falcon] of the client file, which it does not change.\n"
              "Example: haptic_client calibrate falcon --mass 0.1 --falcon-firmware PATH",
          .options = {{"DEVICE",
                       "falcon, or falcon:PORT; stands upright on a table",
                       &requested->device,
                       {.required = true}},
                      {"--mass",
                       "Of the weight, kg, 0.05 to 0.5; 0.1 does for most",
                       &requested->mass,
                       {.required = true}},
                      {"--client", "Client file: firmware and limits (default: all defaults)",
                       &requested->overrides.file},
                      firmware_option(requested->overrides)},
          .run = [requested] {
            ClientConfig config = read_config(requested->overrides);
            choose_device(config.device, requested->device, "DEVICE");
            return calibrate(config, requested->mass);
          }};
}

}  // namespace palpate::client
