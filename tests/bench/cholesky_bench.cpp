// The sparse Cholesky factor of a block's stiffness, its numbers and its solves: ours in double and in single
// precision, and CHOLMOD's own supernodal one, as Eigen calls it. The patterns are found before, untimed.
// Factors have all cores, ours by oneTBB over supernodes, CHOLMOD's by OpenBLAS inside each product, which
// costs more than it gains where products are small: hence CHOLMOD's on one core, too.
#include <cmath>
#include <map>
#include <thread>

#ifdef PALPATE_WITH_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include "common/clock.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/sparse/sparse_cholesky.h"
#include "tests/bench/bench.h"
#include "tests/support/solids.h"

// Present in every OpenBLAS, absent from other BLAS libraries: hence weak; likewise OpenMP's.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));
extern "C" void omp_set_dynamic(int on) __attribute__((weak));

namespace palpate::bench {
using namespace sim;

namespace {

constexpr std::array kCells{8, 20};  // along each edge of the block; six tetrahedra each
constexpr int kLoads = 48;           // columns at once, as set-up has them
using Precision = SparseCholesky::Precision;

/// What BLAS may take. CHOLMOD's loops of OpenMP ask for four threads, however many cores there are, which
/// makes it several times slower on two: they are to take no more than are idle.
void take_threads(unsigned threads) {
  if (omp_set_dynamic != nullptr) omp_set_dynamic(1);
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(static_cast<int>(threads));
}

/// A cube of 0.1 m, held at one side.
SparseMatrix stiffness_of_block(int cells) {
  const auto lines = test::lines(0, 0.1, cells);
  const Solid solid(grid_block(lines, lines, lines), {.young_modulus = 5e3, .poisson_ratio = 0.45});
  std::vector<int> held;
  for (int v = 0; v < solid.nodes(); ++v) {
    if (solid.rest()[v][1] == 0) held.push_back(v);
  }
  StiffnessMatrix matrix = solid.stiffness_matrix(FreeDofs(solid.nodes(), held));
  solid.add_stiffness(solid.rest(), matrix);
  return matrix.lower();
}

/// Built when a row first needs it.
const SparseMatrix& stiffness(int cells) {
  static std::map<int, SparseMatrix> built;
  const auto found = built.find(cells);
  return found != built.end() ? found->second : built.emplace(cells, stiffness_of_block(cells)).first->second;
}

Eigen::MatrixXd loads(Eigen::Index n, int columns) {
  return Eigen::MatrixXd::NullaryExpr(
      n, columns, [](Eigen::Index i, Eigen::Index j) { return std::sin(static_cast<double>(i + 17 * j)); });
}

#ifdef PALPATE_WITH_CHOLMOD
/// As `SparseCholesky` has it.
class CholmodFactor {
 public:
  explicit CholmodFactor(const SparseMatrix& lower) {
    llt_.analyzePattern(lower);
    refactor(lower);
  }
  void refactor(const SparseMatrix& lower) { llt_.factorize(lower); }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const { return llt_.solve(b); }

 private:
  Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> llt_;
};
#endif

/// The clock on the wall, as all cores work.
template <class Work>
void time_work(benchmark::State& state, Work work) {
  for (auto _ : state) {
    const Time begin = now();
    work();
    state.SetIterationTime(to_seconds(now() - begin));
  }
}

/// Adds the rows of one kind of factor. `make` makes it, `threads` are what BLAS may take then.
template <class Make>
void add_factor(const std::string& name, std::string_view whose, int cells, unsigned threads, Make make) {
  const auto row = [&](std::string_view what) { return fmt::format("{}/{}/{}", name, what, whose); };
  add(row("factor"), [cells, threads, make](benchmark::State& state) {
    const SparseMatrix& matrix = stiffness(cells);
    auto factor = make(matrix);
    take_threads(threads);
    time_work(state, [&] { factor.refactor(matrix); });
    Fnv1a hash;
    const Eigen::MatrixXd answer = factor.solve(loads(matrix.rows(), 1));
    hash.add(answer.data(), sizeof(double) * static_cast<std::size_t>(answer.size()));
    show(state, hash.value());
  })->UseManualTime();
  for (const int columns : {1, kLoads}) {
    add(row(fmt::format("solve_of_{}", columns)), [cells, threads, make, columns](benchmark::State& state) {
      const SparseMatrix& matrix = stiffness(cells);
      const auto factor = make(matrix);
      take_threads(threads);
      const Eigen::MatrixXd load = loads(matrix.rows(), columns);
      time_work(state, [&] { benchmark::DoNotOptimize(factor.solve(load).sum()); });
      const Eigen::MatrixXd answer = factor.solve(load);
      const double remaining = (load - matrix.selfadjointView<Eigen::Lower>() * answer).norm() / load.norm();
      Fnv1a hash;
      hash.add(answer.data(), sizeof(double) * static_cast<std::size_t>(answer.size()));
      show(state, hash.value());
      state.counters["error"] = 100 * remaining;
    })->UseManualTime();
  }
}

}  // namespace

void add_cholesky_rows() {
  for (const int cells : kCells) {
    const std::string name = fmt::format("cholesky/{}k", (6 * cells * cells * cells + 500) / 1000);
    const auto ours = [](Precision precision) {
      return [precision](const SparseMatrix& matrix) { return SparseCholesky(matrix, "bench", precision); };
    };
    add_factor(name, "ours", cells, 1, ours(Precision::kDouble));
    add_factor(name, "ours_single", cells, 1, ours(Precision::kSingle));
#ifdef PALPATE_WITH_CHOLMOD
    const auto cholmod = [](const SparseMatrix& matrix) { return CholmodFactor(matrix); };
    add_factor(name, "cholmod", cells, std::thread::hardware_concurrency(), cholmod);
    add_factor(name, "cholmod_on_1_core", cells, 1, cholmod);
#endif
  }
}

}  // namespace palpate::bench
