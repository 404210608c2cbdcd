// sim_server solve: what an engineer compares with another code, as the program prints it.
#include <fmt/core.h>

#include "tests/support/catch.h"
#include "tests/support/column.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::test;

namespace {

struct Bench {
  TemporaryFolder folder;
  std::string out = (folder.path() / "out.vtu").string();
  Bench() { folder.write("column.msh", column()); }
  std::string scene(const std::string& more,
                    const std::string& material = "law = \"linear\"\nelement = \"p2\"") {
    const std::string text = fmt::format(
        "[mesh]\nfile = \"column.msh\"\n[material]\nyoung_modulus = 2e4\npoisson_ratio = 0\ndensity = "
        "1000\n{}\n"
        "[[fixed]]\nbox = [[-1, -1, -1], [1, 0.001, 1]]\n{}",
        material, more);
    return folder.write("scene.toml", text).string();
  }
};

double number_after(const std::string& text, const std::string& before, int skip = 0) {
  std::size_t at = text.find(before);
  REQUIRE(at != std::string::npos);
  at += before.size();
  for (int i = 0; i < skip; ++i) at = text.find(' ', text.find_first_not_of(' ', at));
  return std::stod(text.substr(at));
}

}  // namespace

TEST_CASE("solve: a column under its own weight: probe, energy and reaction by hand") {
  Bench bench;
  const std::string said = output_of("sim_server",
                                     {"solve", bench.scene("[[load]]\ngravity = [0, -9.81, 0]\n"), "--out",
                                      bench.out, "--probe", "0.05,0.2,0.05"},
                                     0);
  CAPTURE(said);
  // u = -rho g (y L - y^2 / 2) / E; energy: half the work of the weight, (rho g)^2 A L^3 / (6 E).
  CHECK(number_after(said, ": displacement ", 1) == Approx(-9810 * (0.2 * 0.4 - 0.02) / 2e4).epsilon(1e-7));
  CHECK(number_after(said, "elastic energy") ==
        Approx(9810.0 * 9810 * 0.01 * 0.064 / (6 * 2e4)).epsilon(1e-7));
  CHECK(number_after(said, "force of the supports", 1) == Approx(9810 * 0.004).epsilon(1e-7));
  std::ifstream file(bench.out);
  std::string first;
  std::getline(file, first);
  CHECK(first.rfind("<?xml", 0) == 0);
}

TEST_CASE("solve: relaxing under a load that stays, it creeps to where half the stiffness leads") {
  Bench bench;
  const std::string scene = bench.scene(
      "[[load]]\ntraction = [0, -100, 0]\nbox = [[-1, 0.399, -1], [1, 1, 1]]\n[[material.relaxation]]\n"
      "fraction = 0.5\ntime = 0.2\n",
      "element = \"p1\"");
  const std::string at_once =
      output_of("sim_server", {"solve", scene, "--out", bench.out, "--probe", "0,0.4,0"}, 0);
  const std::string later =
      output_of("sim_server",
                {"solve", scene, "--out", bench.out, "--probe", "0,0.4,0", "--seconds", "8", "--step", "0.05",
                 "--series", (bench.folder.path() / "m.pvd").string()},
                0);
  CHECK(number_after(at_once, ": displacement ", 1) == Approx(-100 * 0.4 / 2e4).epsilon(1e-7));
  CHECK(number_after(later, ": displacement ", 1) == Approx(-100 * 0.4 / 1e4).epsilon(0.01));
  CHECK(std::filesystem::exists(bench.folder.path() / "m_0000.vtu"));
}

TEST_CASE("solve: what moves to and fro stands where it does at t = 0, and after --seconds") {
  Bench bench;
  const std::string scene =
      bench.scene("[[fixed.motion]]\ndirection = [3, 4, 0]\namplitude = 0.01\nperiod = 4\nphase = 0.5\n",
                  "element = \"p1\"");
  const std::string still =
      output_of("sim_server", {"solve", scene, "--out", bench.out, "--probe", "0,0.4,0"}, 0);
  CHECK(number_after(still, ": displacement ", 1) == Approx(0.008 * std::sin(0.5)).epsilon(1e-7));
  const std::string later = output_of(
      "sim_server",
      {"solve", scene, "--out", bench.out, "--probe", "0,0,0", "--seconds", "2.5", "--step", "0.05"}, 0);
  CHECK(number_after(later, ": displacement ") ==
        Approx(0.006 * std::sin(1.25 * 3.14159265358979 + 0.5)).epsilon(1e-7));
}

TEST_CASE("solve: wrong input is one clear line, exit 2, and no file") {
  Bench bench;
  const auto refused = [&](const std::string& scene, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"solve", scene, "--out", bench.out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::string said = output_of("sim_server", arguments, 2);
    CHECK_FALSE(std::filesystem::exists(bench.out));
    return said;
  };
  CHECK(refused(bench.scene("", "law = \"rubber\"")).find("linear, corotational, neo_hookean, stvk") !=
        std::string::npos);
  CHECK(refused(bench.scene("", "element = \"p3\"")).find("unknown element \"p3\"") != std::string::npos);
  CHECK(refused(bench.scene("[[load]]\nforce = [0, 1, 0]\n"))
            .find("needs one of `box`, `surface_tag`, or `center` with `radius`, and has none") !=
        std::string::npos);
  CHECK(
      refused(bench.scene("[[load]]\ngravity = [0, 1, 0]\npressure = 1\n")).find("needs one of `gravity`") !=
      std::string::npos);
  CHECK(refused(bench.scene(""), {"--probe", "1,2"}).find("three numbers in metres") != std::string::npos);
  CHECK(refused(bench.scene(""), {"--series", "x.pvd"}).find("needs --seconds") != std::string::npos);
  CHECK(refused(bench.scene(""), {"--step", "0.1"}).find("--step requires --seconds") != std::string::npos);
  CHECK(refused(bench.scene(""), {"--seconds", "1e6", "--step", "1e-4"}).find("are 1e+10 steps") !=
        std::string::npos);
  bench.out = (bench.folder.path() / "motion_0001.vtu").string();
  const std::string series = (bench.folder.path() / "motion.pvd").string();
  CHECK(refused(bench.scene(""), {"--seconds", "1", "--series", series}).find("a frame of --series") !=
        std::string::npos);
  CHECK_FALSE(std::filesystem::exists(series));
  CHECK(refused(bench.scene("[[load]]\nforce = [0, 1, 0]\nbox = [[-1, -1, -1], [1, 0.001, 1]]\n"))
            .find("every vertex in this region is held") != std::string::npos);
  for (const auto& [file, says] :
       {std::pair("wrong.txt", "is to end in .vtu"), std::pair("", "\"\" is to end in .vtu")}) {
    const std::vector<std::string> arguments{"solve", bench.scene(""), "--out", file};
    CHECK(output_of("sim_server", arguments, 2).find(says) != std::string::npos);
  }
}

TEST_CASE("solve: a load beyond what a mesh bears is told of, and none at all") {
  Bench bench;
  const std::string pressed = "[[load]]\ntraction = [0, -3e4, 0]\nbox = [[-1, 0.39, -1], [1, 1, 1]]\n";
  const std::string said =
      output_of("sim_server", {"solve", bench.scene(pressed, "law = \"linear\""), "--out", bench.out}, 0);
  CHECK(said.find("24 of 24 tetrahedra are inside out (volume ratio down to -0.5)") != std::string::npos);
  CHECK(output_of("sim_server", {"solve", bench.scene(""), "--out", bench.out}, 0).find("no [[load]]") !=
        std::string::npos);
}
