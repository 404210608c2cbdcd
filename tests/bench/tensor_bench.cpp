// A sub-step of `tensor_mass` on blocks of 3 to 300 thousand tetrahedra, for one motion and for eight at once
// (as set-up does), and how long it takes only to read as many bytes as its tensors have: what no sub-step
// can be quicker than. `stream/memory` reads from beyond the caches. And the product alone, beside Eigen's
// with the same matrix in the same order: all of it by rows, or its lower triangle.
#include <map>

#include "sim_server/elasticity/solid.h"
#include "sim_server/explicit/explicit_motion.h"
#include "sim_server/mesh/shapes.h"
#include "tests/bench/bench.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr double kSubStep = 1e-5;                // s: stable on all of them
constexpr std::size_t kMemory = 256 << 20;       // bytes
constexpr std::array kCells{8, 12, 17, 26, 37};  // along each edge of the block; six tetrahedra each

/// A cube of 0.1 m, held at one side.
struct Block {
  explicit Block(int cells) {
    std::vector<double> lines;
    for (int i = 0; i <= cells; ++i) lines.push_back(0.1 * i / cells);
    mesh = grid_block(lines, lines, lines);
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
      if (mesh.vertices[v][1] == 0) fixed.push_back(v);
    }
  }
  ElasticTensors tensors() const { return {mesh, material, fixed}; }
  /// Both triangles, unknowns in the order of the tensors.
  SparseMatrix matrix(const std::vector<int>& places) const {
    const Solid solid(mesh, material);
    const FreeDofs dofs(solid.nodes(), fixed);
    StiffnessMatrix stiffness = solid.stiffness_matrix(dofs);
    solid.add_stiffness(solid.rest(), stiffness);
    Eigen::PermutationMatrix<Eigen::Dynamic> order(dofs.count);
    for (std::size_t v = 0; v < places.size(); ++v) {
      for (int axis = 0; places[v] >= 0 && axis < 3; ++axis)
        order.indices()[dofs.first[v] + axis] = 3 * places[v] + axis;
    }
    SparseMatrix all;
    all = stiffness.lower().selfadjointView<Eigen::Lower>().twistedBy(order);
    return all;
  }
  Material material{.young_modulus = 5e3, .poisson_ratio = 0.45};
  TetMesh mesh;
  std::vector<int> fixed;
};

/// Built when a row first needs it.
const ElasticTensors& tensors_of(int cells) {
  static std::map<int, ElasticTensors> built;
  const auto found = built.find(cells);
  return found != built.end() ? found->second : built.emplace(cells, Block(cells).tensors()).first->second;
}

void count_bytes(benchmark::State& state, std::size_t bytes) {
  state.counters["reads"] =
      benchmark::Counter(1e-9 * static_cast<double>(bytes), benchmark::Counter::kIsIterationInvariantRate);
}

void run_sub_steps(benchmark::State& state, int cells, int columns) {
  const ElasticTensors& tensors = tensors_of(cells);
  ExplicitMotion motion(tensors, {10, 1e-4}, columns);
  const std::vector<double> none = motion.state.f;
  for (std::size_t k = 0; k < none.size(); ++k) motion.state.u[k] = 1e-6 * static_cast<double>(k % 7);
  time_calls(state, 10, [&] {
    motion.run(1, kSubStep, none);
    return motion.state.u[none.size() / 2];
  });
  count_bytes(state, tensors.bytes());
}

void run_stream(benchmark::State& state, std::size_t bytes) {
  constexpr std::size_t kSums = 16;  // independent ones, so that no sum waits for another
  const std::vector<double> numbers(bytes / sizeof(double), 1);
  time_calls(state, 1, [&] {
    std::array<double, kSums> sums{};
    for (std::size_t i = 0; i + kSums <= numbers.size(); i += kSums) {
      for (std::size_t k = 0; k < kSums; ++k) sums[k] += numbers[i + k];
    }
    return sums;
  });
  count_bytes(state, bytes);
}

/// Columns side by side, as `multiply_wide` has them.
template <int kColumns>
using Vectors =
    Eigen::Matrix<double, Eigen::Dynamic, kColumns, kColumns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

/// Times y = K x by `multiply(x, y)`, which is to give what the tensors give.
template <int kColumns, class Multiply>
void time_products(benchmark::State& state, const ElasticTensors& tensors, Multiply multiply) {
  using Wide = Vectors<kColumns>;
  const Wide x = Wide::NullaryExpr(3 * tensors.vertices(), kColumns, [](Eigen::Index i, Eigen::Index j) {
    return 1e-6 * static_cast<double>((i + 5 * j) % 7);
  });
  Wide y(x.rows(), kColumns), ours(x.rows(), kColumns);
  kColumns == 1 ? tensors.multiply(x.data(), ours.data()) : tensors.multiply_wide(x.data(), ours.data());
  multiply(x, y);
  if (!((y - ours).norm() < 1e-12 * ours.norm())) return state.SkipWithError("not the product of ours");
  Fnv1a hash;
  hash.add(y.data(), sizeof(double) * static_cast<std::size_t>(y.size()));
  show(state, hash.value());
  for (auto _ : state) {
    multiply(x, y);
    benchmark::ClobberMemory();
  }
}

template <int kColumns>
void add_products(const std::string& name, int cells) {
  using Wide = Vectors<kColumns>;
  add(name + "/ours", [cells](benchmark::State& state) {
    const ElasticTensors& tensors = tensors_of(cells);
    time_products<kColumns>(state, tensors, [&](const Wide& x, Wide& y) {
      kColumns == 1 ? tensors.multiply(x.data(), y.data()) : tensors.multiply_wide(x.data(), y.data());
    });
  });
  add(name + "/eigen", [cells](benchmark::State& state) {
    const ElasticTensors& tensors = tensors_of(cells);
    const Eigen::SparseMatrix<double, Eigen::RowMajor> all = Block(cells).matrix(tensors.places());
    time_products<kColumns>(state, tensors, [&](const Wide& x, Wide& y) { y.noalias() = all * x; });
  });
  add(name + "/eigen_triangle", [cells](benchmark::State& state) {
    const ElasticTensors& tensors = tensors_of(cells);
    const SparseMatrix lower = Block(cells).matrix(tensors.places()).triangularView<Eigen::Lower>();
    time_products<kColumns>(state, tensors, [&](const Wide& x, Wide& y) {
      y.noalias() = lower.selfadjointView<Eigen::Lower>() * x;
    });
  });
}

}  // namespace

void add_tensor_rows() {
  for (const int cells : kCells) {
    const std::string size = fmt::format("{}k", (6 * cells * cells * cells + 500) / 1000);
    add("sub_step/" + size, [cells](benchmark::State& state) { run_sub_steps(state, cells, 1); });
    add("sub_step_of_8/" + size,
        [cells](benchmark::State& state) { run_sub_steps(state, cells, ElasticTensors::kWide); });
    add("stream/" + size, [cells](benchmark::State& state) { run_stream(state, tensors_of(cells).bytes()); });
  }
  for (const int cells : {8, 17, 26}) {
    const std::string size = fmt::format("{}k", (6 * cells * cells * cells + 500) / 1000);
    add_products<1>("tensors/" + size, cells);
    add_products<ElasticTensors::kWide>("tensors_of_8/" + size, cells);
  }
  add("stream/memory", [](benchmark::State& state) { run_stream(state, kMemory); });
}

}  // namespace palpate::bench
