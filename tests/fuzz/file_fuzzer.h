#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include "common/error.h"

namespace palpate::test {

/// Writes the bytes to a file of this process and lets `parse` read it; only `Error` may come out.
template <class Parse>
int fuzz_file(const std::uint8_t* data, std::size_t size, const char* suffix, Parse parse) {
  static const std::string file =
      (std::filesystem::temp_directory_path() / ("palpate_fuzz_" + std::to_string(getpid()) + suffix))
          .string();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    parse(file);
  } catch (const Error&) {
  }
  return 0;
}

}  // namespace palpate::test
