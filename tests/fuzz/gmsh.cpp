#include "sim_server/mesh/gmsh_io.h"
#include "tests/fuzz/file_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return palpate::test::fuzz_file(data, size, ".msh",
                                  [](const std::string& file) { palpate::sim::check_mesh(file); });
}
