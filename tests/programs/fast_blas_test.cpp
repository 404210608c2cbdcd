// Which kernels OpenBLAS takes in `sim_server`, on the processor that runs this.
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/programs.h"

using namespace palpate::test;

namespace {

bool processor_has(const std::string& what) {
  std::ostringstream text;
  text << std::ifstream("/proc/cpuinfo").rdbuf();
  return (text.str() + " ").find(" " + what + " ") != std::string::npos;
}

/// What OpenBLAS says of itself each time it is loaded.
std::vector<std::string> kernels_said(const std::vector<std::string>& environment) {
  std::vector<std::string> arguments = environment;
  arguments.insert(arguments.end(), {"OPENBLAS_VERBOSE=2", bin_dir() + "/sim_server", "--version"});
  std::istringstream said(output_of("/usr/bin/env", arguments, 0));
  std::vector<std::string> kernels;
  for (std::string line; std::getline(said, line);) {
    if (line.starts_with("Core: ")) kernels.push_back(line.substr(6));
  }
  return kernels;
}

}  // namespace

TEST_CASE("a processor with AVX2 factors by kernels that use it, also where OpenBLAS does not know it") {
  const std::vector<std::string> kernels = kernels_said({"-u", "OPENBLAS_CORETYPE"});
  if (kernels.empty() || !processor_has("avx2") || !processor_has("fma")) return;  // nothing to choose
  CAPTURE(kernels);
  CHECK(kernels.size() <= 2);  // it begins again once at most
  for (const char* old : {"Prescott", "Core2", "Nehalem", "Sandybridge"}) CHECK(kernels.back() != old);
}

TEST_CASE("kernels that the user asks for are taken") {
  const std::vector<std::string> kernels = kernels_said({"OPENBLAS_CORETYPE=Nehalem"});
  if (kernels.empty() || !processor_has("sse4_2")) return;
  CHECK(kernels == std::vector<std::string>{"Nehalem"});
}
