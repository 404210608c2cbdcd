// What we wrote ourselves beside what a library has for it, on the same numbers: rotations, dense systems and
// matrices of low rank beside Eigen, the complementarity problem beside Open Dynamics Engine's solver
// (Dantzig's method), where that is installed (on Debian: libdart-external-odelcpsolver-dev). A row whose
// answer is not ours says so in place of a time.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#ifdef PALPATE_WITH_ODE_LCP
#include <dart/external/odelcpsolver/lcp.h>
#endif

#include "common/contact/complementarity.h"
#include "common/contact/dense_solve.h"
#include "sim_server/elasticity/rotations.h"
#include "sim_server/low_rank/low_rank_factors.h"
#include "tests/bench/bench.h"
#include "tests/support/random.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr int kMatrices = 1000;
constexpr int kProblems = 50;    // of one size, each with other gaps
constexpr double kAgree = 1e-7;  // of the largest number of an answer

using Numbers = Eigen::Ref<const Eigen::MatrixXd>;

/// Times `work`, which overwrites `answer` by what is to be as `expected`; its label is the hash of that.
template <class Work>
void time_answers(benchmark::State& state, const Numbers& answer, const Numbers& expected, Work work) {
  work();
  if (!((answer - expected).cwiseAbs().maxCoeff() <= kAgree * expected.cwiseAbs().maxCoeff()))
    return state.SkipWithError("not the answer of ours");
  Fnv1a hash;
  hash.add(answer.data(), sizeof(double) * static_cast<std::size_t>(answer.size()));
  show(state, hash.value());
  for (auto _ : state) {
    work();
    benchmark::ClobberMemory();
  }
}

using Rotate = void (*)(std::span<const Mat3>, std::span<Mat3>);

void rotate_by_singular_values(std::span<const Mat3> F, std::span<Mat3> R) {
  for (std::size_t i = 0; i < F.size(); ++i) {
    const Eigen::JacobiSVD<Mat3> svd(F[i], Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vec3 signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
    R[i] = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  }
}

/// R = F (F^T F)^-1/2 by Eigen's closed form of eigenvalues; of no use where F is turned inside out.
void rotate_by_eigenvalues(std::span<const Mat3> F, std::span<Mat3> R) {
  for (std::size_t i = 0; i < F.size(); ++i) {
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.computeDirect(F[i].transpose() * F[i]);
    R[i] = F[i] * eigen.operatorInverseSqrt();
  }
}

/// Rotations of tissue whose strains are up to about `strain`.
void run_rotations(benchmark::State& state, double strain, Rotate rotate) {
  test::Random random(1);
  std::vector<Mat3> F, R(kMatrices), ours(kMatrices);
  for (int i = 0; i < kMatrices; ++i) {
    Mat3 stretch = Mat3::Identity();
    for (int column = 0; column < 3; ++column) stretch.col(column) += random.vector(strain);
    F.push_back(Eigen::AngleAxisd(random.between(0, 3), random.vector(1).normalized()) * stretch);
  }
  nearest_rotations(F, ours);
  const auto entries = [](const std::vector<Mat3>& all) {
    return Eigen::Map<const Eigen::MatrixXd>(all[0].data(), 9, kMatrices);
  };
  time_answers(state, entries(R), entries(ours), [&] { rotate(F, R); });
}

/// Contacts along a line, 2 mm apart, on something that gives way where it is pressed and near it; their
/// gaps, a column for each problem: about half of the contacts touch.
struct ContactProblems {
  explicit ContactProblems(int n) : compliance(n, n), gaps(n, kProblems), forces(n, kProblems) {
    test::Random random(2);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k)
        compliance(i, k) = 3e-3 * std::exp(-std::abs(i - k) * 0.002 / 0.005);  // m/N
    }
    compliance.diagonal().array() += 1e-9;
    for (Eigen::Index i = 0; i < gaps.size(); ++i) gaps.data()[i] = random.between(-1e-3, 5e-4);
  }
  Eigen::MatrixXd compliance, gaps, forces;
};

void solve_by_ours(ContactProblems& problems, ComplementaritySolver& solver) {
  for (Eigen::Index i = 0; i < problems.gaps.cols(); ++i)
    solver.solve(problems.compliance, problems.gaps.col(i), problems.forces.col(i));
}

#ifdef PALPATE_WITH_ODE_LCP
/// Its solver overwrites what it is given, rows of a multiple of four numbers.
struct OdeProblem {
  explicit OdeProblem(int n)
      : matrix(dPAD(n), n),
        gap(n),
        slack(n),
        low(Eigen::VectorXd::Zero(n)),
        high(Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity())) {}
  void solve(const ContactProblems& problems, Eigen::Index i, Eigen::Ref<Eigen::VectorXd> force) {
    const auto n = static_cast<int>(gap.size());
    matrix.topRows(n) = problems.compliance;
    gap = -problems.gaps.col(i);
    dart::external::ode::dSolveLCP(n, matrix.data(), force.data(), gap.data(), slack.data(), 0, low.data(),
                                   high.data(), nullptr);
  }
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gap, slack, low, high;
};
#endif

void add_complementarity_rows(int n) {
  const std::string name = fmt::format("complementarity/{}", n);
  add(name + "/ours", [n](benchmark::State& state) {
    ContactProblems problems(n);
    ComplementaritySolver solver(n);
    solve_by_ours(problems, solver);
    time_answers(state, problems.forces, Eigen::MatrixXd(problems.forces),
                 [&] { solve_by_ours(problems, solver); });
  });
#ifdef PALPATE_WITH_ODE_LCP
  add(name + "/ode_dantzig", [n](benchmark::State& state) {
    ContactProblems problems(n);
    ComplementaritySolver solver(n);
    OdeProblem ode(n);
    solve_by_ours(problems, solver);
    const Eigen::MatrixXd expected = problems.forces;
    time_answers(state, problems.forces, expected, [&] {
      for (Eigen::Index i = 0; i < problems.gaps.cols(); ++i) ode.solve(problems, i, problems.forces.col(i));
    });
  });
#endif
}

/// A system of a Newton step with friction, say, for three right-hand sides.
void run_dense(benchmark::State& state, int n, bool ours) {
  test::Random random(3);
  Eigen::MatrixXd matrix(n, n), loads(n, 3);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] = random.between(-1, 1);
  for (Eigen::Index i = 0; i < loads.size(); ++i) loads.data()[i] = random.between(-1, 1);
  matrix.diagonal().array() += 2;
  Eigen::MatrixXd scratch(n, n), answer(n, 3), expected = loads;
  scratch = matrix;
  gauss_solve(scratch, expected);
  time_answers(state, answer, expected, [&] {
    scratch = matrix;
    answer = loads;
    if (ours) {
      gauss_solve(scratch, answer);
    } else {
      Eigen::Ref<Eigen::MatrixXd> in_place(scratch);
      answer = Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>>(in_place).solve(loads);
    }
  });
}

/// The whole singular value decomposition, of which no more is kept than the tolerance needs.
LowRankFactors factors_by_singular_values(const Eigen::MatrixXd& matrix, double tolerance) {
  const Eigen::BDCSVD<Eigen::MatrixXf> svd(matrix.cast<float>(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXf& values = svd.singularValues();
  Eigen::Index rank = values.size();
  while (rank > 0 && double{values.tail(values.size() - rank + 1).norm()} <= tolerance) --rank;
  return {values.head(rank).asDiagonal() * svd.matrixU().leftCols(rank).transpose(),
          svd.matrixV().leftCols(rank).transpose()};
}

/// How points of one cube answer to loads on those of another, twice its edge away, as 1 / distance, to 1e-4.
/// The label is the rank that was found.
void run_low_rank(benchmark::State& state, int n, bool ours) {
  test::Random random(11);
  const auto points = [&](double from) {
    Eigen::Matrix3Xd all(3, n);
    for (Eigen::Index i = 0; i < all.size(); ++i) all.data()[i] = random.between(0, 1);
    all.row(0).array() += from;
    return all;
  };
  const Eigen::Matrix3Xd at_tool = points(0), there = points(2);
  Eigen::MatrixXd matrix(n, n);
  for (int i = 0; i < n; ++i)
    matrix.col(i) = (at_tool.colwise() - there.col(i)).colwise().norm().cwiseInverse();
  const double tolerance = 1e-4 * matrix.norm();
  LowRankFactors found;
  const auto work = [&] {
    found = ours ? *low_rank_factors(matrix, tolerance) : factors_by_singular_values(matrix, tolerance);
  };
  work();
  const Eigen::MatrixXd made = (found.left.transpose() * found.right).cast<double>();
  if (!((made - matrix).norm() <= 1.01 * tolerance))
    return state.SkipWithError("farther from the matrix than asked for");
  show(state, static_cast<std::uint64_t>(found.left.rows()));
  for (auto _ : state) {
    work();
    benchmark::ClobberMemory();
  }
}

}  // namespace

void add_kernel_rows() {
  const std::pair<std::string_view, Rotate> ways[] = {
      {"ours", [](std::span<const Mat3> F, std::span<Mat3> R) { nearest_rotations(F, R); }},
      {"eigen_svd", rotate_by_singular_values},
      {"eigen_eigenvalues", rotate_by_eigenvalues}};
  for (const double strain : {0.01, 0.3}) {
    for (const auto& [whose, rotate] : ways) {
      add(fmt::format("rotations/strain_{}/{}", strain, whose),
          [strain, rotate](benchmark::State& state) { run_rotations(state, strain, rotate); });
    }
  }
  for (const int n : {3, 12, 40}) add_complementarity_rows(n);
  for (const int n : {9, 36, 120}) {
    add(fmt::format("dense_system/{}/ours", n), [n](benchmark::State& state) { run_dense(state, n, true); });
    add(fmt::format("dense_system/{}/eigen", n),
        [n](benchmark::State& state) { run_dense(state, n, false); });
  }
  for (const int n : {64, 192}) {
    add(fmt::format("low_rank/{}/ours", n), [n](benchmark::State& state) { run_low_rank(state, n, true); });
    add(fmt::format("low_rank/{}/eigen", n), [n](benchmark::State& state) { run_low_rank(state, n, false); });
  }
}

}  // namespace palpate::bench
