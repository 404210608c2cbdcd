// Any bytes as a key file: keys, or one error.
#include <sys/stat.h>

#include "protocol/key_file.h"
#include "tests/fuzz/file_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return palpate::test::fuzz_file(data, size, ".key", [](const std::string& file) {
    ::chmod(file.c_str(), 0600);
    palpate::protocol::read_keys(file);
  });
}
