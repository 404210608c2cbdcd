#include "sim_server/elasticity/element.h"

#include <Eigen/LU>

namespace palpate::sim {

LinearTetrahedron::LinearTetrahedron(const std::array<Vec3, 4>& corners) {
  Mat3 edges;  // column k: x_(k+1) - x_0
  for (int k = 0; k < 3; ++k) edges.col(k) = corners[k + 1] - corners[0];
  volume = edges.determinant() / 6;
  const Mat3 inverse = edges.inverse();  // row k: grad N_(k+1)
  gradient[0].setZero();
  for (int k = 0; k < 3; ++k) {
    gradient[k + 1] = inverse.row(k).transpose();
    gradient[0] -= gradient[k + 1];
  }
}

}  // namespace palpate::sim
