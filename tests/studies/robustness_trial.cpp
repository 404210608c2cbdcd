// A tool on a body of some model, watched step by step.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "sim_server/mesh/mesh_faults.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/scene_file/read_parts.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/studies/robustness.h"
#include "tests/support/solids.h"
#include "tests/support/temporary_folder.h"

namespace palpate::studies {
namespace {

using namespace palpate::sim;

constexpr const char* kMesh = "body.msh";

Vec3 place_at(const Path& path, double t) {
  const auto next = std::ranges::find_if(path, [t](const Waypoint& w) { return w.t > t; });
  if (next == path.end()) return path.back().place;
  if (next == path.begin()) return path.front().place;
  const Waypoint& from = *std::prev(next);
  if (t == from.t) return from.place;
  return from.place + (t - from.t) / (next->t - from.t) * (next->place - from.place);
}

}  // namespace

const std::vector<Column>& columns() {
  static const std::vector<Column> all = [] {
    std::vector<Column> found;
    for (const DeformationModelRow& row : models_without_cutting()) {
      if (row.materials != Materials::kAny) {
        found.push_back({std::string(row.name), &row, ElasticLaw::kLinear});
        continue;
      }
      for (const ElasticLaw law : elastic_laws())
        found.push_back({fmt::format("{} {}", row.name, name_of(law)), &row, law});
    }
    return found;
  }();
  return all;
}

TetMesh usual_block() {
  return grid_block(test::lines(-0.015, 0.015, 6), test::lines(-0.015, 0, 3), test::lines(-0.015, 0.015, 6));
}

std::string SceneFile::text(const Column& column, const std::string& mesh) const {
  std::string text = fmt::format("rate_hz = {}\n[mesh]\nfile = \"{}\"\n{}{}", rate_hz, mesh, fixed, loads);
  text +=
      fmt::format("[material]\nlaw = \"{}\"\nelement = \"{}\"\nyoung_modulus = {}\npoisson_ratio = {}\n{}",
                  name_of(column.elastic), element, young_modulus, poisson_ratio, material);
  text += fmt::format("[deformation]\nmodel = \"{}\"\n", column.row->name);
  const std::vector<std::pair<std::string_view, std::string>> said{
      {"stiffness", "800"},
      {"spring_stiffness", "[800, 800, 800]"},
      {"rayleigh_mass", fmt::format("{}", rayleigh_mass)},
      {"rayleigh_stiffness", fmt::format("{}", rayleigh_stiffness)},
      {"max_newton", fmt::format("{}", max_newton)},
      {"tolerance", fmt::format("{}", tolerance)}};
  const std::vector<std::string_view> keys = column.row->keys();
  for (const auto& [key, value] : said) {
    if (std::ranges::count(keys, key) > 0) text += fmt::format("{} = {}\n", key, value);
  }
  for (const std::string& tool : tools) text += fmt::format("[[tool]]\n{}\n", tool);
  return text;
}

Path press(double radius, double depth, double t) {
  return {{0, Vec3(0.001, radius + 0.002, 0.002)}, {t, Vec3(0.001, radius - depth, 0.002)}};
}

Path stroke(const Vec3& from, const Vec3& to, double speed) {
  return {{0, from}, {0.1, from}, {0.1 + (to - from).norm() / speed, to}};
}

std::string tool(double radius, const std::string& more) {
  return fmt::format("radius = {}\n{}", radius, more);
}

std::vector<Path> later(std::vector<Path> paths, double fraction, double rate_hz) {
  for (Path& path : paths) {
    for (Waypoint& waypoint : path) waypoint.t += fraction / rate_hz;
  }
  return paths;
}

void with_simulation(const SceneFile& file, const TetMesh& body, const Column& column,
                     const std::function<void(const Scene&, Simulation&)>& use) {
  const test::TemporaryFolder folder;
  folder.write(kMesh, "");  // that it is there: the mesh is made here
  try {
    const Scene scene = read_scene(folder.write("scene.toml", file.text(column, kMesh)));
    TetMesh mesh = body;
    require_usable(mend(mesh), kMesh);
    Simulation simulation(scene, std::move(mesh));
    use(scene, simulation);
  } catch (const Error& e) {
    std::string said = e.what();  // without the name of the folder, which is another every time
    const std::string path = folder.path().string() + "/";
    for (std::size_t at; (at = said.find(path)) != std::string::npos;) said.erase(at, path.size());
    throw Error(said, static_cast<Error::Kind>(e.exit_code()));
  }
}

Run follow(const Trial& trial, const Column& column, const std::vector<Path>& paths, bool separate) {
  const double steps = std::round(trial.seconds * trial.file.rate_hz);
  World world{trial.file, trial.mesh, {}, (separate ? 2 : 1) * steps / trial.file.rate_hz, false};
  world.hands = [&](double t) {
    std::vector<ToolInput> inputs(paths.size());
    const bool are_there = t * trial.file.rate_hz < steps + 0.5;
    for (std::size_t k = 0; k < paths.size() && are_there; ++k) inputs[k].pose = place_at(paths[k], t);
    return inputs;
  };
  Run run;
  static_cast<Watched&>(run) = watch(world, column);
  for (const Path& path : paths) run.arrived = std::max(run.arrived, path.back().t);
  if (!separate) run.off = 0;
  return run;
}

Verdict run_trial(const Case& row, const Column& column, bool quick) {
  Trial trial;
  trial.mesh = usual_block();
  trial.paths = {{{0, Vec3(0.001, 0.006, 0.002)}, {1, Vec3(0.001, 0.001, 0.002)}}};
  row.change(trial);
  if (quick) {
    trial.seconds = std::min(trial.seconds, 2.0);
    trial.phases = std::min(trial.phases, 2);
  }
  try {
    std::vector<Run> runs;
    for (int phase = 0; phase < trial.phases; ++phase) {
      const double fraction = static_cast<double>(phase) / trial.phases;
      runs.push_back(follow(trial, column, later(trial.paths, fraction, trial.file.rate_hz), phase == 0));
      runs.back().phase = phase;
    }
    return judge(runs, trial, column);
  } catch (const Error& e) {
    return {"refused", e.what(), {}, {}, ""};
  }
}

}  // namespace palpate::studies
