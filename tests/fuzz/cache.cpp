// Any bytes as an entry of the set-up cache: a matrix whose checksum agrees, or one error.
#include "sim_server/setup_cache/setup_cache.h"
#include "tests/fuzz/file_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return palpate::test::fuzz_file(data, size, ".entry", [](const std::string& file) {
    palpate::sim::map_entry(file, palpate::sim::Digest{});
  });
}
