// What is taken for a firmware image.
#include "common/error.h"
#include "haptic_client/device/falcon.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::client;
using Catch::Matchers::Contains;

TEST_CASE("a text is no firmware image, bytes of all values may be one") {
  const test::TemporaryFolder folder;
  const std::string page = "<!DOCTYPE html>\r\n<html>\t" + std::string(8000, 'x') + "</html>\n";
  CHECK_THROWS_WITH(read_firmware(folder.write("page.bin", page)), Contains("page.bin: is a text"));
  std::string image;
  for (int i = 0; i < 8000; ++i) image.push_back(static_cast<char>(i * 37 % 256));
  CHECK(read_firmware(folder.write("image.bin", image)).size() == 8000);
}
