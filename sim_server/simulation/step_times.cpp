#include "sim_server/simulation/step_times.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/clock.h"
#include "common/error.h"
#include "sim_server/scene/touchable.h"

namespace palpate::sim {
namespace {

constexpr double kDepth = 0.4;          // of the tool radius
constexpr double kClear = 10;           // of the tool radius: how far above the organ the free tool moves
constexpr double kSlide = 0.1;          // of the tool radius: amplitude of the sliding
constexpr double kSlideSteps = 40;      // of one turn of it
constexpr std::size_t kTries = 64;      // vertices to press on before giving up
constexpr double kUsualPeriod = 0.033;  // s, where the scene names no rate

double period_of(const Scene& scene) {
  return scene.rate_hz > 0 ? 1 / scene.rate_hz : kUsualPeriod;
}

const Vec3& at(const Simulation& simulation, int vertex) {
  return simulation.mesh().vertices[simulation.surface().vertices[vertex]];
}

/// Outward normals at rest, weighted by area.
std::vector<Vec3> vertex_normals(const Simulation& simulation) {
  std::vector<Vec3> normals(simulation.surface().vertices.size(), Vec3::Zero());
  for (const Triangle& t : simulation.surface().triangles) {
    const Vec3 &a = at(simulation, t[0]), &b = at(simulation, t[1]), &c = at(simulation, t[2]);
    for (const int corner : t) normals[corner] += (b - a).cross(c - a);
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

/// Reachable vertices, the fixed ones only if there are no others, from the middle outwards.
std::vector<int> candidates(const Scene& scene, const Simulation& simulation) {
  std::vector<int> all = reachable_vertices(simulation.surface(), simulation.mesh(),
                                            std::span(scene.tools).first(1)),
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
  all.resize(std::min(all.size(), kTries));
  return all;
}

/// Comes from outside to `site`.
ToolForce approach(const Scene& scene, Simulation& simulation, const Press& site) {
  std::vector<ToolInput> inputs(simulation.tools());
  inputs.front() = {.pose = ToolPose(site.place + 2 * scene.tools.front().shape.radius * site.normal),
                    .enters = true};
  simulation.step(inputs, period_of(scene));
  return simulation.step(site.place, period_of(scene));
}

ToolForce timed_step(Simulation& simulation, std::span<ToolInput> inputs, const Vec3& p_W, double dt,
                     Histogram& ns) {
  inputs.front().pose = ToolPose(p_W);
  const Time start = now();
  ToolForce force = simulation.step(inputs, dt).front();
  ns.add((now() - start).count());
  return force;
}

}  // namespace

Press find_press(const Scene& scene, Simulation& simulation) {
  const std::vector<Vec3> normals = vertex_normals(simulation);
  std::vector<Press> unsettled;
  for (const int vertex : candidates(scene, simulation)) {
    const Vec3& normal = normals[vertex];
    Press site{at(simulation, vertex) + (1 - kDepth) * scene.tools.front().shape.radius * normal, normal};
    const ToolForce force = approach(scene, simulation, site);
    simulation.step(std::vector<ToolInput>(simulation.tools()), 0);
    if (force.contacts > 0 && !force.flagged) return site;
    unsettled.insert(force.contacts > 0 ? unsettled.begin() : unsettled.end(), site);
  }
  if (unsettled.empty())
    fail(
        "{}: the first [[tool]] reaches nothing of the organ, so that no step in contact can be timed; widen "
        "its "
        "`reach`, or put another one first",
        scene.tools.front().where);
  return unsettled.front();
}

StepTimes time_steps(const Scene& scene, Simulation& simulation, const Press& site, int steps,
                     const Progress& progress, const ToolRequest& request) {
  const double radius = scene.tools.front().shape.radius, dt = period_of(scene);
  const auto slide = [&](int i) {
    return kSlide * radius * std::sin(2 * std::numbers::pi * i / kSlideSteps);
  };
  Vec3 above = site.place;
  for (const Vec3& x : simulation.positions()) above[1] = std::max(above[1], x[1] + kClear * radius);
  std::vector<ToolInput> inputs(simulation.tools());
  inputs.front().request = request;
  StepTimes times;
  const auto report = [&](int done) { progress("timing steps", 0.5 * done / steps); };
  report(0);
  simulation.step(std::vector<ToolInput>(simulation.tools()), 0);
  simulation.step(above, dt);
  for (int i = 1; i <= steps; ++i) {
    timed_step(simulation, inputs, above + slide(i) * Vec3::UnitX(), dt, times.free_ns);
    report(i);
  }
  const Vec3 tangent = site.normal.unitOrthogonal();
  approach(scene, simulation, site);
  const FlaggedSteps before = simulation.flagged();
  for (int i = 1; i <= steps; ++i) {
    const ToolForce force =
        timed_step(simulation, inputs, site.place + slide(i) * tangent, dt, times.contact_ns);
    times.contacts += force.contacts > 0 ? 1 : 0;
    times.flagged += force.flagged ? 1 : 0;
    report(steps + i);
  }
  times.why = (simulation.flagged() - before).to_text();
  return times;
}

}  // namespace palpate::sim
