#include "common/csv.h"

#include <array>

#include "tests/fuzz/file_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::array<std::string, 2> columns{"t", "x"};
  return palpate::test::fuzz_file(data, size, ".csv",
                                  [](const std::string& file) { palpate::read_csv_columns(file, columns); });
}
