#pragma once
#include "common/histogram.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// Place at which a tool presses: its centre (m, world), and the outward normal of the surface at rest there.
struct Press {
  Vec3 place, normal;
};

/// Unit outward normals of the surface vertices at rest, by the areas of their triangles. O(triangles).
std::vector<Vec3> normals_at_rest(const Simulation& simulation);

/// The place on a point of the surface (m), pressed to 40 % of the tool's radius (m).
Press press_on(const Vec3& surface, const Vec3& normal, double radius) noexcept;

/// A place in the middle of what the first tool can reach, on a vertex that is not fixed if there is one,
/// pressed to 40 % of the tool's radius. Tries 64 vertices, nearest to the middle first, until one gives
/// settled contact, or four are flagged; if none does, takes one that gives any. Leaves the tool lifted.
/// Set-up only.
Press find_press(const Scene& scene, Simulation& simulation);

/// Such a place for each tool, clear of those of the tools before it where there is room; where the scene has
/// it hold tissue, that place. None for a tool that reaches nothing. Throws `Error` where the first does not.
std::vector<std::optional<Press>> find_presses(const Scene& scene, Simulation& simulation);

/// Times of steps on this machine, ns.
struct StepTimes {
  Histogram free_ns;     ///< with the tools high above the organ
  Histogram contact_ns;  ///< with each tool at its `Press`, sliding a tenth of its radius to and fro
  int contacts = 0;      ///< of the latter steps, those in which all of them touched
  int flagged = 0;       ///< of the latter steps, those without a settled answer
  std::string why = {};  ///< they have none, in words (`FlaggedSteps`)
};

/// Takes `steps` steps free, then as many in contact, of all tools that have a place in `sites`, and leaves
/// them there: `state_hash` then tells whether two runs agree. `request`: of each tool, in each of them. One
/// thread; asks the clock twice a step.
StepTimes time_steps(const Scene& scene, Simulation& simulation, std::span<const std::optional<Press>> sites,
                     int steps, const Progress& progress = kSilent, const ToolRequest& request = {});
/// Times the steps of the first tool alone.
StepTimes time_steps(const Scene& scene, Simulation& simulation, const Press& site, int steps,
                     const Progress& progress = kSilent, const ToolRequest& request = {});

}  // namespace palpate::sim
