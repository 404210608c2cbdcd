#pragma once

namespace palpate {

/// The rigid tip that touches: a sphere whose centre is the tool position.
struct SphereTool {
  double radius = 0.005;  ///< m, [1e-5, 0.05]
};

}  // namespace palpate
