// falcon_emulator: emulated USB devices for programs that use libusb. See README.md beside this file.
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "tests/emulation/falcon.h"
#include "tests/emulation/spacemouse.h"
#include "tests/emulation/usb_server.h"

namespace palpate::emulation {
namespace {

constexpr const char* kHelp =
    R"(usage: falcon_emulator --socket PATH --device MODEL:PORT... [options]
Emulates USB devices for programs that run with LD_PRELOAD=libusb_vhci_shim.so USBSHIM=PATH.
Commands are read from PATH.ctl; tests/emulation/README.md lists them. Ends on SIGTERM or SIGINT.

  --socket PATH           unix socket, at most 103 characters
  --device MODEL:PORT     falcon, spacemouse (7-byte reports), spacemouse13 (13-byte) or
                          spacemouse_receiver (13-byte, second interface); PORT as 2-1 or 2-1.4
  --clock virtual|wall    virtual (default): the mechanism moves on by --packet-time with every I/O packet
  --packet-time S         seconds, 0.0001 to 0.1; default 0.001
  --torque-constant K     motor command per torque, DAC units per N m; default 10000
  --seed N                of the encoders' zeros before homing; default 1
  --loaded                Falcons have their firmware at the start
  --homed                 Falcons have found their references at the start
  --die-with-parent       end when the process that started this ends
Faults (command: fault PORT NAME [VALUE], 0 ends it):
  permission              1: opening is denied (EACCES)
  busy                    1: claiming the interface fails (EBUSY)
)";

struct Options {
  std::string socket;
  std::vector<std::string> devices;
  Falcon::Settings falcon;
};

void help() {
  std::fputs(kHelp, stdout);
  for (const FalconFault& fault : kFalconFaults) std::printf("  %-23s %s\n", fault.name, fault.meaning);
}

/// Throws `CommandError` for anything wrong. False: nothing else is to be done.
bool parse(int count, char** words, Options& options) {
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= count) throw CommandError(word + " needs a value");
      return words[++i];
    };
    if (word == "--help" || word == "-h") {
      help();
      return false;
    } else if (word == "--socket") {
      options.socket = value();
    } else if (word == "--device") {
      options.devices.push_back(value());
    } else if (word == "--clock") {
      const std::string clock = value();
      if (clock != "virtual" && clock != "wall") throw CommandError("--clock is virtual or wall");
      options.falcon.wall = clock == "wall";
    } else if (word == "--packet-time") {
      options.falcon.packet_time = number(value(), 1e-4, 0.1);
    } else if (word == "--torque-constant") {
      options.falcon.mechanics.torque_constant = number(value(), 1, 1e6);
    } else if (word == "--seed") {
      options.falcon.mechanics.seed = static_cast<std::uint64_t>(number(value(), 0, 9e15));
    } else if (word == "--loaded") {
      options.falcon.loaded = true;
    } else if (word == "--homed") {
      options.falcon.homed = true;
    } else if (word == "--die-with-parent") {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
    } else {
      throw CommandError("unknown option " + word + "; try --help");
    }
  }
  if (options.socket.empty() || options.devices.empty())
    throw CommandError("--socket and at least one --device are needed; try --help");
  return true;
}

void add_device(UsbBus& bus, const std::string& what, const Falcon::Settings& falcon) {
  const std::size_t colon = what.find(':');
  if (colon == std::string::npos) throw CommandError("--device is MODEL:PORT, not " + what);
  const std::string model = what.substr(0, colon), port = what.substr(colon + 1);
  if (model == "falcon") {
    bus.add(port, std::make_unique<Falcon>(falcon));
  } else if (model == "spacemouse") {
    bus.add(port, std::make_unique<SpaceMouse>(SpaceMouse::Layout::kTwoReports));
  } else if (model == "spacemouse13") {
    bus.add(port, std::make_unique<SpaceMouse>(SpaceMouse::Layout::kOneReport));
  } else if (model == "spacemouse_receiver") {
    bus.add(port, std::make_unique<SpaceMouse>(SpaceMouse::Layout::kReceiver));
  } else {
    throw CommandError("unknown model " + model +
                       "; known are falcon, spacemouse, spacemouse13, spacemouse_receiver");
  }
}

int signals_to_end_on() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  return signalfd(-1, &set, SFD_CLOEXEC);
}

int run(int count, char** words) {
  Options options;
  try {
    if (!parse(count, words, options)) return 0;
    UsbBus bus;
    Falcon::Settings settings = options.falcon;
    for (const std::string& device : options.devices) {
      add_device(bus, device, settings);
      ++settings.mechanics.seed;
    }
    const int signals = signals_to_end_on();
    UsbServer server(options.socket, bus);
    std::printf("falcon_emulator: serving %zu devices at %s\n", options.devices.size(),
                options.socket.c_str());
    std::fflush(stdout);
    server.run(signals);
    close(signals);
    return 0;
  } catch (const CommandError& error) {
    std::fprintf(stderr, "falcon_emulator: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "falcon_emulator: %s\n", error.what());
    return 1;
  }
}

}  // namespace
}  // namespace palpate::emulation

int main(int count, char** words) {
  return palpate::emulation::run(count, words);
}
