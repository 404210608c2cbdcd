// A sub-step of `tensor_mass` on blocks of 3 to 300 thousand tetrahedra, for one motion and for eight at once
// (as set-up does), and how long it takes only to read as many bytes as its tensors have: what no sub-step
// can be quicker than. `stream/memory` reads from beyond the caches.
#include <map>

#include "sim_server/deformation/explicit_motion.h"
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
  explicit Block(int cells) : tensors(make(cells)) {}
  static ElasticTensors make(int cells) {
    std::vector<double> lines;
    for (int i = 0; i <= cells; ++i) lines.push_back(0.1 * i / cells);
    const TetMesh mesh = grid_block(lines, lines, lines);
    std::vector<int> fixed;
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
      if (mesh.vertices[v][1] == 0) fixed.push_back(v);
    }
    return {mesh, {.young_modulus = 5e3, .poisson_ratio = 0.45}, fixed};
  }
  ElasticTensors tensors;
};

/// Built when a row first needs it.
const ElasticTensors& tensors_of(int cells) {
  static std::map<int, Block> built;
  return built.try_emplace(cells, cells).first->second.tensors;
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

}  // namespace

void add_tensor_rows() {
  for (const int cells : kCells) {
    const std::string size = fmt::format("{}k", (6 * cells * cells * cells + 500) / 1000);
    add("sub_step/" + size, [cells](benchmark::State& state) { run_sub_steps(state, cells, 1); });
    add("sub_step_of_8/" + size,
        [cells](benchmark::State& state) { run_sub_steps(state, cells, ElasticTensors::kWide); });
    add("stream/" + size, [cells](benchmark::State& state) { run_stream(state, tensors_of(cells).bytes()); });
  }
  add("stream/memory", [](benchmark::State& state) { run_stream(state, kMemory); });
}

}  // namespace palpate::bench
