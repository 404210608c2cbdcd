#pragma once
#include <optional>
#include <vector>

#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// A press on linear elements, held against quadratic ones on the same mesh.
struct ElementTrial {
  double percent = 0;             ///< difference of both forces, of that of quadratic elements
  std::vector<VertexLoad> loads;  ///< on the linear elements
};

/// Presses with the first tool of a scene by 0.4 of its radius (`find_press`): tissue at rest, of the linear
/// law, on `mesh`, which has no vertices between corners. Nothing where quadratic elements have more than
/// 6000 nodes, the tissue can be cut, the tool holds it, or the contact has not settled. Set-up only: two
/// simulations, which take some seconds at most.
std::optional<ElementTrial> try_elements(const Scene& scene, const TetMesh& mesh);

}  // namespace palpate::sim
