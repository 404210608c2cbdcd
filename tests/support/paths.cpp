#include "tests/support/paths.h"

namespace palpate::test {

const std::string& source_dir() {
  static const std::string folder = PALPATE_SOURCE_DIR;
  return folder;
}
const std::string& bin_dir() {
  static const std::string folder = PALPATE_BIN_DIR;
  return folder;
}

}  // namespace palpate::test
