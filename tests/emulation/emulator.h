#pragma once
/// For tests: emulated USB devices in a process of their own, and programs that see them through the real
/// libusb.
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/process.h"

namespace palpate::test {

/// A running `falcon_emulator` with its sockets in a short folder of its own; all of it goes with this
/// object. Errors are `std::runtime_error`.
class Emulator {
 public:
  /// `devices` as for --device ("falcon:2-1"); `more`: further options. Returns when it serves.
  explicit Emulator(const std::vector<std::string>& devices, const std::vector<std::string>& more = {});
  ~Emulator();
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  /// Sends a line of the control protocol (tests/emulation/README.md), returns what follows `ok`. Throws if
  /// the answer is an error.
  std::string command(const std::string& line) const;
  /// What `state DEVICE` says.
  nlohmann::json state(const std::string& device) const;
  /// Waits until `state DEVICE` satisfies `condition`; false after `seconds` of the wall clock.
  template <class Condition>
  bool wait_for(const std::string& device, Condition condition, double seconds = 10) const {
    for (int remaining = static_cast<int>(seconds * 200); remaining > 0; --remaining, nap()) {
      if (condition(state(device))) return true;
    }
    return false;
  }

  /// What a program needs in its environment to see the devices. Not for the test runner itself.
  std::vector<std::pair<std::string, std::string>> environment() const;
  /// Starts a program of build/.../bin in that environment.
  std::unique_ptr<Process> start(const std::string& program, const std::vector<std::string>& arguments) const;

  const std::string& socket() const { return socket_; }
  Process& process() { return *process_; }

 private:
  static void nap();
  int connect_to_control() const;

  std::string folder_, socket_;
  std::unique_ptr<Process> process_;
};

/// Sets variables of the environment as long as it lives; what programs started meanwhile inherit.
class Environment {
 public:
  explicit Environment(const std::vector<std::pair<std::string, std::string>>& variables);
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  struct Old {
    std::string name, value;
    bool was_set;
  };
  std::vector<Old> old_;
};

}  // namespace palpate::test
