#include <memory>

#include "sim_server/commands/condense.h"
#include "sim_server/models/deformation_models.h"

namespace palpate::sim {

Command condense_command() {
  const auto options = std::make_shared<CondenseOptions>();
  const std::string models = models_that([](const DeformationModelRow& row) { return row.condenses; });
  return {.name = "condense",
          .summary = "Set up a body too large for this machine, on many processes, for `run --condensed`",
          .footer =
              "Examples:\n"
              "  mpirun -n 4 sim_server condense configs/scenes/liver.toml --out out/liver\n"
              "  sim_server run configs/scenes/liver.toml --condensed out/liver",
          .options = {{"SCENE",
                       "Scene file (TOML) of one of the models " + models,
                       &options->scene,
                       {.required = true}},
                      {"--out",
                       "Folder for the result; parts that it already holds are not computed again",
                       &options->out,
                       {.required = true}},
                      {"--report", "Write times and memory to this JSON file", &options->report}},
          .run = [options] { return condense(*options); }};
}

}  // namespace palpate::sim
