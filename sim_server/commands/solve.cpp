#include "sim_server/commands/solve.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <memory>

#include "common/clock.h"
#include "common/error.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/report.h"
#include "common/text.h"
#include "sim_server/commands/solve_results.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/vtu_output.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/implicit.h"
#include "sim_server/scene/inclusions.h"
#include "sim_server/scene/loads.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/set_up_memory.h"
#include "sim_server/solvers/dynamics.h"
#include "sim_server/solvers/equilibrium.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {
namespace {

/// Finds the equilibrium under all loads.
Outcome find_rest(const Scene& scene, const Solid& solid, const Loads& loads, ProgressLine& progress) {
  const StaticLoad load{[&](std::span<const Vec3> x, std::span<Vec3> f) { loads.add_forces(x, f); },
                        loads.held(), loads.moved()};
  const Time begin = now();
  Equilibrium found =
      find_equilibrium(solid, load, scene.source, [&](double fraction) { progress("loading", fraction); });
  progress("loading", 1);
  fmt::print(
      "  static equilibrium     {} Newton steps in {} increments, residual {:.1e} of the forces at work, "
      "{:.3g} "
      "ms\n",
      found.iterations, found.increments, found.residual, 1e3 * to_seconds(now() - begin));
  Outcome outcome{.x = std::move(found.x), .resistance = {}};
  outcome.resistance.resize(outcome.x.size());
  solid.forces(outcome.x, outcome.resistance);
  return outcome;
}

/// Files of a series: beside it, numbered. Without `finish`, as after Ctrl-C, they are removed.
class Series {
 public:
  explicit Series(const SolveOptions& options) : options_(options) {}
  ~Series() {
    if (finished_) return;
    for (const auto& [t, name] : frames_) {
      std::error_code ignored;
      std::filesystem::remove(options_.series->parent_path() / name, ignored);
    }
  }
  Series(const Series&) = delete;
  Series& operator=(const Series&) = delete;

  void add(double t, const Solid& solid, const Outcome& outcome) {
    const std::filesystem::path name =
        fmt::format("{}_{:04}.vtu", options_.series->stem().string(), frames_.size());
    write_outcome(options_.series->parent_path() / name, solid, outcome);
    frames_.emplace_back(t, name);
  }
  void finish() {
    write_pvd(*options_.series, frames_);
    finished_ = true;
  }

 private:
  const SolveOptions& options_;
  std::vector<std::pair<double, std::filesystem::path>> frames_;
  bool finished_ = false;
};

/// The stepping of a motion: as the scene says, where its model is implicit; for models that only serve tools
/// by BDF2, with their damping where they have one.
struct Stepping {
  DynamicsSettings dynamics{.second_order = true};
  double tolerance = 1e-9;
  std::string name = "BDF2";
  explicit Stepping(const DeformationSettings& settings) {
    const DeformationModelRow* row = settings.model.empty() ? nullptr : &model_of(settings);
    if (row != nullptr && row->takes<ImplicitSettings>()) {
      dynamics = dynamics_settings(settings);
      tolerance = settings.of<ImplicitSettings>().tolerance;
      if (!dynamics.second_order) name = "backward Euler";
    } else if (row != nullptr && row->takes<RayleighDamping>()) {
      dynamics.rayleigh_mass = settings.of<RayleighDamping>().mass;
      dynamics.rayleigh_stiffness = settings.of<RayleighDamping>().stiffness;
      name += " with the damping of " + settings.model;
    } else {
      name += ", undamped";
    }
    dynamics.flies = true;
  }
};

Outcome outcome_of(const Dynamics& dynamics) {
  const Viscosity viscosity = dynamics.viscosity();
  Outcome outcome{.x = {dynamics.position().begin(), dynamics.position().end()},
                  .resistance = std::vector<Vec3>(dynamics.position().size()),
                  .stress_scale = viscosity.scale,
                  .memory = {viscosity.memory.begin(), viscosity.memory.end()}};
  dynamics.resistance(outcome.resistance);
  return outcome;
}

/// One step of `h` to balance, at time `t`. Returns the steps of Newton's method that it took; 0: no balance.
int step_to_balance(Dynamics& dynamics, const Loads& loads, double t, double h, double tolerance,
                    std::vector<Vec3>& external) {
  constexpr int kMostNewton = 50;     // steps, until there counts as no balance
  constexpr double kRounding = 1e-6;  // of the forces at work
  dynamics.start_step(h);
  loads.put_held(t, dynamics.mutable_position());
  for (int k = 1; k <= kMostNewton; ++k) {
    std::ranges::fill(external, Vec3::Zero());
    loads.add_forces(dynamics.position(), external);
    if (dynamics.iterate(external, tolerance) > tolerance) continue;
    if (!(dynamics.relative_residual() <= std::max(tolerance, kRounding)))
      return 0;  // flung about beyond all measure
    dynamics.finish_step();
    return k;
  }
  return 0;
}

int steps_of(const SolveOptions& options) {
  return static_cast<int>(std::ceil(*options.seconds / options.step - 1e-9));
}

/// Moves from rest, with all loads there at once, what is displaced moved at once, and what swings on its
/// path.
Outcome move_for(const SolveOptions& options, const Scene& scene, const Solid& solid, const Loads& loads,
                 ProgressLine& progress) {
  const Stepping stepping(scene.deformation);
  Dynamics dynamics(solid, loads.held(), stepping.dynamics, scene.source);
  const int steps = steps_of(options);
  const double h = *options.seconds / steps;
  const int every = std::max(1, steps / options.frames);
  Series series(options);
  std::vector<Vec3> external(static_cast<std::size_t>(solid.nodes()));
  std::vector<Time> times;
  int newton = 0;
  if (options.series) series.add(0, solid, outcome_of(dynamics));
  for (int step = 1; step <= steps; ++step) {
    const Time begin = now();
    const int polls = step_to_balance(dynamics, loads, step * h, h, stepping.tolerance, external);
    if (polls == 0) {
      if (options.series) series.finish();  // what there is can be looked at
      fail_at_run_time("{}: no convergence at {:g} s; a smaller --step than {:g} s would help", scene.source,
                       step * h, h);
    }
    times.push_back(now() - begin);
    newton += polls;
    progress("moving", static_cast<double>(step) / steps);
    if (options.series && (step % every == 0 || step == steps))
      series.add(step * h, solid, outcome_of(dynamics));
  }
  if (options.series) series.finish();
  std::nth_element(times.begin(), times.begin() + steps / 2, times.end());
  fmt::print(
      "  after {:g} s            {} steps of {:g} s ({}, to {:g} of the forces), {} looks, {:.3g} ms a step "
      "(median), kinetic energy {:.9g} J\n",
      *options.seconds, steps, h, stepping.name, stepping.tolerance, newton,
      1e3 * to_seconds(times[static_cast<std::size_t>(steps / 2)]), dynamics.kinetic_energy());
  return outcome_of(dynamics);
}

/// A file that can be written, and that ParaView will know by its name.
void require_output(const std::filesystem::path& file, const char* option, std::string_view extension) {
  std::error_code ignored;
  const bool named = file.extension() == extension || std::filesystem::is_character_file(file, ignored);
  if (!named)
    fail("{}: \"{}\" is to end in {}, by which ParaView knows it", option, file.string(), extension);
  check_writable(file, Contents::kShapes);
}

/// A motion of a countable number of steps, none of whose frames stands where the end is to be written.
void require_motion(const SolveOptions& options) {
  constexpr double kMostSteps = 1e7;  // of 1 ms: three hours
  const double steps = *options.seconds / options.step;
  if (steps > kMostSteps)
    fail("--step: {:g} s in steps of {:g} s are {:.2g} steps, more than {:g}; take longer ones",
         *options.seconds, options.step, steps, kMostSteps);
  if (!options.series) return;
  const std::filesystem::path of_series = options.series->parent_path() / options.series->stem();
  const std::string frames = std::filesystem::absolute(of_series).lexically_normal().string() + "_",
                    end = std::filesystem::absolute(options.out).lexically_normal().string();
  if (end.starts_with(frames) && end.find_first_not_of("0123456789", frames.size()) == end.rfind(".vtu"))
    fail("--out: \"{}\" is the name of a frame of --series; take another", options.out.string());
}

}  // namespace

int solve(const SolveOptions& options) {
  const Scene scene = read_scene(options.scene, Purpose::kSolve);
  if (!scene.material) fail("{}: solving needs a [material] section", scene.source);
  if (options.series && !options.seconds) fail("--series: needs --seconds, the time that it is a series of");
  if (options.seconds) require_motion(options);
  require_output(options.out, "--out", ".vtu");
  if (options.series) require_output(*options.series, "--series", ".pvd");
  ProgressLine progress;
  progress(name_of(Stage::kMesh), 0);
  TetMesh mesh = with_nodes(read_mesh_of(scene), scene.material->element);
  put_inclusions(scene, mesh);
  const Surface surface = boundary_surface(mesh);
  require_memory_for(scene, Purpose::kSolve, count_parts(mesh, surface));
  const Solid solid(mesh, *scene.material);
  const Loads loads(scene, mesh, surface, solid);
  std::vector<Probe> probes;
  for (const std::string& text : options.probes) probes.push_back(find_probe(text, solid, mesh.corners()));
  fmt::print("{}: {} nodes, {} tetrahedra\n", scene.source, solid.nodes(), solid.elements());
  if (!options.seconds && !scene.material->relaxations.empty())
    log::warning("{}: nothing relaxes in a static solution; --seconds tells how it does",
                 scene.material_where);
  if (!options.seconds && scene.loads.empty() && loads.motions().empty())
    log::warning("{}: no [[load]], so that the body stays as it is", scene.source);
  const Outcome outcome = options.seconds ? move_for(options, scene, solid, loads, progress)
                                          : find_rest(scene, solid, loads, progress);
  write_outcome(options.out, solid, outcome);
  print_outcome(scene.source, solid, loads, held_regions(scene, mesh), outcome, probes);
  return 0;
}

Command solve_command() {
  const auto options = std::make_shared<SolveOptions>();
  return {
      .name = "solve",
      .summary = "Solve a scene without a tool: loads, supports, one material",
      .footer =
          "Examples:\n"
          "  sim_server solve configs/scenes/liver_weight.toml --out liver.vtu --probe 0.1,0.03,0.02\n"
          "  sim_server solve configs/scenes/liver_weight.toml --seconds 2 --out end.vtu --series "
          "motion.pvd",
      .options =
          {{"SCENE",
            "Scene file (TOML) with [mesh], [material], [[fixed]], [[load]]",
            &options->scene,
            {.required = true}},
           {"--out", "Deformed mesh to write, for ParaView (.vtu)", &options->out, {.required = true}},
           {"--probe", "Place in the body at rest, m: prints its displacement; repeatable", &options->probes},
           {"--seconds",
            "Move for so long from rest, all loads there at once (default: the static equilibrium)",
            &options->seconds},
           {"--step", "Step of the motion, s", &options->step, {.shows_default = true, .needs = "--seconds"}},
           {"--series", "Also write the motion for ParaView: a .pvd and its frames", &options->series},
           {"--frames",
            "How many frames about",
            &options->frames,
            {.shows_default = true, .needs = "--series"}}},
      .run = [options] {
        if (options->seconds) require_within(*options->seconds, 1e-6, 1e6, "--seconds", "s");
        require_within(options->step, 1e-6, 1e3, "--step", "s");
        require_within(options->frames, 1, 100000, "--frames", "files");
        return solve(*options);
      }};
}

}  // namespace palpate::sim
