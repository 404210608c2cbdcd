#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/program.h"
#include "haptic_client/session/client_config.h"

namespace palpate::client {

/// Settings of the command line, which replace those of the client file.
struct Overrides {
  std::string file;  ///< of the client; empty: all defaults
  std::string server, method, firmware, key;
  bool insecure = false;
  std::optional<double> rate_hz;
};

/// The client file with what goes over it. Throws `Error`.
ClientConfig read_config(const Overrides& overrides);

/// `--falcon-firmware`.
Option firmware_option(Overrides& overrides);
/// `--insecure`, which is no use without the option `needs`, if one is named.
Option insecure_option(Overrides& overrides, const std::string& needs = {});
/// Every law and what it does, for the help of commands that take one.
std::string list_of_laws();

}  // namespace palpate::client
