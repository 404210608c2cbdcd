#include "common/contact/dense_solve.h"

#include <Eigen/LU>

#include "tests/support/catch.h"

using namespace palpate;

TEST_CASE(
    "dense solve: solution and sign of the determinant as Eigen has them, also of indefinite matrices") {
  std::srand(7);
  for (int n = 1; n <= 12; ++n) {
    for (int round = 0; round < 8; ++round) {
      const Eigen::MatrixXd a = Eigen::MatrixXd::Random(n, n), b = Eigen::MatrixXd::Random(n, 2);
      Eigen::MatrixXd scratch = a, x = b;
      const int sign = gauss_solve(scratch, x);
      CAPTURE(n, round);
      CHECK(sign == (a.determinant() > 0 ? 1 : -1));
      CHECK((a * x - b).norm() < 1e-9 * (1 + x.norm()));
    }
  }
  Eigen::MatrixXd singular = Eigen::MatrixXd::Zero(3, 3), x = Eigen::MatrixXd::Ones(3, 1);
  CHECK(gauss_solve(singular, x) == 0);
}
