#ifdef PALPATE_WITH_CAPTURE
// What a session is told about the whole error of its force, before and after a study of its scene: the real
// programs, virtual time.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/support/column.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

struct PressedColumn {
  TemporaryFolder folder;
  std::string cache = (folder.path() / "cache").string(), scene, said;

  PressedColumn() {
    folder.write("column.msh", column());
    folder.write("motion.csv", "t_s,x_m,y_m,z_m\n0,0.05,0.45,0.05\n1,0.05,0.42,0.05\n2,0.05,0.45,0.05\n");
    scene = folder
                .write("scene.toml",
                       "rate_hz = 30\n[mesh]\nfile = \"column.msh\"\n[material]\nyoung_modulus = "
                       "2e4\npoisson_ratio = 0.3\n[[fixed]]\nbox = [[-1, -1, -1], [1, 0.001, "
                       "1]]\n[[tool]]\nradius = 0.03\n[deformation]\nmodel = \"quasi_static\"\n")
                .string();
  }
  /// What the report of a client says of the force it felt.
  Json rendered() {
    const std::string capture = (folder.path() / "c.pcap").string(),
                      report = (folder.path() / "report.json").string();
    output_of("sim_server",
              {"record", scene, "--trajectory", (folder.path() / "motion.csv").string(), "--rate", "30",
               "--out", capture, "--force", "--cache", cache},
              0);
    said = output_of("haptic_client",
                     {"replay", capture, "--client", kClient, "--method", "two_tangents", "--report", report,
                      "--out", (folder.path() / "trace.csv").string()},
                     0);
    return read_json(report)["tools"][0]["rendered"];
  }
  /// The mean of a column of the trace over its rows where what was written to the device or the force it is
  /// held against pushes, % of the root mean square of that force in contact.
  double error_in_trace(const std::string& column) {
    std::ifstream file(folder.path() / "trace.csv");
    std::string line, cell;
    std::getline(file, line);
    std::vector<std::string> names;
    for (std::istringstream row(line); std::getline(row, cell, ',');) names.push_back(cell);
    const auto at = [&](const std::string& name) {
      return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    };
    double error = 0, squared = 0, pushes = 0, touches = 0;
    while (std::getline(file, line)) {
      std::vector<std::string> cells;
      for (std::istringstream row(line); std::getline(row, cell, ',');) cells.push_back(cell);
      const auto number = [&](const std::string& name) { return std::stod(cells[at(name)]); };
      if (cells[at("reference_n")].empty()) continue;
      const double force = number("reference_n");
      const double written = std::hypot(number("fx_n"), number("fy_n"), number("fz_n"));
      error += number(column);
      squared += force * force;
      pushes += force > 0 || written > 0 ? 1 : 0;
      touches += force > 0 ? 1 : 0;
    }
    return 100 * error / pushes / std::sqrt(squared / touches);
  }
};

}  // namespace

TEST_CASE("whole error: estimated, then measured by a study, with the extrapolation beside it", "[large]") {
  PressedColumn pressed;
  Json rendered = pressed.rendered();
  // Edges of 0.1 m under a radius of 0.03 m: less than 0.4 elements, the end of the table of linear ones.
  CHECK(rendered["mesh_percent"] == 189);
  CHECK(rendered["motion_percent"] == 0);
  CHECK(rendered["extrapolation_percent"].get<double>() > 0);
  CHECK(rendered["extrapolation_percent"].get<double>() == Approx(pressed.error_in_trace("extrapolation_n")));
  const double hand = pressed.error_in_trace("error_n");
  CHECK(rendered["hand_percent"].get<double>() == Approx(hand));
  CHECK(rendered["total_percent"].get<double>() == Approx(189 + hand));
  CHECK_THAT(rendered["how"]["mesh"].get<std::string>(),
             Catch::StartsWith("estimated, by elements to a radius of the tool or by presses"));
  CHECK_THAT(rendered["how"]["motion"].get<std::string>(), Catch::StartsWith("none"));
  CHECK_THAT(pressed.said, Catch::Contains("mesh              189   estimated"));

  const std::string out = (pressed.folder.path() / "out").string();
  output_of("sim_server",
            {"study", pressed.scene, "--trajectory", (pressed.folder.path() / "motion.csv").string(), "--out",
             out, "--quick", "--cache", pressed.cache},
            0, 120);
  rendered = pressed.rendered();
  CHECK_THAT(rendered["how"]["mesh"].get<std::string>(), Catch::StartsWith("measured by a study"));
  // At rest no step is too long, so that all that the study finds of the scene comes from its mesh; told is
  // what the shortest steps found, which look at the motion most often.
  const Json summary = read_json(out + "/summary.json");
  const Json *own = nullptr, *shortest = nullptr;
  const auto alike = [](const Json& a, const Json& b) {
    return std::ranges::all_of(std::array{"model", "law", "element", "mesh", "refinements"},
                               [&](const char* key) { return a[key] == b[key]; });
  };
  for (const Json& row : summary["rows"]) own = row["axis"] == "scene" ? &row : own;
  REQUIRE(own != nullptr);
  for (const Json& row : summary["rows"]) {
    if (alike(row, *own) && (shortest == nullptr || row["dt_ms"] < (*shortest)["dt_ms"])) shortest = &row;
  }
  CHECK(rendered["mesh_percent"] == Approx((*shortest)["force_error_percent"].get<double>()));
}
#endif
