// sim_server study: the same rows every time, from where it was left.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fmt/core.h>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/support/catch.h"
#include "tests/support/column.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

struct Bench {
  TemporaryFolder folder;
  std::string out = (folder.path() / "out").string();
  Bench() { folder.write("column.msh", column()); }
  std::string scene(const std::string& model) {
    return folder
        .write("scene.toml",
               "rate_hz = 30\n[mesh]\nfile = \"column.msh\"\n[material]\nyoung_modulus = 2e4\npoisson_ratio "
               "= 0.3\n"
               "[[fixed]]\nbox = [[-1, -1, -1], [1, 0.001, 1]]\n[[tool]]\nradius = "
               "0.03\n[deformation]\nmodel = \"" +
                   model + "\"\n")
        .string();
  }
  std::string text_of(const std::string& file) const {
    std::ifstream in(out + "/" + file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

}  // namespace

TEST_CASE("study: rows are the same again from nothing, and at once from what was run before", "[large]") {
  Bench bench;
  const std::string scene = bench.scene("quasi_static");
  const std::vector<std::string> command{"study", scene, "--out", bench.out, "--quick", "--budget-ms", "33"};
  const std::string said = output_of("sim_server", command, 0, 120);
  CAPTURE(said);
  CHECK(said.find("[deformation]\nmodel = \"") != std::string::npos);
  CHECK(said.find("scene.toml: in the place of the same keys, [deformation]") != std::string::npos);
  const std::string summary = bench.text_of("summary.json");
  const auto entire = nlohmann::json::parse(summary);
  for (const auto& row : entire["rows"]) {
    CHECK(row["peak_bytes"].get<double>() > 1e6);
#if !defined(PALPATE_SANITIZED)                     // they keep more
    CHECK(row["peak_bytes"].get<double>() < 60e6);  // a column of some hundred vertices, and the program
#endif
  }
  const std::string rows = bench.text_of("rows.csv"), timing = bench.text_of("timing.csv"),
                    along = bench.text_of("along.csv");
  CHECK(
      rows.find("scene,axis,case,model,law,element,mesh,refinements,tetrahedra,nodes,dt_ms,tolerance,"
                "force_error_percent,worst_force_error_percent,surface_error_percent,rendered_error_percent,"
                "rendered_p99_percent,rendered_max_percent,rendered_p99_of_rms_percent,"
                "rendered_max_of_rms_percent,rendered_mean_10ms_percent,rendered_p99_10ms_percent,"
                "rendered_max_10ms_percent,rendered_p99_10ms_of_rms_percent,rendered_max_10ms_of_rms_percent,"
                "flagged_steps,state_hash") == 0);
  CHECK(rows.find(",tensor_mass,linear,p1,") != std::string::npos);
  // Again: times are of the traces that are there.
  output_of("sim_server", command, 0, 20);
  CHECK(bench.text_of("timing.csv") == timing);
  CHECK(bench.text_of("rows.csv") == rows);
  std::filesystem::remove_all(bench.out);
  output_of("sim_server", command, 0, 120);
  CHECK(bench.text_of("rows.csv") == rows);
  CHECK(bench.text_of("along.csv") == along);
}

TEST_CASE("study: two meshes of one name, and a way that touches nothing, are refused") {
  Bench bench;
  const std::string scene = bench.scene("quasi_static");
  std::filesystem::create_directory(bench.folder.path() / "other");
  bench.folder.write("other/column.msh", column());
  const std::string twice = output_of(
      "sim_server",
      {"study", scene, "--out", bench.out, "--mesh", (bench.folder.path() / "other/column.msh").string()}, 2);
  CHECK(twice.find("cases are known by it; rename one") != std::string::npos);
  const std::string away = bench.folder.write("away.csv", "t_s,x_m,y_m,z_m\n0,5,5,5\n1,5,5,6\n").string();
  const std::string missed =
      output_of("sim_server", {"study", scene, "--out", bench.out, "--quick", "--trajectory", away}, 2, 120);
  CHECK(missed.find("never touches the organ") != std::string::npos);
}

TEST_CASE("study: a scene without tissue is refused with what to take") {
  Bench bench;
  const std::string said = output_of("sim_server", {"study", bench.scene("rigid"), "--out", bench.out}, 2);
  CHECK(said.find("no tissue to study; take quasi_static") != std::string::npos);
}

TEST_CASE("study: asked to end in the middle of a case it ends at once, and nobody is left behind") {
  Bench bench;
  // A reference on the liver takes minutes.
  Process study("sim_server",
                {"study", source_dir() + "/configs/scenes/liver_implicit.toml", "--out", bench.out});
  REQUIRE(study.wait_for("reference: "));
  const std::string list = fmt::format("/proc/{0}/task/{0}/children", study.id());
  pid_t child = 0;
  for (int k = 0; k < 500 && child == 0; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::ifstream(list) >> child;
  }
  REQUIRE(child > 0);
  study.signal(SIGTERM);
  CHECK(study.wait(5) == 1);
  CHECK((kill(child, 0) == -1 && errno == ESRCH));
  CHECK(study.output().find("interrupted; the same command goes on from there") != std::string::npos);
}
