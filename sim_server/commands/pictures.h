#pragma once
#include <functional>

#include "sim_server/serving/served_tools.h"
#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// Returns the facts of a scene that the page gets before anything moves.
SceneFacts facts_of(const Scene& scene, const Simulation& simulation);

/// Returns the function that colours the surface of such a body by strain energy. Its values are J/m3 of each
/// surface vertex, the mean of the tetrahedra around it by their volume. Its data are made at its first call,
/// in that thread, and computed there alone: some 0.2 us a tetrahedron and quadrature point. All references
/// outlive the result.
std::function<void(std::span<const Vec3>, std::vector<float>&)> strain_energy_of(
    const Scene& scene, const Simulation& simulation);

/// Each fills in what a page is shown; no allocation, but for the triangles of an organ that is cut.
/// `outcome`: of the newest step; null: there was none, and the forces before stay. `t`: s.
void show_tool(const SessionInput& input, const ServedTools::Outcome* outcome, double t,
               SeenTool& seen) noexcept;
/// Positions, and what the tools put on the surface.
void show_organ(const Simulation& simulation, Picture& picture) noexcept;

}  // namespace palpate::sim
