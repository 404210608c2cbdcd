#pragma once
/// What the benchmarks share. A row shows, as its label, the hash of what it computes in a fixed sequence
/// before the clock runs: two builds that agree in it did the same work, however often they were timed.
#include <benchmark/benchmark.h>
#include <filesystem>
#include <fmt/core.h>
#include <fstream>
#include <iterator>
#include <string>

#include "common/error.h"
#include "common/hash.h"

namespace palpate::bench {

/// Each adds the rows of its file.
void add_law_rows();
void add_protocol_rows();
void add_latency_rows();
void add_capture_rows();
void add_finder_rows();
void add_server_rows();
void add_setup_rows();
void add_tensor_rows();
void add_removal_rows();
void add_implicit_rows();
void add_kernel_rows();
void add_cholesky_rows();
void add_race_rows();
void add_falcon_rows();
void add_viewer_rows();
void add_telemetry_rows();

/// Adds a row called `name`. `run` takes the state; an `Error` of it skips the row and says why.
template <class Run>
auto add(const std::string& name, Run run) {
  return benchmark::RegisterBenchmark(name.c_str(), [run](benchmark::State& state) mutable {
    try {
      run(state);
    } catch (const Error& e) {
      state.SkipWithError(e.what());
    }
  });
}

inline void show(benchmark::State& state, std::uint64_t hash) {
  state.SetLabel(fmt::format("{:016x}", hash));
}

/// Of the bytes of a file.
inline std::uint64_t hash_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  Fnv1a hash;
  hash.add(content.data(), content.size());
  return hash.value();
}

/// Times `work`, which goes on from call to call; its first `count` calls give the hash, untimed, of what it
/// returns (bytes that mean something in memory, such as a `Vec3`).
template <class Work>
void time_calls(benchmark::State& state, int count, Work work) {
  Fnv1a hash;
  for (int i = 0; i < count; ++i) {
    const auto result = work();
    hash.add(&result, sizeof(result));
  }
  show(state, hash.value());
  for (auto _ : state) {
    auto result = work();
    benchmark::DoNotOptimize(result);
  }
}

}  // namespace palpate::bench
