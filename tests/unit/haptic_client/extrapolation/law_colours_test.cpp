#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

using namespace palpate;

namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(std::filesystem::path(test::source_dir()) / file);
  REQUIRE(in.good());
  return (std::ostringstream() << in.rdbuf()).str();
}

}  // namespace

TEST_CASE("law colours: each law has one of its own, which the page and the pictures take from one list") {
  const auto colours = nlohmann::json::parse(text_of("common/law_colours.json"));
  CHECK(colours.size() == client::extrapolators().size());
  const std::string page = text_of("sim_server/viewer/page/dist/page.js");
  std::set<std::string> all;
  for (const auto& row : client::extrapolators()) {
    CAPTURE(row.name);
    REQUIRE(colours.contains(std::string(row.name)));
    for (const char* theme : {"light", "dark"}) {
      const auto colour = colours[std::string(row.name)][theme].get<std::string>();
      CHECK(colour.size() == 7);
      CHECK(all.insert(colour).second);
      CHECK(page.find(colour) != std::string::npos);
    }
  }
  CHECK(text_of("scripts/plotting/pictures.py").find("law_colours.json") != std::string::npos);
  for (const char* picture : {"force.py", "session.py", "extrapolation.py", "laws_animation.py"}) {
    CAPTURE(picture);
    CHECK(text_of(std::filesystem::path("scripts/plotting") / picture).find("style_of_laws") !=
          std::string::npos);
  }
}
