#pragma once
#include <string>
#include <vector>

#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// A press on linear elements, held against quadratic ones on the same mesh.
struct ElementTrial {
  double percent = 0;             ///< difference of both forces, of that of quadratic elements
  std::vector<VertexLoad> loads;  ///< on the linear elements
};

/// Presses on both kinds of elements.
struct ElementTrials {
  std::vector<ElementTrial> presses;
  std::string why_none;  ///< the reason and the remedy, for a user; empty where there are presses
};

/// Presses with the first tool of a scene by 0.4 of its radius, in the middle of its reach and where the
/// surface yields most, a quarter of the reach apart or across: the middle of a sheet, the end of a beam, two
/// ways. Tissue at rest, of the linear law, on `mesh`, which has no vertices between corners. Leaves out
/// presses that have not settled, and places from where on the tool would reach more than 300 vertices in
/// all. None where the elements of the scene are not linear, quadratic elements have more than 6000 nodes,
/// the tissue can be cut or floats, the tool reaches nothing, or holds tissue. Set-up only: two simulations,
/// about a second at most.
ElementTrials try_elements(const Scene& scene, const TetMesh& mesh);

}  // namespace palpate::sim
