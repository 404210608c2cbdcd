#include "sim_server/commands/condense.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/clock.h"
#include "common/error.h"
#include "common/log.h"
#include "common/memory_budget.h"
#include "common/progress.h"
#include "common/report.h"
#include "sim_server/distributed/mumps_factor.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/held_motion.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/setup_times.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {
namespace {

void require_condensable(const Scene& scene) {
  const DeformationModelRow& row = model_of(scene.deformation);
  if (!row.condenses)
    fail("{}: tissue of model \"{}\" is not condensed; {} are", scene.deformation.where, row.name,
         models_that([](const DeformationModelRow& m) { return m.condenses; }));
  if (supports_move(scene))
    fail("{}: supports that move are not condensed; remove their [[fixed.motion]]", scene.source);
}

double sum_of(const std::vector<RankMemory>& ranks) {
  double bytes = 0;
  for (const RankMemory& rank : ranks) bytes += rank.bytes;
  return bytes;
}

/// Makes factors by MUMPS, and writes down in `costs` what the last one took.
MakeFactor mumps_maker(std::optional<MumpsCosts>& costs) {
  return [&costs](const SparseMatrix& lower, std::span<const int> stored, FactorUse use,
                  const std::string& where) {
    const auto report = [](const std::string& line) { log::info("{}", line); };
    auto factor = std::make_unique<MumpsFactor>(lower, stored, use, where, report);
    costs = factor->costs();
    return factor;
  };
}

Json to_json(const std::vector<RankMemory>& ranks) {
  Json mb = Json::array();
  for (const RankMemory& rank : ranks) mb.push_back(1e-6 * rank.bytes);
  return mb;
}

Json report_of(const CondenseOptions& options, const Simulation& simulation, const SetupTimes& times,
               const std::optional<MumpsCosts>& made, int ranks) {
  Json report{{"scene", options.scene.string()},
              {"folder", options.out.string()},
              {"ranks", ranks},
              {"tetrahedra", simulation.mesh().tetrahedra.size()},
              {"stages_ms", times.to_json()}};
  if (made) {
    const MumpsCosts& costs = *made;
    report["factor"] = {{"unknowns", costs.unknowns},      {"stored", costs.stored},
                        {"gflop", 1e-9 * costs.flops},     {"analysis_s", costs.analysis_s},
                        {"factor_s", costs.factor_s},      {"schur_s", costs.schur_s},
                        {"rank_mb", to_json(costs.memory)}};
  }
  return report;
}

void print_costs(const MumpsCosts& costs) {
  fmt::print(
      "  factor: analysis {:.2f} s, numbers {:.2f} s ({:.3g} Gflop/s), Cholesky factor of what is kept "
      "{:.2f} s\n",
      costs.analysis_s, costs.factor_s, costs.flops > 0 ? 1e-9 * costs.flops / costs.factor_s : 0.0,
      costs.schur_s);
  std::string each;
  for (const RankMemory& rank : costs.memory) each += (each.empty() ? "" : ", ") + bytes_text(rank.bytes);
  fmt::print("  its memory, by rank: {}; {} in all\n", each, bytes_text(sum_of(costs.memory)));
}

void condense_on_rank_0(const CondenseOptions& options, int ranks) {
  const Scene scene = read_scene(options.scene);
  require_condensable(scene);
  if (options.report) check_writable(*options.report, Contents::kReport);
  std::optional<MumpsCosts> made;  // nothing where all was kept already
  const Condensed condensed(options.out, mumps_maker(made));
  SetupTimes times{ProgressLine("what was complete is kept, and the next start goes on from there")};
  const Time begin = now();
  const Simulation simulation(scene, std::ref(times), nullptr, &condensed);
  fmt::print("{}: {} tetrahedra condensed into {} on {} {} in {:.1f} s\n", scene.source,
             simulation.mesh().tetrahedra.size(), options.out.string(), ranks, ranks == 1 ? "rank" : "ranks",
             to_seconds(now() - begin));
  for (const SetupTimes::Stage& stage : times.stages())
    fmt::print("  {:<40}{:>9.2f} s\n", stage.name, to_seconds(stage.took));
  for (const MemoryPart& part : simulation.memory()) {
    if (!part.detail.empty())
      fmt::print("  {}: {}, {}\n", part.name, bytes_text(static_cast<double>(part.bytes)), part.detail);
  }
  if (made) print_costs(*made);
  fmt::print("  to feel it: sim_server run {} --condensed {}\n", options.scene.string(),
             options.out.string());
  if (options.report) write_json(*options.report, report_of(options, simulation, times, made, ranks));
}

/// Lets the other ranks go, whatever happens on this one.
struct OtherRanks {
  OtherRanks() = default;
  ~OtherRanks() { end_mumps(); }
  OtherRanks(const OtherRanks&) = delete;
  OtherRanks& operator=(const OtherRanks&) = delete;
};

/// All that a rank but 0 does. The others would wait for one that failed: it ends them, too.
void serve_rank_0(const MpiRanks& ranks) {
  try {
    serve_mumps();
  } catch (const std::exception& e) {
    log::error("rank {}: {}; all ranks end, and nothing is written", ranks.rank(), e.what());
    ranks.end_all(static_cast<int>(Error::Kind::kRun));
  }
}

}  // namespace

int condense(const CondenseOptions& options) {
  const MpiRanks ranks;
  if (ranks.rank() == 0) {
    const OtherRanks released_at_the_end;
    condense_on_rank_0(options, ranks.count());
  } else {
    serve_rank_0(ranks);
  }
  return 0;
}

}  // namespace palpate::sim
