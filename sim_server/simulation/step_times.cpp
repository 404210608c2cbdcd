#include "sim_server/simulation/step_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/clock.h"
#include "common/error.h"
#include "sim_server/scene/touchable.h"

namespace palpate::sim {
namespace {

constexpr double kDepth = 0.4;          // of the tool radius
constexpr double kApart = 1.5;          // of the sum of two tools' radii: how far from each other they press
constexpr double kClear = 10;           // of the tool radius: how far above the organ the free tool moves
constexpr double kSlide = 0.1;          // of the tool radius: amplitude of the sliding
constexpr double kSlideSteps = 40;      // of one turn of it
constexpr std::size_t kTries = 64;      // vertices to press on before giving up
constexpr int kUnsettledTries = 4;      // of these, flagged: each may take seconds
constexpr double kUsualPeriod = 0.033;  // s, where the scene names no rate

double period_of(const Scene& scene) {
  return scene.rate_hz > 0 ? 1 / scene.rate_hz : kUsualPeriod;
}

const Vec3& at(const Simulation& simulation, int vertex) {
  return simulation.mesh().vertices[simulation.surface().vertices[vertex]];
}

/// Reachable vertices, the fixed ones only if there are no others, from the middle outwards.
std::vector<int> candidates(const Scene& scene, const Simulation& simulation, std::size_t tool) {
  std::vector<int> all = reachable_vertices(simulation.surface(), simulation.mesh(),
                                            std::span(scene.tools).subspan(tool, 1)),
                   free;
  const std::vector<int> fixed = fixed_vertices(scene, simulation.mesh());
  std::ranges::copy_if(all, std::back_inserter(free), [&](int v) {
    return !std::ranges::binary_search(fixed, simulation.surface().vertices[v]);
  });
  if (!free.empty()) all = free;
  Vec3 middle = Vec3::Zero();
  for (const int v : all) middle += at(simulation, v) / static_cast<double>(all.size());
  std::ranges::stable_sort(all, [&](int a, int b) {
    return (at(simulation, a) - middle).squaredNorm() < (at(simulation, b) - middle).squaredNorm();
  });
  return all;
}

/// The first so many of them that are clear of where other tools press, or where there is no room for that,
/// the last of all.
std::vector<int> clear_of(std::span<const std::optional<Press>> others, const Scene& scene, std::size_t tool,
                          const Simulation& simulation, std::vector<int> candidates) {
  const auto is_near = [&](int v) {
    for (std::size_t t = 0; t < others.size(); ++t) {
      const double apart = kApart * (scene.tools[t].shape.radius + scene.tools[tool].shape.radius);
      if (others[t] && (at(simulation, v) - others[t]->place).norm() < apart) return true;
    }
    return false;
  };
  const std::vector<int> last(candidates.empty() ? candidates.end() : candidates.end() - 1, candidates.end());
  std::erase_if(candidates, is_near);
  if (candidates.empty()) return last;
  candidates.resize(std::min(candidates.size(), kTries));
  return candidates;
}

using Sites = std::span<const std::optional<Press>>;

/// Each tool that has a site there, so many radii beyond it, and at this angle of its sliding across it.
std::vector<ToolInput> at_sites(const Scene& scene, Sites sites, double beyond, double angle,
                                const ToolRequest& request) {
  std::vector<ToolInput> inputs(scene.tools.size());
  for (std::size_t t = 0; t < sites.size(); ++t) {
    if (!sites[t]) continue;
    const double radius = scene.tools[t].shape.radius;
    const Vec3& normal = sites[t]->normal;
    inputs[t].pose = ToolPose(sites[t]->place + beyond * radius * normal +
                              kSlide * radius * std::sin(angle) * normal.unitOrthogonal());
    inputs[t].request = request;
  }
  return inputs;
}

/// The tools come from outside to their sites. Returns the force on each.
std::vector<ToolForce> approach(const Scene& scene, Simulation& simulation, Sites sites) {
  std::vector<ToolInput> inputs = at_sites(scene, sites, 2, 0, {});
  for (ToolInput& input : inputs) input.enters = input.pose.has_value();
  simulation.step(inputs, period_of(scene));
  const auto answers = simulation.step(at_sites(scene, sites, 0, 0, {}), period_of(scene));
  return {answers.begin(), answers.end()};
}

/// Returns where the tool presses; nothing: it reaches nothing.
std::optional<Press> press_of(const Scene& scene, Simulation& simulation, std::size_t tool, Sites others) {
  const std::vector<Vec3> normals = normals_at_rest(simulation);
  std::vector<Press> unsettled;
  int flagged = 0;
  const double radius = scene.tools[tool].shape.radius;
  for (const int vertex : clear_of(others, scene, tool, simulation, candidates(scene, simulation, tool))) {
    std::vector<std::optional<Press>> sites(tool + 1);
    sites[tool] = press_on(at(simulation, vertex), normals[vertex], radius);
    const ToolForce force = approach(scene, simulation, sites)[tool];
    simulation.step(std::vector<ToolInput>(simulation.tools()), 0);
    if (force.contacts > 0 && !force.flagged) return sites[tool];
    unsettled.insert(force.contacts > 0 ? unsettled.begin() : unsettled.end(), *sites[tool]);
    flagged += force.flagged ? 1 : 0;
    if (flagged == kUnsettledTries) break;
  }
  return unsettled.empty() ? std::optional<Press>() : unsettled.front();
}

}  // namespace

std::vector<Vec3> normals_at_rest(const Simulation& simulation) {
  std::vector<Vec3> normals(simulation.surface().vertices.size(), Vec3::Zero());
  for (const Triangle& t : simulation.surface().triangles) {
    const Vec3 &a = at(simulation, t[0]), &b = at(simulation, t[1]), &c = at(simulation, t[2]);
    for (const int corner : t) normals[corner] += (b - a).cross(c - a);
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

Press press_on(const Vec3& surface, const Vec3& normal, double radius) noexcept {
  return {surface + (1 - kDepth) * radius * normal, normal};
}

Press find_press(const Scene& scene, Simulation& simulation) {
  if (const auto site = press_of(scene, simulation, 0, {})) return *site;
  fail(
      "{}: the first [[tool]] reaches nothing of the organ, so that no step in contact can be timed; widen "
      "its "
      "`reach`, or put another one first",
      scene.tools.front().where);
}

std::vector<std::optional<Press>> find_presses(const Scene& scene, Simulation& simulation) {
  std::vector<std::optional<Press>> sites{find_press(scene, simulation)};
  for (std::size_t t = 1; t < scene.tools.size(); ++t)
    sites.push_back(press_of(scene, simulation, t, std::vector(sites)));
  for (std::size_t t = 1; t < sites.size(); ++t) {
    if (scene.tools[t].grasp_place) sites[t] = {*scene.tools[t].grasp_place, Vec3::UnitY()};
  }
  return sites;
}

StepTimes time_steps(const Scene& scene, Simulation& simulation, const Press& site, int steps,
                     const Progress& progress, const ToolRequest& request) {
  return time_steps(scene, simulation, std::array{std::optional(site)}, steps, progress, request);
}

StepTimes time_steps(const Scene& scene, Simulation& simulation, Sites sites, int steps,
                     const Progress& progress, const ToolRequest& request) {
  const double dt = period_of(scene);
  std::vector<std::optional<Press>> above(sites.begin(), sites.end());
  for (std::size_t t = 0; t < above.size(); ++t) {
    if (!above[t]) continue;
    above[t]->normal = Vec3::UnitY();
    for (const Vec3& x : simulation.positions())
      above[t]->place[1] = std::max(above[t]->place[1], x[1] + kClear * scene.tools[t].shape.radius);
  }
  StepTimes times;
  const auto timed_step = [&](Sites at, int i, Histogram& ns) {
    const std::vector<ToolInput> inputs =
        at_sites(scene, at, 0, 2 * std::numbers::pi * i / kSlideSteps, request);
    const Time start = now();
    const auto answers = simulation.step(inputs, dt);
    ns.add((now() - start).count());
    return answers;
  };
  const auto report = [&](int done) { progress("timing steps", 0.5 * done / steps); };
  report(0);
  simulation.step(std::vector<ToolInput>(simulation.tools()), 0);
  simulation.step(at_sites(scene, above, 0, 0, {}), dt);
  for (int i = 1; i <= steps; ++i) {
    timed_step(above, i, times.free_ns);
    report(i);
  }
  approach(scene, simulation, sites);
  const FlaggedSteps before = simulation.flagged();
  for (int i = 1; i <= steps; ++i) {
    const auto answers = timed_step(sites, i, times.contact_ns);
    bool all_touch = true, any_flagged = false;
    for (std::size_t t = 0; t < sites.size(); ++t) {
      all_touch = all_touch && (!sites[t] || answers[t].contacts > 0);
      any_flagged = any_flagged || answers[t].flagged;
    }
    times.contacts += all_touch ? 1 : 0;
    times.flagged += any_flagged ? 1 : 0;
    report(steps + i);
  }
  times.why = (simulation.flagged() - before).to_text();
  return times;
}

}  // namespace palpate::sim
