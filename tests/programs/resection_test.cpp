// The shipped scenes in which tissue is cut, in virtual time, and their tables.
#ifdef PALPATE_WITH_CAPTURE
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

/// Columns of a table by their titles.
std::map<std::string, std::vector<double>> columns_of(const std::string& file) {
  std::istringstream in(bytes_of(file));
  std::vector<std::string> titles;
  std::string line, cell;
  std::getline(in, line);
  for (std::istringstream row(line); std::getline(row, cell, ',');) titles.push_back(cell);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(in, line)) {
    std::size_t at = 0;
    for (std::istringstream row(line); std::getline(row, cell, ',');)
      columns[titles.at(at++)].push_back(cell.empty() ? std::nan("") : std::stod(cell));
    REQUIRE(at == titles.size());
  }
  return columns;
}

void check_never_falls(const std::vector<double>& values) {
  CHECK(std::ranges::is_sorted(values));
}

std::vector<std::string> recording_of(const std::string& scene, const std::vector<std::string>& clients,
                                      const std::string& seconds, const std::string& out) {
  const std::string configs = source_dir() + "/configs/";
  std::vector<std::string> arguments{
      "record", configs + "scenes/" + scene, "--rate", "30", "--seconds", seconds, "--out", out};
  for (const std::string& client : clients)
    arguments.insert(arguments.end(), {"--trajectory", configs + "clients/" + client});
  return arguments;
}

}  // namespace

TEST_CASE("hepatic_resection.toml: a hot tip cuts along the plan, as the table says, and the list again") {
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  std::vector<std::string> first =
      recording_of("hepatic_resection.toml", {"resection.toml", "lobe.toml"}, "3", file("a.pcap"));
  std::vector<std::string> again =
      recording_of("hepatic_resection.toml", {"resection.toml", "lobe.toml"}, "3", file("b.pcap"));
  first.insert(first.end(), {"--resection", file("a.csv"), "--removals", file("list.csv")});
  again.insert(again.end(), {"--resection", file("b.csv"), "--remove", file("list.csv")});
  output_of("sim_server", first, 0);
  output_of("sim_server", again, 0);

  auto a = columns_of(file("a.csv")), b = columns_of(file("b.csv"));
  REQUIRE(a["t_s"].size() > 60);
  std::erase_if(a["farthest_mm"], [](double distance) { return std::isnan(distance); });  // of nothing yet
  for (const char* const title : {"t_s", "tetrahedra", "removed_ml", "cut_area_cm2", "farthest_mm", "heat_J",
                                  "elastic_J", "kinetic_J", "hot_s", "contact_s"}) {
    CAPTURE(title);
    if (title != std::string("cut_area_cm2")) check_never_falls(a[title]);
    CHECK(a[title].back() > 0);
  }
  CHECK(a["tetrahedra"].back() > 100);
  // [cutting] of the scene: 100 W, 2.6e8 J/m3, nothing beyond 15 mm from the plan, centres of tetrahedra.
  CHECK(a["heat_J"].back() == Approx(100 * a["hot_s"].back()).epsilon(1e-3));
  CHECK(1e-6 * a["removed_ml"].back() * 2.6e8 <= a["heat_J"].back());
  CHECK(a["farthest_mm"].back() < 15);
  CHECK(a["mean_distance_mm"].back() < a["farthest_mm"].back());
  CHECK(a["contact_s"].back() <= a["t_s"].back());
  CHECK(b["tetrahedra"].back() == a["tetrahedra"].back());
  CHECK(b["removed_ml"].back() == a["removed_ml"].back());
  CHECK(b["force_N"] == a["force_N"]);

  // The same list, of a mesh whose 20th tetrahedron to go is a micrometre away.
  std::ifstream in(file("list.csv"));
  std::string text, line;
  for (int row = 0; std::getline(in, line); ++row) {
    const std::size_t z = line.rfind(',') + 1;
    if (row == 20) line = line.substr(0, z) + std::to_string(std::stod(line.substr(z)) + 1e-6);
    text += line + "\n";
  }
  folder.write("list.csv", text);
  const std::string said = output_of("sim_server", again, 2);
  CHECK(said.find("list.csv: is of another mesh: data row 20 ") != std::string::npos);
}

TEST_CASE(
    "a list of removals that is none is told before anything is set up, one of another scene by its row") {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& text) {
    std::vector<std::string> arguments =
        recording_of("liver_incision.toml", {"incision.toml"}, "1", (folder.path() / "a.pcap").string());
    arguments.insert(arguments.end(), {"--remove", folder.write("list.csv", text).string()});
    return output_of("sim_server", arguments, 2);
  };
  const std::string head = "t_s,tetrahedron,x_m,y_m,z_m\n";
  for (const char* const rows : {"0,-1,0,0,0\n", "0,0.5,0,0,0\n", "1,7,0,0,0\n0,8,0,0,0\n"}) {
    CAPTURE(rows);
    const std::string said = error_of(head + rows);
    CHECK(said.find("list.csv: ") != std::string::npos);
    CHECK(said.find("reading the mesh") == std::string::npos);
  }
  CHECK(error_of(head + "0,99999999,0,0,0\n")
            .find("data row 1 names tetrahedron 99999999, and the mesh has 0 to ") != std::string::npos);
  // Nothing tells a list without places, which an older version wrote, from one of another mesh.
  const std::string old = error_of("t_s,tetrahedron\n0,7\n");
  CHECK(old.find("list.csv: has no columns x_m, y_m and z_m, m") != std::string::npos);
  CHECK(old.find("make it again: `sim_server record ... --removals FILE`") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder.path() / "a.pcap"));
}

TEST_CASE("liver_scalpel.toml: a blade parts a lobe, and another tool pulls it away") {
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  std::vector<std::string> arguments =
      recording_of("liver_scalpel.toml", {"scalpel.toml", "traction.toml"}, "6", file("a.pcap"));
  arguments.insert(arguments.end(), {"--resection", file("a.csv")});
  output_of("sim_server", arguments, 0);

  auto table = columns_of(file("a.csv"));
  REQUIRE(!table["t_s"].empty());
  CHECK(table["removed_ml"].back() == 0);
  CHECK(table["pieces_loose"].back() == 1);
  check_never_falls(table["parted_cm2"]);
  CHECK(table["parted_cm2"].back() > 5);
  CHECK(table["cut_area_cm2"].back() == Approx(2 * table["parted_cm2"].back()).epsilon(0.01));  // both sides
  CHECK(table["mean_parted_distance_mm"].back() < 5);
  const std::vector<double>& force = table["force_N"];
  CHECK(*std::ranges::max_element(force) > 0.5);
  CHECK(force.back() < 0.2 * *std::ranges::max_element(force));  // the lobe came away
}
#endif
