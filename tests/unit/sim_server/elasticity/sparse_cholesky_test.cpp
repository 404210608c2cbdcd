#include "sim_server/elasticity/sparse_cholesky.h"

#include "common/error.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// n on the diagonal, -0.5 elsewhere: positive definite, and its factor is full.
SparseMatrix full(int n) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Constant(n, n, -0.5);
  dense.diagonal().setConstant(n);
  return SparseMatrix(dense.triangularView<Eigen::Lower>().toDenseMatrix().sparseView());
}

}  // namespace

TEST_CASE("a factor tells its bytes") {
  const SparseCholesky factor(full(60), "test");
  CHECK(factor.bytes() >= 60 * 61 / 2 * sizeof(double));  // the lower triangle
  CHECK(factor.bytes() <= 60 * 60 * (sizeof(double) + sizeof(int)) + 60 * 16);
  const SparseCholesky twice(full(120), "test");
  CHECK(static_cast<double>(twice.bytes()) / static_cast<double>(factor.bytes()) == Approx(4).epsilon(0.1));
}

TEST_CASE("a factor that does not fit is refused before it is made") {
  const SparseMatrix matrix = full(60);
  const auto bytes = static_cast<double>(SparseCholesky(matrix, "test").bytes());
  CHECK_NOTHROW(SparseCholesky(matrix, "test", 3 * bytes));
  try {
    const SparseCholesky factor(matrix, "scene.toml", bytes);  // and nothing to make it in
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.exit_code() == 2);
    const std::string said = error.what();
    CHECK(said.find("scene.toml: the Cholesky factor of 60 unknowns would take 0.0") == 0);
    CHECK(said.find(" MB, and " + bytes_text(bytes) + " are free; take a coarser mesh") != std::string::npos);
  }
}
