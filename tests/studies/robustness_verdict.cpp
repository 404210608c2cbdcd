// What a run of the robustness study is held against, and what came of it.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "tests/studies/robustness.h"

namespace palpate::studies {
namespace {

using namespace palpate::sim;

constexpr double kAbsurd = 10;        // of the largest force expected, unflagged on the way: wrong
constexpr double kReturned = 0.05;    // of the depth: how far from rest a surface may be that was let go
constexpr double kSmallest = 1e-9;    // N: less is no force
constexpr double kReportWhy = 0.01;   // an error of a force that nothing flagged: more is looked into
constexpr double kSamePlace = 1e-3;   // of the force: two runs that ended in one place
constexpr double kAside = 0.0005;     // m
constexpr int kSlower = 8;            // a multiple of all `Trial::phases`
constexpr double kGivenToRest = 0.5;  // of the hold: before, what moves may still swing

/// The forces as they should be, and the largest on the way.
struct AtRest {
  std::string what;
  std::vector<Range> newton;  // of each tool
  std::vector<Vec3> force;    // of each tool; empty: only its size is known
  double most = 0;
  bool settled = true;
  bool impossible = false;  // nothing but a flag is right
  std::optional<Run> slower =
      {};  // of a model at rest at every instant: the same path, `kSlower` times as slowly
};

const Column& first_column(bool (*is)(const Column&)) {
  return *std::find_if(columns().begin(), columns().end(), is);
}

/// What stands for the truth: the same scene, to the same end, slowly and by another model where there is
/// one.
struct Truth {
  Trial trial;
  const Column* column;
  std::string what;

  Run follow(const std::vector<Path>& paths) const { return studies::follow(trial, *column, paths, false); }
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
  if (trial.refer) trial.refer(slow);
  const bool same = !column.linear() || trial.only_implicit_refers;
  // The equilibrium itself; of that, the same matrix by steps of a motion.
  const auto at_rest = [](const Column& c) { return c.row->deforms() && c.at_rest(); };
  const Column& other =
      same ? column
           : (at_rest(column) ? first_column([](const Column& c) { return c.any_law() && c.linear(); })
                              : first_column(at_rest));
  std::string what = same ? fmt::format("pressed slowly, Newton's method to {:g}", slow.file.tolerance)
                          : fmt::format("{}, pressed slowly", other.name);
  if (!trial.refers_to.empty()) what += ": " + trial.refers_to;
  return {std::move(slow), &other, what};
}

/// The whole motion, `kSlower` times as slowly.
Run more_slowly(Trial trial, const Column& column) {
  trial.seconds *= kSlower;
  for (Path& path : trial.paths) {
    for (Waypoint& waypoint : path) waypoint.t *= kSlower;
  }
  return follow(trial, column, trial.paths, false);
}

AtRest closed_form(const std::string& what, std::size_t tools, const Range& range) {
  return {what, std::vector<Range>(tools, range), {}, range.most};
}

/// From the run of a truth.
AtRest forces_of(const Run& run, const Trial& trial) {
  AtRest expected{"", {}, {}, trial.times * trial.most * run.max_newton};
  for (const Vec3& force : run.last().force) {
    const double newton = trial.times * force.norm();
    expected.newton.push_back({newton, trial.most * newton});
    if (trial.most == 1) expected.force.push_back(trial.times * force);
  }
  return expected;
}

AtRest expected_of(const Trial& trial, const Column& column) {
  const std::size_t tools = trial.paths.size();
  if (trial.rendered && !column.is_placed())
    return closed_form("closed form: the stiffness of held vertices x depth", tools, *trial.rendered);
  if (trial.no_rest_unbent && !column.row->deforms() && column.row->moves) {
    AtRest none = closed_form("none: there is no place to rest", tools, {0, 1e300});
    none.settled = false;
    none.impossible = true;
    return none;
  }
  if (!column.row->deforms()) {
    const double newton = trial.rendered_by_rigid.value_or(1) * 800 * trial.depth;
    return closed_form("closed form: stiffness x depth", tools, {newton, newton});
  }
  const Truth truth = truth_of(trial, column);
  const Run run = truth.follow(truth.trial.paths);
  AtRest expected = forces_of(run, trial);
  expected.what = truth.what;
  expected.settled = run.finite && !run.last().flagged && !(trial.path_matters && run.flagged > 0);
  if (!expected.settled) expected.what += ": flagged, so that there is no error to tell";
  if (run.flagged > 0)
    expected.what += fmt::format(" (flagged in {} of {} steps)", run.flagged, run.steps.size());
  return expected;
}

double error_of(const std::vector<Vec3>& force, const AtRest& expected) {
  double error = 0;
  for (std::size_t k = 0; k < force.size(); ++k) {
    const Range& range = expected.newton[k];
    const double newton = force[k].norm();
    const double off = expected.force.empty() ? std::max({0.0, range.least - newton, newton - range.most})
                                              : (force[k] - expected.force[k]).norm();
    error = std::max(error, off / std::max(range.least, kSmallest));
  }
  return error;
}

/// What the truth finds where its tools come from a little aside, if it ends where `run` did then: two facets
/// may both bear a tool, and the way to the end decides. A force that is far off, or none, is no such
/// neighbour, whoever else finds it.
std::optional<AtRest> another_rest(const Run& run, const Trial& trial, const Column& column) {
  const Truth truth = truth_of(trial, column);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      std::vector<Path> paths = truth.trial.paths;
      for (Path& path : paths) {
        const Waypoint end = path.back();
        path.back().place[axis] += sign * kAside;
        path.push_back({(end.t + truth.trial.seconds) / 2, end.place});
      }
      const Run other = truth.follow(paths);
      AtRest there = forces_of(other, trial);
      if (other.last().flagged || error_of(run.last().force, there) > kSamePlace) continue;
      there.what = fmt::format(
          "the tools have more than one place to rest, and this is another: {} ends there, too, where they "
          "come from {} mm aside ({}{})",
          truth.column->name, 1e3 * kAside, sign < 0 ? '-' : '+', "xyz"[axis]);
      return there;
    }
  }
  return {};
}

/// What is wrong at some time while the tools are there, unflagged; nothing: all is well.
std::string wrong_on_the_way(const Run& run, const Trial& trial, const AtRest& expected) {
  const double until = run.last().t;
  const double scale = std::max(expected.newton.front().least, kSmallest);
  for (const Rendered& held : run.pressed()) {
    if (held.flagged) continue;
    for (std::size_t k = 0; k < held.force.size(); ++k) {
      const double inward = -held.force[k].dot(trial.outward[k]);
      if (inward > trial.bound * scale)
        return fmt::format("{:.3g} N towards the body at {:.2f} s, and not flagged", inward, held.t);
    }
    if (expected.impossible && held.t > run.arrived)
      return fmt::format("{:.3g} N at {:.2f} s, where it has no place to rest, and not flagged",
                         held.force.front().norm(), held.t);
    const bool settled = held.t >= run.arrived + kGivenToRest * (until - run.arrived);
    const double error = error_of(held.force, expected);
    if (expected.settled && settled && error > trial.bound)
      return fmt::format("{:.3g} N where {:.3g} N is right, {:.2g} % off at {:.2f} s, and not flagged",
                         held.force.front().norm(), expected.newton.front().least, 100 * error, held.t);
  }
  return {};
}

/// Of a model that is at rest at every instant: what it finds on the way, where the same way in finer steps
/// finds something else.
std::string wrong_between(const Run& run, const Trial& trial, const AtRest& expected) {
  if (!expected.slower) return {};
  const std::span<const Rendered> found = run.pressed(), right = expected.slower->pressed();
  const double scale = std::max(expected.newton.front().least, kSmallest);
  for (std::size_t i = 0; i < found.size(); ++i) {
    // A step of the slower run ends where this one does, whatever the phase.
    const auto at = static_cast<int>(i + 1) * kSlower - run.phase * kSlower / trial.phases - 1;
    if (at < 0 || at >= static_cast<int>(right.size()) || found[i].flagged || right[at].flagged) continue;
    for (std::size_t k = 0; k < right[at].force.size(); ++k) {
      const double off = (found[i].force[k] - right[at].force[k]).norm() / scale;
      if (off > trial.bound)
        return fmt::format(
            "{:.3g} N at {:.2f} s, where {} times as many steps there give {:.3g} N, and not flagged",
            found[i].force[k].norm(), found[i].t, kSlower, right[at].force[k].norm());
    }
  }
  return {};
}

/// What is wrong of one run, or nothing.
std::string wrong_of(const Run& run, const Trial& trial, const AtRest& expected) {
  if (run.wildest > kAbsurd * expected.most + kSmallest)
    return fmt::format("{:.3g} N without a flag; the reference has {:.3g} N at most", run.wildest,
                       expected.most);
  if (run.off > kReturned * trial.depth && !run.ends_flagged())
    return fmt::format("let go, its surface stays up to {:.3g} mm off, and not flagged", 1e3 * run.off);
  const std::string wrong = wrong_on_the_way(run, trial, expected);
  return wrong.empty() ? wrong_between(run, trial, expected) : wrong;
}

Verdict judge_one(const Run& run, const Trial& trial, const Column& column, const AtRest& expected) {
  Verdict verdict{"stable", "", {}, run.max_newton, expected.what};
  if (!run.finite)
    return {"exploded", "a force, tangent or position that is not finite", {}, {}, expected.what};
  if (expected.settled) verdict.error_percent = 100 * error_of(run.last().force, expected);
  std::optional<AtRest> remote;
  const double error = verdict.error_percent.value_or(0) / 100;
  const double report_why = trial.bound == kBound ? kReportWhy : trial.bound;
  if (!run.last().flagged && error > report_why && error < trial.other_rest && column.row->deforms() &&
      !trial.rendered)
    remote = another_rest(run, trial, column);
  if (remote) remote->most = expected.most;
  const std::string wrong = wrong_of(run, trial, remote.value_or(expected));
  if (!wrong.empty() && run.locks) {
    verdict.outcome = "flagged";
    verdict.reason = "warned at the start that its elements lock, with those to take instead: " + wrong;
  } else if (!wrong.empty()) {
    verdict.outcome = "wrong";
    verdict.reason = wrong;
  } else if (run.flagged > 0) {
    verdict.outcome = "flagged";
    verdict.reason = fmt::format(
        "{} of {} steps flagged, answered with what was found so far; {}", run.flagged, run.steps.size(),
        run.last().flagged ? "the force at the end, too" : "the force at the end was not");
  }
  if (remote) verdict.reason += (verdict.reason.empty() ? "" : "; ") + remote->what;
  return verdict;
}

int rank(const Verdict& verdict) {
  const std::vector<std::string> worse{"stable", "flagged", "wrong", "exploded"};
  return static_cast<int>(std::ranges::find(worse, verdict.outcome) - worse.begin());
}

}  // namespace

Verdict judge(const std::vector<Run>& runs, const Trial& trial, const Column& column) {
  if (trial.must_refuse && column.row->deforms())
    return {"wrong", "accepted, though nothing holds it from turning", {}, runs.front().max_newton, ""};
  AtRest expected;
  try {
    expected = expected_of(trial, column);
  } catch (const Error& e) {
    expected.what = fmt::format("none: {}", e.what());
    expected.settled = false;
    expected.most = 1e300;
    expected.newton.assign(trial.paths.size(), {0, 0});
  }
  if (column.at_rest()) expected.slower = more_slowly(trial, column);
  // A warning that elements lock excuses what they find at rest, not what is found on the way there.
  Trial locked = trial;
  locked.refer = {};
  locked.refers_to = "with elements that lock";
  std::optional<AtRest> of_locked;
  if (runs.front().locks) of_locked = expected_of(locked, column);
  Verdict worst;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Verdict verdict = judge_one(runs[i], trial, column, expected);
    const std::string wrong = of_locked ? wrong_of(runs[i], locked, *of_locked) : "";
    if (!wrong.empty()) {
      verdict.outcome = "wrong";
      verdict.reason = fmt::format("{} ({})", wrong, of_locked->what);
    }
    const bool worse = i == 0 || rank(verdict) > rank(worst) ||
                       (rank(verdict) == rank(worst) && verdict.error_percent > worst.error_percent);
    if (worse) worst = verdict;
    if (worse && i > 0 && rank(verdict) > 0)
      worst.reason = fmt::format("begun {} of {} of a step later: {}", i, runs.size(), worst.reason);
  }
  return worst;
}

}  // namespace palpate::studies
