// `sim_server explain` and the set-up times of `run`, by the real program.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// "FILE:LINE" of the first line of the liver scene that begins with `start`.
std::string line(const std::string& start) {
  std::ifstream in(kScene);
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    if (text.rfind(start, 0) == 0) return kScene + ":" + std::to_string(number);
  }
  throw std::runtime_error("no such line: " + start);
}

}  // namespace

TEST_CASE("explain names the lines of the liver scene that ask for what it builds") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "explain.json").string();
  Process process("sim_server", {"explain", kScene, "--json", file, "--no-cache"});
  CHECK(process.wait() == 0);
  const std::string& said = process.output();
  CAPTURE(said);
  for (const char* start : {"file", "[[fixed]]", "[material]", "model", "[[tool]]", "rate_hz"}) {
    CHECK(said.find(line(start)) != std::string::npos);
  }
  for (const char* part : {"compliance", "stiffness matrix", "omitted", "in contact", "state hash"}) {
    CHECK(said.find(part) != std::string::npos);
  }
  const Json json = read_json(file);
  CHECK(json["bytes"].get<long>() > 1000000);
  // What it held at most for this scene, before the variants, against what the system counted of a process
  // that serves it for a moment: the parts are what that holds more than one that sets nothing up.
  CHECK(said.find("resident") != std::string::npos);
  Process serving("sim_server", {"run", kScene, "--listen", "127.0.0.1:0", "--viewer", "off", "--seconds",
                                 "0.1", "--no-cache"});
  CHECK(serving.wait() == 0);
  Process idle("sim_server", {"scenes"});
  CHECK(idle.wait() == 0);
  const double peak = json["peak_bytes"].get<double>();
  CAPTURE(peak, serving.peak_bytes(), idle.peak_bytes());
  CHECK(peak < process.peak_bytes());
  CHECK(peak == Approx(serving.peak_bytes()).epsilon(0.15));
  CHECK(json["bytes"].get<double>() < peak - idle.peak_bytes());
  CHECK(said.find(json["state_hash"].get<std::string>()) != std::string::npos);
}

TEST_CASE("explain of a file that is not there: one line, exit 2") {
  Process process("sim_server", {"explain", "/nowhere/scene.toml"});
  CHECK(process.wait() == 2);
  const std::string& said = process.output();
  CHECK(said.find("/nowhere/scene.toml: no such file") != std::string::npos);
  CHECK(std::ranges::count(said, '\n') == 1);
}

TEST_CASE("explain takes as many steps as it is asked for, and tells that it does") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "explain.json").string();
  const std::string said = output_of("sim_server", {"explain", kScene, "--steps", "7", "--json", file}, 0);
  CHECK(said.find("timing steps") != std::string::npos);
  const Json json = read_json(file);
  CHECK(json["free"]["steps"] == 7);
  CHECK(json["contact"]["steps"] == 7);
  CHECK(output_of("sim_server", {"explain", kScene, "--steps", "0"}, 2).find("--steps") != std::string::npos);
}

TEST_CASE("the report of a run tells set-up by stage, and the stages fit into the whole") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "server.json").string();
  Process process("sim_server", {"run", kScene, "--no-cache", "--listen", "127.0.0.1:0", "--seconds", "0.2",
                                 "--report", file});
  CHECK(process.wait() == 0);
  const Json json = read_json(file);
  double sum = 0;
  for (const char* stage : {"reading the mesh", "extracting the surface", "assembling the stiffness matrix",
                            "factoring the stiffness matrix", "computing compliance", "preparing contact"}) {
    REQUIRE(json["setup_parts_ms"].contains(stage));
    sum += json["setup_parts_ms"][stage].get<double>();
  }
  CHECK(json["setup_parts_ms"].size() == 6);
  CHECK(sum <= json["setup_ms"].get<double>());
}

TEST_CASE(
    "explain tells whether the set-up came from the cache, and with it and without, the steps are the same") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "explain.json").string(),
                    cache = (folder.path() / "cache").string();
  const auto explained = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"explain", kScene, "--steps", "20", "--json", file};
    arguments.insert(arguments.end(), options.begin(), options.end());
    output_of("sim_server", arguments, 0);
    const Json json = read_json(file);
    for (const Json& part : json["built"]) {
      if (part["part"] == "compliance")
        return std::pair(part["detail"].get<std::string>(), json["state_hash"].get<std::string>());
    }
    return std::pair<std::string, std::string>();
  };
  const auto plain = explained({"--no-cache"}), first = explained({"--cache", cache}),
             second = explained({"--cache", cache});
  CHECK(plain.first == "566 nodes");
  CHECK(first.first == "566 nodes, now in the set-up cache");
  CHECK(second.first.find("566 nodes, from the set-up cache, which saved ") == 0);
  CHECK(first.second == plain.second);
  CHECK(second.second == plain.second);
  const std::filesystem::path entry = std::filesystem::directory_iterator(cache)->path();
  CHECK(std::filesystem::file_size(entry) == 4096 + 8 * (3 * 566) * (3 * 566));
}

TEST_CASE("a cache that cannot be written to costs one warning, though the set-up would keep two matrices") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "file").string();
  std::ofstream(file) << "x";
  const std::string said = output_of("sim_server",
                                     {"explain", source_dir() + "/configs/scenes/liver_reduced.toml",
                                      "--steps", "1", "--cache", file + "/in"},
                                     0);
  const std::string warning = "set-up cache: nothing kept: ";
  const std::size_t first = said.find(warning);
  REQUIRE(first != said.npos);
  CHECK(said.find(warning, first + 1) == said.npos);
}

TEST_CASE(
    "explain warns of a density in g/cm3 and of elements that lock, with a remedy, and of neither else") {
  const TemporaryFolder folder;
  std::ifstream in(kScene);
  const std::string scene(std::istreambuf_iterator<char>(in), {});
  const auto said_with = [&](const std::vector<std::pair<std::string, std::string>>& changes) {
    std::string text = scene;
    for (const auto& [key, value] : changes) {
      const std::size_t at = text.find("\n" + key + " = ");
      REQUIRE(at != std::string::npos);
      text.replace(at + 1, text.find('\n', at + 1) - at - 1, key + " = " + value);
    }
    for (std::size_t at = text.find("\"../"); at != std::string::npos; at = text.find("\"../"))
      text.replace(at + 1, 3, source_dir() + "/configs/");
    return output_of("sim_server", {"explain", folder.write("scene.toml", text).string(), "--steps", "1"}, 0);
  };
  const std::string right = said_with({{"density", "1060"}});
  CHECK(right.find("`density` = ") == std::string::npos);
  CHECK(right.find("locks at") == std::string::npos);
  const std::string grams = said_with({{"density", "1.06"}});
  CHECK(
      grams.find("`density` = 1.06 kg/m3, and soft tissue has about 1060; if it is in g/cm3, write `density "
                 "= 1060`") != std::string::npos);
  const std::string locked = said_with({{"poisson_ratio", "0.499"}});
  CHECK(locked.find("element \"p1\" locks at poisson_ratio 0.499") != std::string::npos);
  CHECK(locked.find("take element \"p2\"") != std::string::npos);
  const std::string remedied = said_with({{"poisson_ratio", "0.499\nelement = \"p2\""}});
  CHECK(remedied.find("locks at") == std::string::npos);
}
