#include "sim_server/study/study_table.h"

#include <algorithm>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/report.h"
#include "common/text.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/implicit.h"
#include "sim_server/scene_file/read_parts.h"

namespace palpate::sim {
namespace {

double dt_ms(const StudyRow& row) {
  return 1e3 / row.one.scene.rate_hz;
}

bool by_iterations(const StudyRow& row) {
  return model_of(row.one.scene.deformation).takes<ImplicitSettings>();
}

/// Returns what is the same on every run.
Json facts_of(const StudyRow& row) {
  const Scene& scene = row.one.scene;
  Json facts{{"scene", row.scene},
             {"axis", row.one.axis},
             {"case", row.one.name()},
             {"model", scene.deformation.model},
             {"law", std::string(name_of(scene.material->law))},
             {"element", std::string(name_of(scene.material->element))},
             {"mesh", scene.mesh_file.filename().string()},
             {"refinements", row.one.refinements},
             {"tetrahedra", row.tetrahedra},
             {"nodes", row.nodes},
             {"dt_ms", dt_ms(row)}};
  facts["tolerance"] =
      by_iterations(row) ? Json(scene.deformation.of<ImplicitSettings>().tolerance) : Json(nullptr);
  facts["force_error_percent"] = row.errors.force;
  facts["worst_force_error_percent"] = row.errors.worst_force;
  facts["surface_error_percent"] = row.errors.surface;
  facts["rendered_error_percent"] = row.errors.rendered.mean_percent;
  Json sizes = to_json(static_cast<const ErrorSizes&>(row.errors.rendered));
  sizes.erase("mean_percent");
  sizes.update(to_json(row.errors.rendered.mean_10ms, "_10ms"));
  for (const auto& [key, value] : sizes.items()) facts["rendered_" + key] = value;
  facts["flagged_steps"] = row.flagged;
  facts["state_hash"] = fmt::format("{:016x}", row.state_hash);
  return facts;
}

/// Returns what depends on the machine.
Json times_of(const StudyRow& row) {
  return {{"step_ms_p50", row.touched ? Json(row.step_ms_p50) : Json()},
          {"step_ms_p99", row.touched ? Json(row.step_ms_p99) : Json()},
          {"setup_ms", row.setup_ms},
          {"peak_bytes", row.peak_bytes},
          {"on_front", row.on_front}};
}

Json along_of(const StudyRow& row) {
  Json lines = Json::array();
  for (std::size_t k = 0; k < row.errors.along.size(); ++k)
    lines.push_back({{"case", row.one.name()},
                     {"t_s", 1e-3 * dt_ms(row) * static_cast<double>(k + 1)},
                     {"force_error_percent", row.errors.along[k]}});
  return lines;
}

Json steps_of(const Trace& truth) {
  Json lines = Json::array();
  for (std::size_t k = 0; k < truth.forces.size(); ++k) {
    const Vec3 &p = truth.places[k], &f = truth.forces[k];
    lines.push_back({{"t_s", truth.dt * static_cast<double>(k + 1)},
                     {"x_m", p.x()},
                     {"y_m", p.y()},
                     {"z_m", p.z()},
                     {"fx_n", f.x()},
                     {"fy_n", f.y()},
                     {"fz_n", f.z()}});
  }
  return lines;
}

/// Returns what the case leaves out of the scene, as its model cannot.
std::string without(const Scene& scene, const Scene& requested) {
  std::string text;
  if (scene.loads.empty() && !requested.loads.empty()) text += "# and without: [[load]]\n";
  if (scene.material->relaxations.empty() && !requested.material->relaxations.empty())
    text += "# and without: [[material.relaxation]]\n";
  if (!scene.material->fibres && requested.material->fibres) text += "# and without: [material.fibres]\n";
  return text;
}

/// Returns settings to be pasted into the scene that was `requested` about.
std::string settings_of(const StudyRow& row, const Scene& requested) {
  const Scene& scene = row.one.scene;
  std::string text = fmt::format(
      "# {}: in the place of the same keys, [deformation] of all that stands there; the rest stays\n{}",
      requested.source, without(scene, requested));
  const std::filesystem::path folder = std::filesystem::path(requested.source).parent_path();
  text += fmt::format("rate_hz = {:g}\n[mesh]\nfile = \"{}\"", scene.rate_hz,
                      std::filesystem::proximate(scene.mesh_file, folder).generic_string());
  text += fmt::format("\n[material]\nlaw = \"{}\"\nelement = \"{}\"\n", name_of(scene.material->law),
                      name_of(scene.material->element));
  return text + to_text(scene.deformation);
}

}  // namespace

void mark_front(std::vector<StudyRow>& rows) {
  for (StudyRow& row : rows) {
    row.on_front = row.flagged == 0 && row.touched && std::ranges::none_of(rows, [&](const StudyRow& other) {
                     const auto [error, time] = std::pair(other.errors.force, other.step_ms_p50);
                     const bool better = error < row.errors.force || time < row.step_ms_p50;
                     return other.flagged == 0 && other.touched && error <= row.errors.force &&
                            time <= row.step_ms_p50 && better;
                   });
  }
}

std::string to_text(const StudyResult& result) {
  std::string text = fmt::format(
      "reference {}; {} differs from it by {:.2g} % in force, {:.2g} % in shape\n\n"
      "  {:<9} {:<58} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}\n",
      result.reference, result.check, result.own.force, result.own.surface, "axis", "case", "tetrahedra",
      "force %", "worst %", "surface %", "rendered %", "step ms", "set-up s", "peak MB");
  if (result.jumps) text.insert(text.find('\n') + 1, unexplained_text(*result.jumps) + "\n");
  for (const StudyRow& row : result.rows) {
    text += fmt::format(
        "{} {:<9} {:<58} {:>10} {:>9.3g} {:>9.3g} {:>9.3g} {:>9.3g} {:>9.3g} {:>9.3g} {:>8.0f}{}\n",
        row.on_front ? '*' : ' ', row.one.axis, row.one.name(), row.tetrahedra, row.errors.force,
        row.errors.worst_force, row.errors.surface, row.errors.rendered.mean_percent, row.step_ms_p50,
        row.setup_ms / 1e3, row.peak_bytes / 1e6,
        row.flagged > 0 ? fmt::format("  {} steps flagged", row.flagged)
        : !row.touched  ? "  never touched"
                        : "");
  }
  for (const auto& [name, why] : result.refused) text += fmt::format("  refused   {}: {}\n", name, why);
  return text + "* on the front: nothing settled has as small an error of the force in less time\n";
}

std::string advice(const StudyResult& result, double budget_ms, const Scene& requested) {
  const StudyRow* best = nullptr;
  for (const StudyRow& row : result.rows) {
    if (row.one.refinements > 0 || row.flagged > 0 || !row.touched) continue;
    if (row.step_ms_p50 > std::min(budget_ms, dt_ms(row))) continue;
    if (best == nullptr || row.errors.rendered.mean_percent < best->errors.rendered.mean_percent) best = &row;
  }
  if (best == nullptr)
    return fmt::format("\nNo case takes {:g} ms a step or less; a coarser mesh (--mesh FILE) would.\n",
                       budget_ms);
  return fmt::format(
      "\nWithin {:g} ms a step, {} is rendered with the smallest error: {:.2g} %, at {:.2g} ms a step (99 "
      "of 100 within {:.2g}).\n\n{}",
      budget_ms, best->one.name(), best->errors.rendered.mean_percent, best->step_ms_p50, best->step_ms_p99,
      settings_of(*best, requested));
}

void write_study(const StudyOptions& options, const StudyResult& result) {
  Json facts = Json::array(), times = Json::array(), along = Json::array(), all = Json::array();
  for (const StudyRow& row : result.rows) {
    facts.push_back(facts_of(row));
    Json timed{{"case", row.one.name()}};
    timed.update(times_of(row));
    times.push_back(timed);
    for (const Json& line : along_of(row)) along.push_back(line);
    Json entire = facts_of(row);
    entire.update(times_of(row));
    all.push_back(entire);
  }
  Json refused = Json::array();
  for (const auto& [name, why] : result.refused) refused.push_back({{"case", name}, {"reason", why}});
  write_csv(options.out / "rows.csv", csv_of(facts));
  write_csv(options.out / "timing.csv", csv_of(times));
  write_csv(options.out / "along.csv", csv_of(along));
  write_csv(options.out / "reference.csv", csv_of(steps_of(result.truth)));
  Json reference = {{"case", result.reference},
                    {"check", result.check},
                    {"force_error_percent", result.own.force},
                    {"surface_error_percent", result.own.surface}};
  add_to(reference, "unexplained_jump", result.jumps);
  write_json(
      options.out / "summary.json",
      {{"reference", reference}, {"latency_ms", options.latency_ms}, {"rows", all}, {"refused", refused}});
}

}  // namespace palpate::sim
