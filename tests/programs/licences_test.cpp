// Shared libraries that the programs load, against the list in the packages' copyright file.
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/programs.h"

using namespace palpate::test;

namespace {

/// Licence of each library by its name up to ".so".
std::map<std::string, std::string> listed_licences() {
  std::ifstream file(source_dir() + "/scripts/packaging/copyright");
  std::map<std::string, std::string> licences;
  for (std::string line; std::getline(file, line);) {
    const std::size_t end = line.find(".so ");
    if (line.starts_with(" lib") && end != std::string::npos)
      licences[line.substr(1, end + 2)] = line.substr(end + 4);
  }
  return licences;
}

/// True if one of the alternatives of an SPDX expression lets a program under Apache-2.0 load the library.
/// The run-time library exception of GCC lets any program.
bool is_compatible(const std::string& licence) {
  for (std::size_t begin = 0; begin < licence.size();) {
    const std::size_t end = std::min(licence.find(" OR ", begin), licence.size());
    const std::string choice = licence.substr(begin, end - begin);
    const bool gpl = choice.find("GPL-") != std::string::npos && !choice.starts_with("LGPL-");
    if (!gpl || choice.ends_with(" WITH GCC-exception-3.1")) return true;
    begin = end + 4;
  }
  return false;
}

/// Names up to ".so" of all that the loader would load, without the loader, and without sanitizers.
std::vector<std::string> loaded_by(const std::string& file) {
  std::istringstream lines(output_of("/usr/bin/ldd", {bin_dir() + "/../" + file}, 0));
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    const std::size_t end = name.find(".so");
    if (!name.starts_with("lib") || end == std::string::npos || name.find("san.so") != std::string::npos)
      continue;
    names.push_back(name.substr(0, end + 3));
  }
  return names;
}

}  // namespace

TEST_CASE("an expression of licences is compatible if one of its alternatives is") {
  CHECK(is_compatible("MIT"));
  CHECK(is_compatible("LGPL-2.1-or-later"));
  CHECK(is_compatible("AFL-2.1 OR GPL-2.0-or-later"));
  CHECK(is_compatible("GPL-2.0-only OR BSD-3-Clause"));
  CHECK(is_compatible("GPL-3.0-or-later WITH GCC-exception-3.1"));
  CHECK_FALSE(is_compatible("GPL-2.0-or-later"));
  CHECK_FALSE(is_compatible("GPL-2.0-only OR GPL-3.0-or-later"));
  CHECK_FALSE(is_compatible("AGPL-3.0-only"));
  CHECK_FALSE(is_compatible(""));
}

TEST_CASE(
    "each library that a program, or a library of the packages, loads is listed with a licence that "
    "Apache-2.0 goes with") {
  const std::map<std::string, std::string> licences = listed_licences();
  for (const char* const program :
       {"bin/sim_server", "bin/haptic_client", "lib/libpalpate-sim.so", "lib/libpalpate-client.so"}) {
    if (!std::filesystem::exists(bin_dir() + "/../" + program)) continue;  // the libraries are optional
    const std::vector<std::string> names = loaded_by(program);
    CHECK(names.size() > 3);
    for (const std::string& name : names) {
      CAPTURE(program, name);
      REQUIRE(licences.contains(name));
      CHECK(is_compatible(licences.at(name)));
    }
  }
}
