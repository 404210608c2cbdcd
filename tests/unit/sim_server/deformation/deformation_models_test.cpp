#include "sim_server/deformation/deformation_models.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/paths.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("nothing outside sim_server/deformation knows the name of a model") {
  const std::filesystem::path root(test::source_dir());
  int files = 0;
  for (const char* part : {"common", "protocol", "sim_server", "haptic_client"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / part)) {
      const std::filesystem::path& file = entry.path();
      if (file.parent_path() == root / "sim_server" / "deformation") continue;
      if (file.extension() != ".h" && file.extension() != ".cpp") continue;
      ++files;
      std::ostringstream text;
      text << std::ifstream(file).rdbuf();
      for (const DeformationModelRow& row : deformation_models()) {
        CAPTURE(file, row.name);
        CHECK(text.str().find('"' + std::string(row.name) + '"') == std::string::npos);
        CHECK(text.str().find("\\\"" + std::string(row.name) + "\\\"") == std::string::npos);
      }
    }
  }
  CHECK(files > 100);
}

TEST_CASE("every model says what it will take, and reads back what it writes") {
  const auto file = std::filesystem::temp_directory_path() / "palpate_deformation_models_test.toml";
  for (const DeformationModelRow& row : deformation_models()) {
    CAPTURE(row.name);
    Scene scene;
    scene.material.emplace();
    CHECK((row.estimated_bytes(scene, {1000, 6000, 10000, 5000}) > 0) == row.deforms());
    DeformationSettings settings;
    settings.model = row.name;
    const std::string text = to_text(settings);
    std::ofstream(file) << text;
    CHECK(to_text(read_deformation(*Config::read(file).table("deformation"))) == text);
  }
  std::filesystem::remove(file);
}
