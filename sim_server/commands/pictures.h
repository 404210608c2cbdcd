#pragma once
#include <functional>

#include "sim_server/serving/served_tools.h"
#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// What the page is told of a scene before anything moves.
SceneFacts facts_of(const Scene& scene, const Simulation& simulation);

/// What colours the surface of such a body by the energy inside: J/m3 of each of its vertices, the mean of
/// the tetrahedra around it by their volume. Made when it is first asked, in that thread, and computed there
/// alone: some 0.2 us a tetrahedron and quadrature point. All references outlive what this returns.
std::function<void(std::span<const Vec3>, std::vector<float>&)> strain_energy_of(
    const Scene& scene, const Simulation& simulation);

/// Each fills in what a page is shown; no allocation, but for the triangles of an organ that is cut.
/// `outcome`: of the newest step; null: there was none, and what was felt before stays. `t`: s.
void show_tool(const SessionInput& input, const ServedTools::Outcome* outcome, double t,
               SeenTool& seen) noexcept;
/// Positions, and what the tools put on the surface.
void show_organ(const Simulation& simulation, Picture& picture) noexcept;

}  // namespace palpate::sim
