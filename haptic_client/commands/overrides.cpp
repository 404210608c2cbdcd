#include "haptic_client/commands/overrides.h"

#include <algorithm>

#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {

ClientConfig read_config(const Overrides& overrides) {
  ClientConfig config = overrides.file.empty() ? ClientConfig{} : read_client_config(overrides.file);
  if (!overrides.server.empty()) {
    config.server = overrides.server;
    config.server_where = "--server";
  }
  if (!overrides.key.empty()) config.key = overrides.key;
  config.insecure = overrides.insecure;
  if (!overrides.firmware.empty()) config.device.falcon.firmware = overrides.firmware;
  if (!overrides.method.empty()) {
    find_row(extrapolators(), overrides.method, "method", "--method");
    config.method = overrides.method;
  }
  if (overrides.rate_hz) {
    require_at_least(*overrides.rate_hz, kMinRate, "--rate", "Hz");
    config.rate_hz = std::min(*overrides.rate_hz, kMaxRate);
  }
  return config;
}

Option firmware_option(Overrides& overrides) {
  return {"--falcon-firmware", "Image for a Falcon that has none since power-up", &overrides.firmware};
}

Option insecure_option(Overrides& overrides, const std::string& needs) {
  return {"--insecure", "Leave this machine without a key", &overrides.insecure, {.needs = needs}};
}

std::string list_of_laws() {
  return "Methods:\n" + help_rows(extrapolators());
}

}  // namespace palpate::client
