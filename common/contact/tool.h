#pragma once

namespace palpate {

/// The rigid tip that touches: a sphere whose centre is the tool position.
struct SphereTool {
  double radius = 0.005;  ///< m, [1e-5, 0.05]
  double friction = 0;    ///< Coulomb's coefficient mu against the tissue, [0, 2]; 0 = slips freely
};

}  // namespace palpate
