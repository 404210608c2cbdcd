#include <cstdio>

#include "common/fast_blas.h"
#include "tests/bench/bench.h"

int main(int argc, char** argv) {
  using namespace palpate;
  using namespace palpate::bench;
  start_with_fast_blas(argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    add_law_rows();
    add_protocol_rows();
    add_latency_rows();
    add_capture_rows();
    add_finder_rows();
    add_server_rows();
    add_setup_rows();
    add_tensor_rows();
    add_removal_rows();
    add_implicit_rows();
    add_kernel_rows();
    add_telemetry_rows();
    add_race_rows();
    add_cholesky_rows();
#ifdef PALPATE_WITH_VIEWER
    add_viewer_rows();
#endif
#ifdef PALPATE_WITH_USB
    add_falcon_rows();
#endif
  } catch (const Error& e) {
    fmt::print(stderr, "bench: {}\n", e.what());
    return e.exit_code();
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
