#include "common/program.h"
#include "haptic_client/commands/calibrate.h"
#include "haptic_client/commands/commtest.h"
#include "haptic_client/commands/devices.h"
#include "haptic_client/commands/evaluate.h"
#include "haptic_client/commands/replay.h"
#include "haptic_client/commands/run.h"

namespace {

palpate::Command haptic_client() {
  using namespace palpate::client;
  return {.name = "haptic_client",
          .summary = "Drives a force-feedback device at haptic rate from forces computed by sim_server.",
          .footer = "Example: haptic_client run configs/clients/liver.toml --seconds 20",
          .commands = {run_command(), replay_command(), calibrate_command(), commtest_command(),
                       devices_command(), evaluate_command()}};
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::run_program("haptic_client", argc, argv, &haptic_client);
}
