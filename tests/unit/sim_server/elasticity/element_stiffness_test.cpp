#include <Eigen/LU>

#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"
#include "tests/support/stiffness.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

using ElementMatrix = Eigen::Matrix<double, 12, 12>;

std::array<Vec3, 4> random_corners(test::Random& random) {
  std::array<Vec3, 4> corners{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  for (Vec3& x : corners) x += random.vector(0.2);
  return corners;
}

/// Of a body of one tetrahedron.
ElementMatrix stiffness(const std::array<Vec3, 4>& corners, const Material& material) {
  TetMesh mesh;
  mesh.vertices.assign(corners.begin(), corners.end());
  mesh.tetrahedra = {{0, 1, 2, 3}};
  const Solid one(mesh, material);
  return test::dense_stiffness(one, FreeDofs(4, {}));
}

}  // namespace

TEST_CASE("element stiffness is V B^T D B with the engineering matrices of Zienkiewicz and Taylor") {
  test::Random random(5);
  const Material material{2e4, 0.3, 1000};
  const auto corners = random_corners(random);
  // Gradients by an independent route: rows 2..4 of the inverse of [1 x y z] give N_i = a + b x + c y + d z.
  Eigen::Matrix4d coordinates;
  for (int i = 0; i < 4; ++i) coordinates.row(i) << 1, corners[i].transpose();
  const Eigen::Matrix4d shape = coordinates.inverse();
  Eigen::Matrix<double, 6, 12> b = Eigen::Matrix<double, 6, 12>::Zero();
  for (int i = 0; i < 4; ++i) {
    const double x = shape(1, i), y = shape(2, i), z = shape(3, i);
    b.block<6, 3>(0, 3 * i) << x, 0, 0, 0, y, 0, 0, 0, z, y, x, 0, 0, z, y, z, 0, x;
  }
  const double e = material.young_modulus, nu = material.poisson_ratio;
  Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
  d.topLeftCorner<3, 3>().setConstant(nu);
  d.diagonal() << 1 - nu, 1 - nu, 1 - nu, (1 - 2 * nu) / 2, (1 - 2 * nu) / 2, (1 - 2 * nu) / 2;
  d *= e / ((1 + nu) * (1 - 2 * nu));
  const ElementMatrix expected = std::abs(coordinates.determinant()) / 6 * b.transpose() * d * b;
  CHECK((stiffness(corners, material) - expected).norm() < 1e-12 * expected.norm());
}

TEST_CASE("rigid motion gives no force, and only rigid motion does") {
  test::Random random(6);
  const auto corners = random_corners(random);
  const ElementMatrix k = stiffness(corners, {});
  for (int mode = 0; mode < 6; ++mode) {
    Eigen::Matrix<double, 12, 1> u;
    for (int i = 0; i < 4; ++i) {
      u.segment<3>(3 * i) = mode < 3 ? Vec3::Unit(mode) : Vec3(Vec3::Unit(mode - 3).cross(corners[i]));
    }
    CHECK((k * u).norm() < 1e-12 * k.norm());
  }
  const Eigen::VectorXd values = test::eigenvalues(k);
  CHECK(values[5] < 1e-10 * values[11]);
  CHECK(values[6] > 1e-4 * values[11]);
}
