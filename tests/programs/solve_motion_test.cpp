// sim_server solve --seconds: relaxation, damping, flight and what supports bear, against closed forms; a
// step that finds no balance.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include "tests/support/process.h"
#include "tests/support/solve_bench.h"
#include "tests/support/vtu.h"

using namespace palpate::test;

namespace {

const std::string kTop = "surface_tag = \"top\"\n",
                  kRelaxes = "[[material.relaxation]]\nfraction = 0.5\ntime = 0.1\n";

/// Stress along the column, Pa: the mean over its tetrahedra.
double stress_in(const SolveBench& bench) {
  const Vtu file(bench.out);
  const std::vector<double>& stress = file.in_cells.at("stress").values;
  double sum = 0;
  for (std::size_t e = 0; e < file.cells; ++e) sum += stress[9 * e + 4];
  return sum / static_cast<double>(file.cells);
}

}  // namespace

TEST_CASE("solve: relaxed under a load, the supports bear the load, and the stress is that of the load") {
  SolveBench bench;
  bench.solve(kFixed + "[[load]]\ntraction = [0, 50, 0]\n" + kTop + kRelaxes, {"--seconds", "5"});
  CHECK(bench.numbers("force of the supports")[1] == Approx(-50 * kArea).epsilon(1e-3));
  CHECK(stress_in(bench) == Approx(50).epsilon(1e-3));
}

TEST_CASE("solve: held displaced, the stress relaxes as its Prony series, and each support tells its share") {
  SolveBench bench;
  const std::string scene =
      kFixed + "[[load]]\ndisplacement = [0, 0.004, 0]\naxes = \"y\"\n" + kTop + kRelaxes;
  const double at_once = kE * 0.004 / kHeight;  // Pa
  for (const double seconds : {0.1, 2.0}) {
    CAPTURE(seconds);
    bench.solve(scene, {"--seconds", fmt::format("{}", seconds), "--step", "0.001"},
                "poisson_ratio = 0\ndensity = 1e-3");
    // The displacement comes within the first step, of 1 ms.
    const double expected = at_once * (1 - 0.5 * (1 - std::exp(-seconds / 0.1)));
    CHECK(stress_in(bench) == Approx(expected).epsilon(0.01));
    CHECK(std::abs(bench.numbers("force of the supports")[1]) < 1e-3 * expected * kArea);
    CHECK(bench.numbers("of [[fixed]] " + bench.path("scene.toml") + ":7")[1] ==
          Approx(-expected * kArea).epsilon(0.01));
    CHECK(bench.numbers("of [[load]] " + bench.path("scene.toml") + ":9")[1] ==
          Approx(expected * kArea).epsilon(0.01));
  }
}

TEST_CASE("solve: a body that nothing holds falls, and keeps its momentum") {
  SolveBench bench;
  for (const char* law : {"linear", "corotational"}) {
    CAPTURE(law);
    const std::string material = fmt::format("poisson_ratio = 0.3\nlaw = \"{}\"", law);
    bench.solve("[[load]]\ngravity = [0, -9.81, 0]\n", {"--seconds", "1", "--probe", "0.03,0.2,0.07"},
                material);
    CHECK(bench.numbers("probe 0.03,0.2,0.07: displacement ")[1] == Approx(-4.905).epsilon(0.002));
    const double mass = 1000 * kArea * kHeight;
    CHECK(bench.numbers("kinetic energy")[0] == Approx(0.5 * mass * 9.81 * 9.81).epsilon(1e-4));
    CHECK(bench.numbers("force of the supports")[1] == 0);
  }
}

TEST_CASE("solve: damping of a model that serves tools counts in a motion, too") {
  SolveBench bench;
  const std::string pulled = kFixed + "[[load]]\ntraction = [0, 50, 0]\n" + kTop;
  const std::string damped = "[deformation]\nmodel = \"tensor_mass\"\nrayleigh_mass = 1000\n";
  // So damped it creeps: far from where it will stand.
  bench.solve(pulled + damped, {"--seconds", "0.05", "--probe", "0.03,0.4,0.07"});
  CHECK(bench.said.find("tensor_mass") != std::string::npos);
  CHECK(bench.numbers(": displacement ")[1] < 0.2 * 50 * kHeight / kE);
  bench.solve(pulled, {"--seconds", "0.05", "--probe", "0.03,0.4,0.07"});
  CHECK(bench.numbers(": displacement ")[1] > 0.3 * 50 * kHeight / kE);
}

TEST_CASE(
    "solve: a step that finds no balance is an error, not a body at rest, its series can be looked at") {
  SolveBench bench;
  const std::string series = bench.path("motion.pvd");
  const std::string said = output_of(
      "sim_server",
      bench.arguments(kFixed + "[[load]]\npressure = 1e7\n" + kTop, {"--seconds", "0.1", "--series", series},
                      "poisson_ratio = 0.4\nlaw = \"corotational\"", "column.msh"),
      1);
  CAPTURE(said);
  CHECK(said.find("no convergence") != std::string::npos);
  CHECK(said.find("--step") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(bench.out));
  CHECK(bytes_of(series).find("motion_0000.vtu") != std::string::npos);
}

TEST_CASE("solve: a series that is interrupted leaves no frames behind") {
  SolveBench bench;
  const std::string series = bench.path("motion.pvd"), frame = bench.path("motion_0002.vtu");
  Process solving("sim_server", bench.arguments(kFixed + "[[load]]\ntraction = [0, 50, 0]\n" + kTop,
                                                {"--seconds", "1000", "--step", "0.001", "--frames", "10000",
                                                 "--series", series},
                                                "poisson_ratio = 0", "column.msh"));
  for (int k = 0; k < 2000 && !std::filesystem::exists(frame); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  REQUIRE(std::filesystem::exists(frame));
  solving.signal(SIGINT);
  CHECK(solving.wait() == 1);
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(series).parent_path()))
    CHECK_FALSE(entry.path().filename().string().starts_with("motion_"));
  CHECK_FALSE(std::filesystem::exists(series));
}
