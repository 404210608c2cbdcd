// Any bytes as an entry of the set-up cache: a matrix whose checksums agree, or one error.
#include "sim_server/setup_cache/cache_entry.h"
#include "tests/fuzz/file_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return palpate::test::fuzz_file(data, size, ".entry", [](const std::string& file) {
    const auto header = palpate::sim::read_header(file);
    palpate::sim::map_entry(file, header ? header->key : palpate::sim::Digest{});
  });
}
