#pragma once
#include "sim_server/elasticity/solid.h"

namespace palpate::test {

/// The stiffness (N/m) of a body at rest over its free displacements, dense and both triangles.
inline Eigen::MatrixXd dense_stiffness(const sim::Solid& solid, const sim::FreeDofs& dofs) {
  sim::StiffnessMatrix k = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), k);
  const Eigen::MatrixXd lower = k.lower();
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace palpate::test
