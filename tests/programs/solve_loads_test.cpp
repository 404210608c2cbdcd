// sim_server solve: each way to hold and to load a body, against closed forms; and the files that it writes.
#include <fmt/core.h>
#include <numbers>

#include "tests/support/paths.h"
#include "tests/support/solve_bench.h"
#include "tests/support/vtu.h"

using namespace palpate::test;
using Place = SolveBench::Place;

namespace {

const std::vector<std::string> kTwoProbes{"--probe", "0.03,0.4,0.07", "--probe", "0.01,0.12,0.06"};

}  // namespace

TEST_CASE("solve: a bar that is pulled, held and loaded by tags, boxes and balls of its ends") {
  SolveBench bench;
  const std::string box = "[[fixed]]\nbox = [[-1, -1, -1], [1, 0.001, 1]]\n",
                    ball = "[[fixed]]\ncenter = [0.05, -10, 0.05]\nradius = 10.01\n",
                    traction = "[[load]]\ntraction = [0, 50, 0]\n";
  for (const std::string& sections : {kFixed + traction + "surface_tag = \"top\"\n",
                                      box + traction + "box = [[-1, 0.399, -1], [1, 1, 1]]\n",
                                      ball + traction + "center = [0.05, 10.4, 0.05]\nradius = 10.01\n"}) {
    for (const char* element : {"p1", "p1_nodal_pressure", "p2"}) {
      CAPTURE(sections, element);
      bench.solve(sections, kTwoProbes, fmt::format("poisson_ratio = 0\nelement = \"{}\"", element));
      bench.check_moved("0.03,0.4,0.07", {0, 50 * kHeight / kE, 0});
      bench.check_moved("0.01,0.12,0.06", {0, 50 * 0.12 / kE, 0});
      CHECK(bench.numbers("force of the supports")[1] == Approx(-50 * kArea).epsilon(1e-7));
      CHECK(bench.numbers("elastic energy")[0] == Approx(50 * 50 * kArea * kHeight / (2 * kE)).epsilon(1e-7));
    }
  }
}

TEST_CASE("solve: a bar of layers, some a million times as stiff: each is stretched by its own modulus") {
  // As springs one after the other: stress s everywhere, and of each layer s h / E.
  SolveBench bench;
  const double stress = 50, h = 0.1, hard = 1e6 * kE, soft = kE / 4;
  const std::string layers = fmt::format(
      "\n[[material.inclusion]]\nbox = [[-1, 0.1, -1], [1, 0.2, 1]]\nyoung_modulus = {}"
      "\n[[material.inclusion]]\ncenter = [0.05, 1.3, 0.05]\nradius = 1\nyoung_modulus = {}",
      hard, soft);
  for (const char* law : {"linear", "corotational"}) {
    for (const char* element : {"p1", "p2"}) {
      CAPTURE(law, element);
      bench.solve(kFixed + fmt::format("[[load]]\ntraction = [0, {}, 0]\nsurface_tag = \"top\"\n", stress),
                  kTwoProbes,
                  fmt::format("poisson_ratio = 0\nlaw = \"{}\"\nelement = \"{}\"{}", law, element, layers));
      bench.check_moved("0.01,0.12,0.06", {0, stress * (h / kE + 0.02 / hard), 0});
      bench.check_moved("0.03,0.4,0.07", {0, stress * h * (2 / kE + 1 / hard + 1 / soft), 0});
      CHECK(bench.numbers("force of the supports")[1] == Approx(-stress * kArea).epsilon(1e-7));
      Vtu vtu(bench.out);
      for (std::size_t cell = 0; cell < vtu.cells; ++cell) {
        const double modulus = std::array{kE, hard, kE, soft}[cell / 6];
        CAPTURE(cell);
        // Of the linear law forces are per area at rest; the other is stretched by 1 + s / E with no
        // Poisson's effect.
        CHECK(vtu.in_cells["stress"].values[9 * cell + 4] == Approx(stress).epsilon(1e-5));
        CHECK(vtu.in_cells["energy_density"].values[cell] ==
              Approx(stress * stress / (2 * modulus)).epsilon(1e-5));
      }
    }
  }
}

TEST_CASE("solve: pressure on a bar that rests on three planes widens it by Poisson's ratio") {
  SolveBench bench;
  const std::string planes =
      "[[fixed]]\nsurface_tag = \"bottom\"\naxes = \"y\"\n"
      "[[fixed]]\nbox = [[-1, -1, -1], [0.001, 1, 1]]\naxes = \"x\"\n"
      "[[fixed]]\nbox = [[-1, -1, -1], [1, 1, 0.001]]\naxes = \"z\"\n";
  bench.solve(planes + "[[load]]\npressure = 80\nsurface_tag = \"top\"\n", kTwoProbes, "poisson_ratio = 0.3");
  const double strain = 80 / kE;
  bench.check_moved("0.03,0.4,0.07", {0.3 * strain * 0.03, -strain * 0.4, 0.3 * strain * 0.07});
  bench.check_moved("0.01,0.12,0.06", {0.3 * strain * 0.01, -strain * 0.12, 0.3 * strain * 0.06});
}

TEST_CASE("solve: under suction St. Venant and Kirchhoff's bar is stretched as its cubic says") {
  // Without Poisson's effect its ends keep their area: p = E l (1 - l^2) / 2 makes it l times as long.
  // Pressed by as much it would buckle.
  SolveBench bench;
  const double stretch = 1.07, pressure = 0.5 * kE * stretch * (1 - stretch * stretch);
  bench.solve(kFixed + fmt::format("[[load]]\npressure = {}\nsurface_tag = \"top\"\n", pressure), kTwoProbes,
              "poisson_ratio = 0\nlaw = \"stvk\"");
  bench.check_moved("0.03,0.4,0.07", {0, (stretch - 1) * kHeight, 0});
  bench.check_moved("0.01,0.12,0.06", {0, (stretch - 1) * 0.12, 0});
  CHECK(bench.numbers("force of the supports")[1] == Approx(pressure * kArea).epsilon(1e-7));
}

TEST_CASE("solve: a force is shared equally by the vertices of its region, and is all of it in all") {
  // Two tetrahedra of heights h on one held base of area A: with no Poisson's ratio an apex that bears F goes
  // 3 h F / (E A) along the height, and 6 h F / (E A) across it.
  SolveBench bench;
  bench.folder.write(
      "two.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 0.3 0 0\n3 0 0 0.3\n4 0.1 0.1 0.1\n"
      "5 0.1 -0.05 0.1\n$EndNodes\n$Elements\n2\n1 4 2 0 0 1 3 2 4\n2 4 2 0 0 1 2 3 5\n$EndElements\n");
  const double base = 0.045, half_x = 0.01, half_y = 0.03;
  const std::string held = "[[fixed]]\nbox = [[-1, -0.001, -1], [1, 0.001, 1]]\n[[load]]\n",
                    force = fmt::format("force = [{}, {}, 0]\n", 2 * half_x, 2 * half_y);
  for (const std::string region :
       {"box = [[0.05, -1, 0.05], [0.15, 1, 0.15]]\n", "center = [0.1, 0.025, 0.1]\nradius = 0.076\n"}) {
    CAPTURE(region);
    bench.solve(held + force + region, {"--probe", "0.1,0.1,0.1", "--probe", "0.1,-0.05,0.1"},
                "poisson_ratio = 0", "two.msh");
    for (const auto& [probe, h] : {std::pair("0.1,0.1,0.1", 0.1), std::pair("0.1,-0.05,0.1", 0.05)})
      bench.check_moved(probe, {6 * h * half_x / (kE * base), 3 * h * half_y / (kE * base), 0});
    const Place supports = bench.numbers("force of the supports");
    CHECK(supports[0] == Approx(-2 * half_x).epsilon(1e-7));
    CHECK(supports[1] == Approx(-2 * half_y).epsilon(1e-7));
  }
}

TEST_CASE("solve: an end that is displaced takes the bar along, and counts over what is fixed") {
  SolveBench bench;
  bench.solve(kFixed + "[[load]]\ndisplacement = [0, -0.02, 0]\naxes = \"y\"\nsurface_tag = \"top\"\n",
              kTwoProbes);
  bench.check_moved("0.03,0.4,0.07", {0, -0.02, 0});
  bench.check_moved("0.01,0.12,0.06", {0, -0.02 * 0.12 / kHeight, 0});
  CHECK(bench.numbers("elastic energy")[0] == Approx(kE * kArea * 0.02 * 0.02 / (2 * kHeight)).epsilon(1e-7));
  CHECK(bench.numbers("largest displacement")[0] == Approx(0.02).epsilon(1e-7));
  bench.solve(kFixed + "[[load]]\ndisplacement = [0.01, 0.02, -0.03]\nsurface_tag = \"bottom\"\n",
              kTwoProbes);
  bench.check_moved("0.03,0.4,0.07", {0.01, 0.02, -0.03});
}

TEST_CASE("solve: the .vtu has every array in its size, and its displacement is what is printed") {
  SolveBench bench;
  const double stress = 50, density = stress * stress / (2 * kE);
  for (const auto& [element, points] : {std::pair("p1", 20), std::pair("p2", 20 + 61)}) {
    CAPTURE(element);
    bench.solve(kFixed + fmt::format("[[load]]\ntraction = [0, {}, 0]\nsurface_tag = \"top\"\n", stress),
                {"--probe", "0.1,0.4,0.1"}, fmt::format("poisson_ratio = 0\nelement = \"{}\"", element));
    Vtu vtu(bench.out);
    CHECK(vtu.points == static_cast<std::size_t>(points));
    CHECK(vtu.cells == 24);
    const auto check_size = [](const Vtu::Array& array, int components, std::size_t count) {
      CHECK(array.components == components);
      REQUIRE(array.values.size() == static_cast<std::size_t>(components) * count);
    };
    check_size(vtu.at_points["displacement"], 3, vtu.points);
    check_size(vtu.places["Points"], 3, vtu.points);
    check_size(vtu.in_cells["stress"], 9, vtu.cells);
    check_size(vtu.in_cells["von_mises"], 1, vtu.cells);
    check_size(vtu.in_cells["energy_density"], 1, vtu.cells);
    check_size(vtu.in_cells["volume_ratio"], 1, vtu.cells);
    for (const double ratio : vtu.in_cells["volume_ratio"].values)
      CHECK(ratio == Approx(1 + stress / kE).epsilon(1e-8));
    const Place printed = bench.numbers("probe 0.1,0.4,0.1: displacement ");
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = 3 * 19 + i;  // the last corner
      CHECK(vtu.at_points["displacement"].values[at] == Approx(printed[i]).epsilon(1e-8).margin(1e-12));
      CHECK(vtu.places["Points"].values[at] ==
            Approx((i == 1 ? kHeight : 0.1) + printed[i]).epsilon(1e-8).margin(1e-12));
    }
    for (std::size_t cell = 0; cell < vtu.cells; ++cell) {
      for (std::size_t k = 0; k < 9; ++k)
        CHECK(vtu.in_cells["stress"].values[9 * cell + k] ==
              Approx(k == 4 ? stress : 0.0).epsilon(1e-7).margin(1e-6));
      CHECK(vtu.in_cells["von_mises"].values[cell] == Approx(stress).epsilon(1e-7));
      CHECK(vtu.in_cells["energy_density"].values[cell] == Approx(density).epsilon(1e-7));
    }
  }
}

TEST_CASE("solve: a series has about as many frames as asked for, each where the body is at its time") {
  SolveBench bench;
  const double amplitude = 0.01, period = 0.8;
  bench.solve("[[fixed]]\nsurface_tag = \"bottom\"\n[[fixed.motion]]\ndirection = [0, 0, 2]\n" +
                  fmt::format("amplitude = {}\nperiod = {}\n", amplitude, period),
              {"--seconds", "1", "--step", "0.05", "--series", bench.path("motion.pvd"), "--frames", "5"});
  const std::string list = bytes_of(bench.path("motion.pvd"));
  int frames = 0;
  for (std::size_t at = list.find("<DataSet"); at != std::string::npos; at = list.find("<DataSet", at + 1)) {
    const double time = 0.2 * frames;
    const std::string file = fmt::format("motion_{:04}.vtu", frames++);
    CAPTURE(list, time);
    CHECK(list.substr(at).starts_with(fmt::format("<DataSet timestep=\"{:.9g}\" file=\"{}\"/>", time, file)));
    Vtu vtu(bench.path(file));
    const double moved = amplitude * std::sin(2 * std::numbers::pi * time / period);
    const std::vector<double>& u = vtu.at_points["displacement"].values;
    REQUIRE(u.size() == 60);
    for (std::size_t v = 0; v < 4; ++v) {  // those of the bottom come first
      CHECK(u[3 * v] == 0);
      CHECK(u[3 * v + 2] == Approx(moved).epsilon(1e-9).margin(1e-15));
    }
  }
  CHECK(frames == 6);  // of 20 steps every fourth, and the beginning
  CHECK_FALSE(std::filesystem::exists(bench.path("motion_0006.vtu")));
}

TEST_CASE("solve: a probe outside the body is refused, with the vertex nearest to it") {
  SolveBench bench;
  const std::string load = kFixed + "[[load]]\ntraction = [0, 50, 0]\nsurface_tag = \"top\"\n";
  const std::string said = output_of("sim_server",
                                     bench.arguments(load, {"--probe", "0,0.4,0", "--probe", "0.1,0.45,0"},
                                                     "poisson_ratio = 0", "column.msh"),
                                     2);
  CHECK(said.find("--probe 0.1,0.45,0: outside the body at rest, whose nearest vertex is 0.1,0.4,0, 0.05 m "
                  "off") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(bench.out));
}

TEST_CASE("solve: the example of its help can be run, its probe is in the liver", "[large]") {
  const TemporaryFolder folder;
  const std::string scene = "configs/scenes/liver_weight.toml", place = "0.1,0.03,0.02";
  CHECK(output_of("sim_server", {"solve", "--help"}, 0)
            .find("sim_server solve " + scene + " --out liver.vtu --probe " + place) != std::string::npos);
  output_of("sim_server",
            {"solve", source_dir() + "/" + scene, "--out", (folder.path() / "liver.vtu").string(), "--probe",
             place},
            0);
}

TEST_CASE("solve: a tag that the mesh has not, and a region without a triangle, are refused") {
  SolveBench bench;
  const auto refused = [&](const std::string& sections) {
    return output_of("sim_server", bench.arguments(sections, {}, "poisson_ratio = 0", "column.msh"), 2);
  };
  CHECK(refused("[[fixed]]\nsurface_tag = \"botom\"\n").find("did you mean \"bottom\"") != std::string::npos);
  CHECK(refused(kFixed + "[[load]]\npressure = 1\ncenter = [0, 0.4, 0]\nradius = 0.01\n")
            .find("no triangle of the boundary") != std::string::npos);
  CHECK(refused(kFixed + "[[load]]\nforce = [0, 1, 0]\ncenter = [0, 1, 0]\nradius = 0.01\n")
            .find("no vertex of the mesh lies in this ball") != std::string::npos);
  for (const char* load : {"pressure = 1", "traction = [0, 1, 0]", "force = [0, 1, 0]"}) {
    CAPTURE(load);
    CHECK(refused(fmt::format("[[fixed]]\nsurface_tag = \"bottom\"\n[[load]]\n{}\nsurface_tag = \"bottom\"\n",
                              load))
              .find("would move nothing") != std::string::npos);
  }
}

TEST_CASE("solve: each support bears what it holds, also where supports share vertices on different axes") {
  // Held along y at the bottom, along x and z at two sides: free to swell, so that only the bottom bears.
  SolveBench bench;
  for (const char* element : {"p1", "p2"}) {
    bench.solve(
        "[[fixed]]\naxes = \"y\"\nsurface_tag = \"bottom\"\n"
        "[[fixed]]\naxes = \"x\"\nbox = [[-1, -1, -1], [0.0001, 1, 1]]\n"
        "[[fixed]]\naxes = \"z\"\nbox = [[-1, -1, -1], [1, 1, 0.0001]]\n"
        "[[load]]\ntraction = [0, 50, 0]\nsurface_tag = \"top\"\n",
        {}, fmt::format("poisson_ratio = 0.3\nelement = \"{}\"", element));
    CAPTURE(element, bench.said);
    const double entire = 50 * kArea;
    std::size_t at = bench.said.find("of [[fixed]]");
    for (const double bears : {-entire, 0.0, 0.0}) {
      REQUIRE(at != std::string::npos);
      Place force{};
      const std::string line = bench.said.substr(at, bench.said.find('\n', at) - at);
      const std::string numbers = line.substr(line.find(".toml:") + 6);
      REQUIRE(std::sscanf(numbers.c_str(), "%*d %lf %lf %lf", &force[0], &force[1], &force[2]) == 3);
      CHECK(force[1] == Approx(bears).margin(1e-6 * entire));
      CHECK(std::abs(force[0]) + std::abs(force[2]) < 1e-6 * entire);
      at = bench.said.find("of [[fixed]]", at + 1);
    }
  }
}
