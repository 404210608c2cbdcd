#include "sim_server/models/deformation_models.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("nothing outside sim_server/models knows the name of a model") {
  const std::filesystem::path root(test::source_dir());
  int files = 0;
  for (const char* part : {"common", "protocol", "sim_server", "haptic_client"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / part)) {
      const std::filesystem::path& file = entry.path();
      if (file.parent_path() == root / "sim_server" / "models") continue;
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

TEST_CASE("what a scene sets of its model is written as it was read, each key") {
  // Not what is taken where nothing is said, and as numbers are written.
  const std::map<std::string_view, std::string> values{{"stiffness", "321"},
                                                       {"spring_stiffness", "[11, 22, 33]"},
                                                       {"hardening_length", "0.0123"},
                                                       {"compliance_tolerance", "0.0025"},
                                                       {"rayleigh_mass", "7"},
                                                       {"rayleigh_stiffness", "0.00035"},
                                                       {"instants", "3"},
                                                       {"added_mass", "0.07"},
                                                       {"modes", "17"},
                                                       {"client_modes", "11"},
                                                       {"layers", "2"},
                                                       {"condensed_modes", "13"},
                                                       {"integrator", "\"bdf2\""},
                                                       {"solver", "\"quasi_newton\""},
                                                       {"refresh_steps", "19"},
                                                       {"max_newton", "23"},
                                                       {"tolerance", "0.00015"}};
  const test::TemporaryFolder folder;
  for (const DeformationModelRow& row : deformation_models()) {
    std::string text = "[deformation]\nmodel = \"" + std::string(row.name) + "\"\n";
    for (const std::string_view key : row.keys()) {
      CAPTURE(row.name, key);
      INFO("give each key of a model a value in `values` above");
      REQUIRE(values.contains(key));
      if (key.empty()) continue;
      text += std::string(key) + " = " + values.at(key) + "\n";
    }
    const auto file = folder.write("deformation.toml", text);
    const std::string written = to_text(read_deformation(*Config::read(file).table("deformation")));
    for (const std::string_view key : row.keys()) {
      if (key.empty()) continue;
      CAPTURE(row.name, key, written);
      CHECK(written.find("\n" + std::string(key) + " = " + values.at(key) + "\n") != std::string::npos);
    }
  }
}
