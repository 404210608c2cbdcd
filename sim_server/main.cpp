#include "common/fast_blas.h"
#include "common/program.h"
#include "sim_server/commands/condense.h"
#include "sim_server/commands/explain.h"
#include "sim_server/commands/gallery.h"
#include "sim_server/commands/keygen.h"
#include "sim_server/commands/mesh_info.h"
#include "sim_server/commands/record.h"
#include "sim_server/commands/replay.h"
#include "sim_server/commands/run.h"
#include "sim_server/commands/solve.h"
#include "sim_server/commands/study.h"
#include "sim_server/commands/view.h"

namespace {

palpate::Command sim_server() {
  using namespace palpate::sim;
  return {.name = "sim_server",
          .summary = "Deforms an organ and answers a haptic client with forces, over UDP.",
          .footer = "Example: sim_server run configs/scenes/liver.toml",
          .commands = {run_command(), record_command(), explain_command(), solve_command(), study_command(),
                       condense_command(), scenes_command(), mesh_command(), replay_command(), view_command(),
                       keygen_command()}};
}

}  // namespace

int main(int argc, char** argv) {
  palpate::start_with_fast_blas(argv);
  return palpate::run_program("sim_server", argc, argv, &sim_server);
}
