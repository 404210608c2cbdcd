#include "sim_server/study/study_run.h"

#include <cmath>
#include <fstream>
#include <numbers>

#include "common/clock.h"
#include "common/hash.h"
#include "common/report.h"
#include "sim_server/contact/contact_finder.h"
#include "sim_server/simulation/step_times.h"
#include "sim_server/study/surface_sites.h"

namespace palpate::sim {
namespace {

constexpr double kDepth = 0.5, kSlide = 1.0;  // of the tool's radius
constexpr double kClear = 0.3;                // of the tool's radius: above the surface, at both ends
constexpr double kPress = 0.5, kCompleteSurface = 2.0;  // s
constexpr double kRows = 1000;                          // of the motion, Hz
constexpr std::size_t kMostSites = 1500;                // compared at each millisecond of the motion

double eased(double fraction) {
  return 0.5 - 0.5 * std::cos(std::numbers::pi * std::clamp(fraction, 0.0, 1.0));
}

}  // namespace

Trajectory press_and_slide(const StudyCase& one) {
  Simulation simulation = simulation_of(one);
  const Press site = find_press(one.scene, simulation);
  const double radius = one.scene.tools.front().shape.radius;
  const Vec3 touching = site.place + 0.4 * radius * site.normal, along = site.normal.unitOrthogonal();
  std::vector<double> t;
  std::vector<Vec3> p;
  for (int i = 0; i <= static_cast<int>(kCompleteSurface * kRows); ++i) {
    const double now = i / kRows,
                 down = eased(now / kPress) - eased((now - kCompleteSurface + kPress) / kPress);
    const double slid =
        std::sin(2 * std::numbers::pi * eased((now - kPress) / (kCompleteSurface - 2 * kPress)));
    t.push_back(now);
    p.emplace_back(touching +
                   radius * ((kClear - (kClear + kDepth) * down) * site.normal + kSlide * slid * along));
  }
  return {std::move(t), std::move(p)};
}

Box around(const Trajectory& motion, double margin) {
  Box box{motion.at(0), motion.at(0)};
  for (double t = 0; t <= motion.duration(); t += 1 / kRows) {
    box.min = box.min.cwiseMin(motion.at(t));
    box.max = box.max.cwiseMax(motion.at(t));
  }
  return {box.min - Vec3::Constant(margin), box.max + Vec3::Constant(margin)};
}

std::vector<Vec3> compared_sites(const StudyCase& one, const Box& box) {
  const TetMesh mesh = mesh_of(one);
  std::vector<Vec3> sites;
  for (const int vertex : boundary_surface(mesh).vertices) {
    if (box.contains(mesh.vertices[vertex])) sites.push_back(mesh.vertices[vertex]);
  }
  const std::size_t every = (sites.size() + kMostSites - 1) / kMostSites;
  for (std::size_t k = 0; every > 1 && k * every < sites.size(); ++k) sites[k] = sites[k * every];
  if (every > 1) sites.resize((sites.size() + every - 1) / every);
  return sites;
}

namespace {

/// Hashes the end, where the tool has left and much may be as at rest, and all forces before.
std::uint64_t hash_of(std::span<const Vec3> forces, std::uint64_t end) {
  Fnv1a hash;
  for (const Vec3& force : forces) hash.add(force);
  hash.add(&end, sizeof end);
  return hash.value();
}

}  // namespace

Trace run_case(const StudyCase& one, const Trajectory& motion, double seconds, std::span<const Vec3> sites) {
  const Time begin = now();
  Simulation simulation = simulation_of(one);
  Trace trace;
  trace.dt = 1 / one.scene.rate_hz;
  trace.sites = sites.size();
  trace.setup_ms = 1e3 * to_seconds(now() - begin);
  trace.tetrahedra = simulation.mesh().tetrahedra.size();
  trace.nodes = simulation.mesh().vertices.size();
  const SurfaceSites followed(simulation.rest(), simulation.surface(), sites);
  Histogram ns;
  const auto steps = static_cast<int>(std::lround(seconds / trace.dt));
  for (int k = 1; k <= steps; ++k) {
    const Vec3 place = motion.at(k * trace.dt);
    const ToolPose pose(place, motion.orientation_at(k * trace.dt));
    const Time start = now();
    const ToolForce rendered = simulation.step(pose, trace.dt);
    const Time took = now() - start;
    if (rendered.contacts > 0) ns.add(took.count());
    trace.flagged += rendered.flagged ? 1 : 0;
    trace.places.push_back(place);
    trace.forces.push_back(rendered.force);
    trace.tangents.push_back(rendered.tangent);
    followed.add(simulation.rest(), simulation.positions(), trace.moved);
  }
  trace.step_ms_p50 = ns.quantile(0.5) / 1e6;
  trace.step_ms_p99 = ns.quantile(0.99) / 1e6;
  trace.state_hash = hash_of(trace.forces, simulation.state_hash());
  return trace;
}

}  // namespace palpate::sim
