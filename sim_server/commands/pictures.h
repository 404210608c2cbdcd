#pragma once
#include "sim_server/serving/served_tools.h"
#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// What the page is told of a scene before anything moves.
SceneFacts facts_of(const Scene& scene, const Simulation& simulation);

/// Each fills in what a page is shown; no allocation.
/// `outcome`: of the newest step; null: there was none, and what was felt before stays. `t`: s.
void show_tool(const SessionInput& input, const ServedTools::Outcome* outcome, double t,
               SeenTool& seen) noexcept;
/// Positions, and what the tools put on the surface.
void show_organ(const Simulation& simulation, Picture& picture) noexcept;

}  // namespace palpate::sim
