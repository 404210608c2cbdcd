// What `--condensed` refuses, and `sim_server condense` in a build without MPI; with it: tests/mpi.
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Catch::Contains;

#ifdef PALPATE_WITH_CAPTURE
namespace {

std::string record(const TemporaryFolder& folder, const std::string& scene, const std::string& condensed) {
  const std::string configs = source_dir() + "/configs/", out = (folder.path() / "out.pcap").string();
  const std::string said =
      output_of("sim_server",
                {"record", configs + "scenes/" + scene, "--trajectory", configs + "clients/liver_paper.toml",
                 "--rate", "30", "--seconds", "0.2", "--out", out, "--condensed", condensed},
                2);
  CHECK_FALSE(std::filesystem::exists(out));
  return said;
}

}  // namespace

TEST_CASE(
    "condensed sets: a folder that is not there, is of something else, or of a model that is not condensed") {
  const TemporaryFolder folder;
  CHECK_THAT(record(folder, "liver_paper.toml", "/nowhere"), Contains("no folder"));
  CHECK_THAT(record(folder, "liver_paper.toml", folder.path().string()),
             Contains("holds no compliance of 566 nodes"));
  CHECK_THAT(record(folder, "liver_tensor_mass.toml", folder.path().string()), Contains("leave it out"));
}
#endif

#ifndef PALPATE_WITH_MPI
TEST_CASE("condense: a build without MPI says what would have it") {
  const TemporaryFolder folder;
  CHECK_THAT(output_of("sim_server",
                       {"condense", source_dir() + "/configs/scenes/liver_paper.toml", "--out",
                        (folder.path() / "out").string()},
                       2),
             Contains("-DPALPATE_MPI=ON"));
}
#endif
