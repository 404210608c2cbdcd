#pragma once
/// The column of `column.h`, of 20 kPa and 1000 kg/m3, solved by the real program.
#include <array>
#include <cmath>
#include <cstdio>
#include <fmt/core.h>

#include "tests/support/catch.h"
#include "tests/support/column.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

namespace palpate::test {

inline constexpr double kE = 2e4, kHeight = 0.4, kArea = 0.01;

inline const std::string kFixed = "[[fixed]]\nsurface_tag = \"bottom\"\n";

/// A folder with the column, and what the program said of it last.
struct SolveBench {
  using Place = std::array<double, 3>;
  TemporaryFolder folder;
  std::string out = path("out.vtu"), said;
  SolveBench() { folder.write("column.msh", column(true)); }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  std::vector<std::string> arguments(const std::string& sections, const std::vector<std::string>& more,
                                     const std::string& material, const std::string& mesh) const {
    const std::string text = fmt::format(
        "[mesh]\nfile = \"{}\"\n[material]\nyoung_modulus = {}\n{}{}\n{}", mesh, kE,
        material.find("density") == std::string::npos ? "density = 1000\n" : "", material, sections);
    std::vector<std::string> all{"solve", folder.write("scene.toml", text).string(), "--out", out};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void solve(const std::string& sections, const std::vector<std::string>& more,
             const std::string& material = "poisson_ratio = 0", const std::string& mesh = "column.msh") {
    said = output_of("sim_server", arguments(sections, more, material, mesh), 0);
  }
  /// The numbers that were said after this.
  Place numbers(const std::string& after) const {
    CAPTURE(said, after);
    const std::size_t at = said.find(after);
    REQUIRE(at != std::string::npos);
    Place read{};
    REQUIRE(std::sscanf(said.c_str() + at + after.size(), " %lf %lf %lf", &read[0], &read[1], &read[2]) >= 1);
    return read;
  }
  void check_moved(const std::string& probe, const Place& expected) const {
    const Place moved = numbers("probe " + probe + ": displacement ");
    const double size = std::hypot(expected[0], expected[1], expected[2]);
    CAPTURE(probe);
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(moved[i] == Approx(expected[i]).epsilon(1e-7).margin(1e-6 * size));
  }
};

}  // namespace palpate::test
