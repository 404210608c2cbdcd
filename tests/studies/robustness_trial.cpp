// A tool on a block of some model, watched step by step, and compared with a reference.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "sim_server/mesh/mesh_faults.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/simulation.h"
#include "tests/studies/robustness.h"
#include "tests/support/solids.h"
#include "tests/support/temporary_folder.h"

namespace palpate::studies {
namespace {

using namespace palpate::sim;

constexpr double kAbsurd = 10;       // of the largest force of the reference: an explosion
constexpr double kReturned = 0.05;   // of the depth: how far from rest a surface may be that was let go
constexpr double kSmallest = 1e-9;   // N: less is no force
constexpr double kTellWhy = 0.01;    // an error of a force that nothing flagged: more is looked into,
constexpr double kWrong = 0.1;       // and so much without a reason is no answer
constexpr double kSamePlace = 1e-3;  // of the force: two runs that ended in one place
constexpr double kAside = 0.0005;    // m
constexpr const char* kMesh = "block.msh";

/// What a run showed.
struct Run {
  std::vector<Vec3> last;  // the force on each tool while it was there, N
  double max_newton = 0;   // of all steps
  double wildest = 0;      // of those that were not flagged
  int steps = 0, flagged = 0;
  bool pressed_flagged = false;  // when `last` was felt
  bool finite = true, ends_flagged = false;
  double off = 0;  // from where the surface began, when the tools have been away, m
};

Vec3 place_at(const Path& path, double t) {
  const auto next = std::find_if(path.begin(), path.end(), [t](const Waypoint& w) { return w.t > t; });
  if (next == path.end()) return path.back().place;
  if (next == path.begin()) return path.front().place;
  const Waypoint& from = *std::prev(next);
  if (t == from.t) return from.place;
  return from.place + (t - from.t) / (next->t - from.t) * (next->place - from.place);
}

class Watch {
 public:
  Watch(Simulation& simulation, double rate_hz) : simulation_(simulation), dt_(1 / rate_hz) {
    began_.assign(simulation.positions().begin(), simulation.positions().end());
  }

  Run follow(const std::vector<Path>& paths, double seconds) {
    const int steps = static_cast<int>(std::lround(seconds / dt_));
    std::vector<ToolInput> inputs(paths.size());
    for (int i = 1; i <= steps && run_.finite; ++i) {
      for (std::size_t k = 0; k < paths.size(); ++k) inputs[k].pose = place_at(paths[k], i * dt_);
      see(simulation_.step(inputs, dt_));
    }
    run_.last = felt_;
    run_.pressed_flagged = run_.ends_flagged;
    for (ToolInput& input : inputs) input.pose.reset();
    for (int i = 0; i < steps && run_.finite; ++i) see(simulation_.step(inputs, dt_));
    for (std::size_t v = 0; v < began_.size(); ++v)
      run_.off = std::max(run_.off, (simulation_.positions()[v] - began_[v]).norm());
    return run_;
  }

 private:
  void see(std::span<const ToolAnswer> forces) {
    ++run_.steps;
    run_.ends_flagged = false;
    felt_.clear();
    for (const ToolForce& force : forces) {
      felt_.push_back(force.force);
      const double newton = force.force.norm();
      run_.finite = run_.finite && std::isfinite(newton) && force.tangent.allFinite();
      run_.max_newton = std::max(run_.max_newton, newton);
      if (!force.flagged) run_.wildest = std::max(run_.wildest, newton);
      run_.ends_flagged = run_.ends_flagged || force.flagged;
    }
    run_.ends_flagged = run_.ends_flagged || !simulation_.model().balanced();
    run_.flagged += run_.ends_flagged ? 1 : 0;
    for (const Vec3& x : simulation_.positions()) run_.finite = run_.finite && x.allFinite();
  }

  Simulation& simulation_;
  double dt_;
  std::vector<Vec3> began_, felt_;
  Run run_;
};

Run follow(const Trial& trial, const SceneFile& file, const Column& column, const std::vector<Path>& paths) {
  const test::TemporaryFolder folder;
  folder.write(kMesh, "");  // that it is there: the mesh is made here
  try {
    const Scene scene = read_scene(folder.write("scene.toml", file.text(column, kMesh)));
    TetMesh mesh = trial.mesh;
    require_usable(mend(mesh), kMesh);
    Simulation simulation(scene, std::move(mesh));
    return Watch(simulation, file.rate_hz).follow(paths, trial.seconds);
  } catch (const Error& e) {
    std::string said = e.what();  // without the name of the folder, which is another every time
    const std::string path = folder.path().string() + "/";
    for (std::size_t at; (at = said.find(path)) != std::string::npos;) said.erase(at, path.size());
    throw Error(said, static_cast<Error::Kind>(e.exit_code()));
  }
}

const Column& column_named(std::string_view name) {
  return *std::find_if(columns().begin(), columns().end(),
                       [name](const Column& c) { return c.name == name; });
}

/// The force at the end as it should be, and the largest on the way; for `rigid` from the closed form.
struct Reference {
  std::string what;
  std::vector<double> newton;  // of each tool
  std::vector<Vec3> force;     // of each tool; empty: only its size is known
  double most = 0;
  bool settled = true;
};

/// What stands for the truth: the same scene, to the same end, slowly and by another model where there is
/// one.
struct Truth {
  Trial trial;
  const Column* column;
  bool same;  // as the one that is tried

  Run follow(const std::vector<Path>& paths) const {
    return studies::follow(trial, trial.file, *column, paths);
  }
};

Truth truth_of(const Trial& trial, const Column& column) {
  Trial slow = trial;
  slow.file.rate_hz = 30;
  slow.file.max_newton = 60;
  slow.file.tolerance = 1e-9;
  slow.file.rayleigh_mass = SceneFile{}.rayleigh_mass;
  slow.file.rayleigh_stiffness = SceneFile{}.rayleigh_stiffness;
  slow.seconds = std::max(trial.seconds, trial.reference_seconds);
  if (!trial.slow.empty()) slow.paths = trial.slow;
  const bool same = !column.linear() || trial.only_implicit_refers;
  const Column& other =
      same ? column : column_named(column.model == "quasi_static" ? "implicit linear" : "quasi_static");
  return {std::move(slow), &other, same};
}

Reference reference_of(const Trial& trial, const Column& column) {
  if (column.model == "rigid") {
    const double newton = trial.felt_by_rigid.value_or(1) * 800 * trial.depth;
    return {"closed form: stiffness x depth", std::vector<double>(trial.paths.size(), newton), {}, newton};
  }
  const Truth truth = truth_of(trial, column);
  const Run run = truth.follow(truth.trial.paths);
  Reference reference{truth.same ? "pressed slowly, Newton's method to 1e-9"
                                 : fmt::format("{}, pressed slowly", truth.column->name),
                      {},
                      run.last,
                      run.max_newton};
  for (const Vec3& force : run.last) reference.newton.push_back(force.norm());
  reference.settled = !run.pressed_flagged;
  if (!reference.settled) reference.what += ": flagged at its end, so that there is no error to tell";
  if (run.flagged > 0) reference.what += fmt::format(" (flagged in {} of {} steps)", run.flagged, run.steps);
  return reference;
}

double error_of(const Run& run, const Reference& reference) {
  double error = 0;
  for (std::size_t k = 0; k < run.last.size(); ++k) {
    const double off = reference.force.empty() ? std::abs(run.last[k].norm() - reference.newton[k])
                                               : (run.last[k] - reference.force[k]).norm();
    error = std::max(error, off / std::max(reference.newton[k], kSmallest));
  }
  return error;
}

/// Whether the truth ends where `run` did, too, if its tools come from a little aside: two facets may both
/// bear a tool, and then the way to the end decides. Says so, or nothing.
std::string another_rest(const Run& run, const Truth& truth) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      std::vector<Path> paths = truth.trial.paths;
      for (Path& path : paths) {
        const Waypoint end = path.back();
        path.back().place[axis] += sign * kAside;
        path.push_back({(end.t + truth.trial.seconds) / 2, end.place});
      }
      const Run other = truth.follow(paths);
      Reference there{"", {}, other.last};
      for (const Vec3& force : other.last) there.newton.push_back(force.norm());
      if (!other.pressed_flagged && error_of(run, there) < kSamePlace)
        return fmt::format(
            "the tools have more than one place to rest, and this is another: {} ends there, too, where they "
            "come from {} mm aside ({}{})",
            truth.column->name, 1e3 * kAside, sign < 0 ? '-' : '+', "xyz"[axis]);
    }
  }
  return {};
}

Verdict judge(const Run& run, const Reference& reference, double depth) {
  Verdict verdict{"stable", "", {}, run.max_newton, reference.what};
  if (reference.settled) verdict.error_percent = 100 * error_of(run, reference);
  const std::string flags =
      run.flagged == 0
          ? ""
          : fmt::format("{} of {} steps flagged, answered with what was found so far; {}", run.flagged,
                        run.steps,
                        run.pressed_flagged ? "the force at the end, too" : "the force at the end was not");
  if (!run.finite) {
    verdict = {"exploded", "a force, tangent or position that is not finite", {}, {}, reference.what};
  } else if (run.wildest > kAbsurd * reference.most + kSmallest) {
    verdict.outcome = "exploded";
    verdict.reason = fmt::format("{:.3g} N without a flag; the reference has {:.3g} N at most", run.wildest,
                                 reference.most);
  } else if (run.off > kReturned * depth && !run.ends_flagged) {
    verdict.outcome = "exploded";
    verdict.reason = fmt::format("let go, its surface stays up to {:.3g} mm off", 1e3 * run.off);
  } else if (run.flagged > 0) {
    verdict.outcome = "flagged";
    verdict.reason = flags;
  }
  return verdict;
}

/// A force that was told as settled and is off needs a reason; where it is far off and there is none, it is
/// wrong.
void look_into(Verdict& verdict, const Run& run, const Trial& trial, const Column& column) {
  if (verdict.outcome == "exploded" || run.pressed_flagged || verdict.error_percent <= 100 * kTellWhy) return;
  const std::string elsewhere = column.model == "rigid" ? "" : another_rest(run, truth_of(trial, column));
  if (elsewhere.empty() && verdict.error_percent > 100 * kWrong) {
    verdict.outcome = "exploded";
    verdict.reason = fmt::format("{:.2g} % off, and not flagged", *verdict.error_percent);
  } else if (!elsewhere.empty()) {
    verdict.reason += (verdict.reason.empty() ? "" : "; ") + elsewhere;
  }
}

}  // namespace

const std::vector<Column>& columns() {
  static const std::vector<Column> all{
      {"rigid", "rigid", "linear", ElasticLaw::kLinear},
      {"quasi_static", "quasi_static", "linear", ElasticLaw::kLinear},
      {"tensor_mass", "tensor_mass", "linear", ElasticLaw::kLinear},
      {"reduced", "reduced", "linear", ElasticLaw::kLinear},
      {"implicit linear", "implicit", "linear", ElasticLaw::kLinear},
      {"implicit corotational", "implicit", "corotational", ElasticLaw::kCorotational},
      {"implicit neo_hookean", "implicit", "neo_hookean", ElasticLaw::kNeoHookean},
      {"implicit stvk", "implicit", "stvk", ElasticLaw::kStVenantKirchhoff}};
  return all;
}

TetMesh usual_block() {
  return grid_block(test::lines(-0.015, 0.015, 6), test::lines(-0.015, 0, 3), test::lines(-0.015, 0.015, 6));
}

std::string SceneFile::text(const Column& column, const std::string& mesh) const {
  std::string text = fmt::format("rate_hz = {}\n[mesh]\nfile = \"{}\"\n{}{}", rate_hz, mesh, fixed, loads);
  text +=
      fmt::format("[material]\nlaw = \"{}\"\nelement = \"{}\"\nyoung_modulus = {}\npoisson_ratio = {}\n{}",
                  column.law, element, young_modulus, poisson_ratio, material);
  text += fmt::format("[deformation]\nmodel = \"{}\"\n", column.model);
  if (column.model == "rigid") text += "stiffness = 800\n";
  if (column.model == "tensor_mass" || column.model == "reduced" || column.implicit())
    text += fmt::format("rayleigh_mass = {}\nrayleigh_stiffness = {}\n", rayleigh_mass, rayleigh_stiffness);
  if (column.implicit()) text += fmt::format("max_newton = {}\ntolerance = {}\n", max_newton, tolerance);
  for (const std::string& tool : tools) text += fmt::format("[[tool]]\n{}\n", tool);
  return text;
}

Verdict run_trial(const Case& row, const Column& column, bool quick) {
  Trial trial;
  trial.mesh = usual_block();
  trial.paths = {{{0, Vec3(0.001, 0.006, 0.002)}, {1, Vec3(0.001, 0.001, 0.002)}}};
  row.change(trial);
  if (quick) trial.seconds = std::min(trial.seconds, 2.0);
  try {
    const Run run = follow(trial, trial.file, column, trial.paths);
    Verdict verdict = judge(run, reference_of(trial, column), trial.depth);
    look_into(verdict, run, trial, column);
    return verdict;
  } catch (const Error& e) {
    return {"refused", e.what(), {}, {}, ""};
  }
}

}  // namespace palpate::studies
