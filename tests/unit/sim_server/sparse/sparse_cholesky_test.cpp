#include "sim_server/sparse/sparse_cholesky.h"

#ifdef PALPATE_WITH_TBB
#include <oneapi/tbb/global_control.h>
#endif

#include "common/error.h"
#include "sim_server/elasticity/solid.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// n on the diagonal, -0.5 elsewhere: positive definite, and its factor is full.
SparseMatrix full(int n) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Constant(n, n, -0.5);
  dense.diagonal().setConstant(n);
  return SparseMatrix(dense.triangularView<Eigen::Lower>().toDenseMatrix().sparseView());
}

using Precision = SparseCholesky::Precision;

/// Of a block of 0.12 x 0.12 x 0.12 m in `n` cells each way, held below.
StiffnessMatrix stiffness_of_block(int n, double poisson_ratio = 0.4) {
  const auto lines = test::lines(0, 0.12, n);
  const TetMesh mesh = grid_block(lines, lines, lines);
  std::vector<int> held;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].y() < 1e-9) held.push_back(static_cast<int>(v));
  }
  const Solid solid(mesh, {.young_modulus = 5e3, .poisson_ratio = poisson_ratio});
  StiffnessMatrix matrix = solid.stiffness_matrix(FreeDofs(solid.nodes(), held));
  solid.add_stiffness(solid.rest(), matrix);
  return matrix;
}

Eigen::VectorXd load_of(Eigen::Index n) {
  return Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::sin(static_cast<double>(i)); });
}

double imbalance(const SparseMatrix& a, const Eigen::MatrixXd& x) {
  const Eigen::VectorXd load = load_of(a.rows());
  return (load - a.selfadjointView<Eigen::Lower>() * x.col(0)).norm() / load.norm();
}

}  // namespace

TEST_CASE("a block of the inverse is that of the dense inverse, and symmetric to the last bit") {
  const StiffnessMatrix matrix = stiffness_of_block(7);
  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix.lower()).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd exact =
      test::solve_definite(dense, Eigen::MatrixXd::Identity(dense.rows(), dense.cols()));
  const SparseCholesky factor(matrix.lower(), "test");
  for (const int apart : {1, 3, 17, 500}) {  // all of it, and ever fewer rows, not in their order
    CAPTURE(apart);
    std::vector<int> unknowns;
    for (int k = 0; k < dense.rows(); k += apart) unknowns.push_back(static_cast<int>(dense.rows()) - 1 - k);
    const auto m = static_cast<Eigen::Index>(unknowns.size());
    Eigen::MatrixXd block(m, m);
    double last = -1;
    factor.inverse_block(unknowns, block, [&](double fraction) {
      CHECK(fraction > last);
      last = fraction;
    });
    CHECK(last >= 0);
    CHECK((block - exact(unknowns, unknowns)).cwiseAbs().maxCoeff() < 1e-11 * exact.cwiseAbs().maxCoeff());
    CHECK(block == block.transpose());
  }
}

namespace {

/// A factor that has no other way to rows of its inverse than the block of all of them.
class OnlyBlocks final : public FactoredMatrix {
 public:
  explicit OnlyBlocks(const SparseCholesky& factor) : factor_(factor) {}
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const override { return factor_.solve(b); }
  void inverse_block(std::span<const int> unknowns, Eigen::Ref<Eigen::MatrixXd> block,
                     const std::function<void(double)>& progress) const override {
    factor_.inverse_block(unknowns, block, progress);
  }

 private:
  const SparseCholesky& factor_;
};

/// The block of the inverse that its rows make up. Each pair of groups has to come once.
Eigen::MatrixXd from_rows(const FactoredMatrix& factor, std::span<const int> unknowns,
                          std::span<const int> begins) {
  const auto m = static_cast<Eigen::Index>(unknowns.size());
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(m, m);
  const auto take = [&](int group, std::span<const int> with, const Eigen::MatrixXd& rows) {
    const auto of = [&](int g) { return Eigen::seq(begins[g], begins[g + 1] - 1); };
    for (const int other : with) {  // writes what no other call does
      block(of(group), of(other)) += rows(Eigen::all, of(other));
      if (other != group) block(of(other), of(group)) += rows(Eigen::all, of(other)).transpose();
    }
  };
  double last = -1;
  factor.inverse_rows(unknowns, begins, take, [&](double fraction) {
    CHECK(fraction > last);
    last = fraction;
  });
  CHECK(last >= 0);
  return block;
}

}  // namespace

TEST_CASE(
    "rows of the inverse come group by group, each pair of groups once, as the dense inverse has them") {
  const StiffnessMatrix matrix = stiffness_of_block(7);
  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix.lower()).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd exact =
      test::solve_definite(dense, Eigen::MatrixXd::Identity(dense.rows(), dense.cols()));
  const SparseCholesky factor(matrix.lower(), "test"), single(matrix.lower(), "test", Precision::kSingle);
  std::vector<int> unknowns;  // not in their order, and not all
  for (int k = 0; k < dense.rows(); k += 2) unknowns.push_back((k * 577) % static_cast<int>(dense.rows()));
  const auto m = static_cast<int>(unknowns.size());
  const Eigen::MatrixXd wanted = exact(unknowns, unknowns);
  const double largest = wanted.cwiseAbs().maxCoeff();
  for (const std::vector<int>& begins : {std::vector{0, 1, 130, 131, m - 7, m}, std::vector{0, m}}) {
    const Eigen::MatrixXd found = from_rows(factor, unknowns, begins);
    CHECK((found - wanted).cwiseAbs().maxCoeff() < 1e-11 * largest);
    CHECK((from_rows(OnlyBlocks(factor), unknowns, begins) - wanted).cwiseAbs().maxCoeff() < 1e-11 * largest);
    CHECK((from_rows(single, unknowns, begins) - wanted).cwiseAbs().maxCoeff() < 1e-4 * largest);
#ifdef PALPATE_WITH_TBB
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    CHECK(from_rows(factor, unknowns, begins) == found);
#endif
  }
}

TEST_CASE("a factor answers as a dense one does") {
  const StiffnessMatrix matrix = stiffness_of_block(4);
  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix.lower()).selfadjointView<Eigen::Lower>();
  Eigen::MatrixXd loads = Eigen::MatrixXd::Identity(dense.rows(), 7);
  loads.col(3) = load_of(dense.rows());
  const Eigen::MatrixXd exact = test::solve_definite(dense, loads);
  const SparseCholesky factor(matrix.lower(), "test");
  CHECK((factor.solve(loads) - exact).norm() < 1e-12 * exact.norm());
  CHECK((factor.solve(loads.col(3)) - exact.col(3)).norm() < 1e-12 * exact.col(3).norm());
  const SparseCholesky single(matrix.lower(), "test", Precision::kSingle);
  CHECK((single.solve(loads) - exact).norm() < 1e-4 * exact.norm());
}

TEST_CASE("a stiffness matrix times many columns is what a dense one gives") {
  const StiffnessMatrix matrix = stiffness_of_block(3);
  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix.lower()).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd x = dense.leftCols(5);
  CHECK((matrix.times(x) - dense * x).norm() < 1e-14 * dense.squaredNorm());
}

TEST_CASE("a matrix without a zero, many panels wide, is solved as its closed form says") {
  // (n + 1/2) I - 1/2 1 1^T, whose inverse Sherman and Morrison give.
  for (const int n : {255, 258, 768, 1029}) {
    CAPTURE(n);
    const SparseMatrix matrix = full(n);
    const Eigen::VectorXd load = load_of(matrix.rows());
    const double d = n + 0.5;
    const Eigen::VectorXd exact = (load.array() + 0.5 * load.sum() / (d - 0.5 * n)).matrix() / d;
    for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
      const Eigen::MatrixXd found = SparseCholesky(matrix, "test", precision).solve(load);
      CHECK((found - exact).norm() < (precision == Precision::kDouble ? 1e-13 : 1e-5) * exact.norm());
    }
  }
}

TEST_CASE("a matrix that is not positive definite leaves a factor in single precision there") {
  StiffnessMatrix matrix = stiffness_of_block(4);
  SparseCholesky factor(matrix.lower(), "test", Precision::kSingle);
  const Precision before = factor.precision();
  for (int i = 0; i < 2; ++i) {
    matrix.lower() *= -1;
    CHECK_FALSE(factor.refactor(matrix.lower()));
    CHECK(factor.precision() == before);
    CHECK(factor.solve(load_of(matrix.lower().rows())).hasNaN());
    matrix.lower() *= -1;
    CHECK(factor.refactor(matrix.lower()));
    CHECK(factor.precision() == before);
  }
}

TEST_CASE("a factor is made again of other numbers") {
  for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
    StiffnessMatrix matrix = stiffness_of_block(6);
    SparseCholesky factor(matrix.lower(), "test", precision);
    const Eigen::VectorXd before = factor.solve(load_of(matrix.lower().rows()));
    matrix.lower() *= 4;
    REQUIRE(factor.refactor(matrix.lower()));
    CHECK((4 * factor.solve(load_of(before.size())) - before).norm() < 1e-5 * before.norm());
    matrix.lower() *= -1;
    CHECK(!factor.refactor(matrix.lower()));
    matrix.lower() *= -1;
    CHECK(factor.refactor(matrix.lower()));
    CHECK((4 * factor.solve(load_of(before.size())) - before).norm() < 1e-5 * before.norm());
  }
}

TEST_CASE("where single precision is too little a factor takes double") {
  const StiffnessMatrix matrix = stiffness_of_block(8, 0.499999);
  const SparseCholesky factor(matrix.lower(), "test", Precision::kSingle);
  CHECK(imbalance(matrix.lower(), factor.solve(load_of(matrix.lower().rows()))) < 1e-6);
}

TEST_CASE("a factor of many subtrees and bands has the same bytes on one core as on two") {
  const StiffnessMatrix matrix = stiffness_of_block(14);
  for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
    const auto answer = [&](std::size_t threads) {
#ifdef PALPATE_WITH_TBB
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
#else
      static_cast<void>(threads);
#endif
      return SparseCholesky(matrix.lower(), "test", precision).solve(load_of(matrix.lower().rows()));
    };
    const Eigen::MatrixXd one = answer(1), two = answer(2);
    CHECK((one.array() == two.array()).all());
    CHECK(imbalance(matrix.lower(), one) < (precision == Precision::kSingle ? 1e-4 : 1e-11));
  }
}

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
  CHECK_NOTHROW(SparseCholesky(matrix, "test", SparseCholesky::Precision::kDouble, 3 * bytes));
  try {
    const SparseCholesky factor(matrix, "scene.toml", SparseCholesky::Precision::kDouble,
                                bytes);  // and nothing to make it in
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.exit_code() == 2);
    const std::string said = error.what();
    CHECK(said.find("scene.toml: the Cholesky factor of 60 unknowns would take 0.0") == 0);
    CHECK(said.find(" MB, and " + bytes_text(bytes) + " are free; take a coarser mesh") != std::string::npos);
  }
}

TEST_CASE("a factor of nothing answers nothing") {
  SparseCholesky factor(SparseMatrix(0, 0), "test");
  CHECK(factor.solve(Eigen::MatrixXd(0, 3)).size() == 0);
  CHECK(factor.refactor(SparseMatrix(0, 0)));
}

TEST_CASE("double precision that does not fit is refused, too") {
  const StiffnessMatrix matrix = stiffness_of_block(8, 0.499999);
  const auto bytes = static_cast<double>(SparseCholesky(matrix.lower(), "test").bytes());
  CHECK_THROWS_AS(SparseCholesky(matrix.lower(), "test", Precision::kSingle, 0.8 * bytes), Error);
}
