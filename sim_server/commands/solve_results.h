#pragma once
/// Results that `sim_server solve` writes of a solution.
#include <filesystem>
#include <string>
#include <vector>

#include "sim_server/elasticity/solid.h"
#include "sim_server/scene/loads.h"

namespace palpate::sim {

/// A body where it was found.
struct Outcome {
  std::vector<Vec3> x;           ///< (nodes) m
  std::vector<Vec3> resistance;  ///< (nodes) N: what each does against being there
  double stress_scale = 1;       ///< of the stress of now, with `memory`: see `Viscosity`
  std::vector<Mat3> memory{};
  Viscosity viscosity() const { return {stress_scale, memory}; }
};

/// A place in the body at rest and how it follows the nodes.
struct Probe {
  std::string text;
  Vec3 place;
  std::vector<std::pair<int, double>> nodes;
};

/// "x,y,z", m, in the tetrahedron that holds the place. Throws `Error` where none does, with the nearest of
/// the `corners`, which come first among the nodes.
Probe find_probe(const std::string& text, const Solid& solid, int corners);

/// Nodes and axes that a [[fixed]] or a [[load]] with `displacement` holds, and no later one does.
struct HeldRegion {
  std::string name;                               ///< with "FILE:LINE"
  std::vector<std::pair<int, HeldAxes>> nodes{};  ///< each with the axes along which this holds it
};
std::vector<HeldRegion> held_regions(const Scene& scene, const TetMesh& mesh);

/// The body as it stands (.vtu), and what it bears and how it swells: means over each tetrahedron.
void write_outcome(const std::filesystem::path& file, const Solid& solid, const Outcome& outcome);

/// Energy, forces of the supports, all and each, the largest displacement, and the probes, to 9 digits.
/// Warns where tetrahedra are inside out, beginning with `where`.
void print_outcome(const std::string& where, const Solid& solid, const Loads& loads,
                   const std::vector<HeldRegion>& regions, const Outcome& outcome,
                   const std::vector<Probe>& probes);

}  // namespace palpate::sim
