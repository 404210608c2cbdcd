// Tissue that is cut over a network that loses datagrams, by a client that is killed and another that goes
// on.
#include <csignal>
#include <sstream>
#include <thread>

#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

const std::string kConfigs = source_dir() + "/configs/";
const std::string kRelay = "127.0.0.7:45137";

/// Of a table: the numbers of its last row under these names.
std::vector<double> last_row(const std::string& csv, const std::vector<std::string>& names) {
  std::istringstream in(csv);
  std::string head, line, last;
  std::getline(in, head);
  while (std::getline(in, line)) last = line;
  const auto cells = [](const std::string& row) {
    std::vector<std::string> all;
    std::istringstream text(row);
    for (std::string cell; std::getline(text, cell, ',');) all.push_back(cell);
    return all;
  };
  std::vector<double> found;
  for (const std::string& name : names) {
    const std::vector<std::string> titles = cells(head);
    const auto at = static_cast<std::size_t>(std::ranges::find(titles, name) - titles.begin());
    found.push_back(std::stod(cells(last).at(at)));
  }
  return found;
}

}  // namespace

TEST_CASE(
    "a liver is cut over a link that loses a tenth, by a client that is killed and another that goes on "
    "cutting",
    "[in_time]") {
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  Process server("sim_server", {"run", kConfigs + "scenes/liver_incision.toml", "--listen", "127.0.0.1:0",
                                "--report", file("server.json"), "--resection", file("cut.csv")});
  REQUIRE(server.wait_for("listening on ", 120));
  const std::string& said = server.output();
  const std::size_t begin = said.find("listening on ") + 13;
  const std::string address = said.substr(begin, said.find(' ', begin) - begin);
  Process relay("link_relay", {"--listen", kRelay, "--server", address, "--loss", "10", "--delay", "5"});
  REQUIRE(relay.wait_for("link_relay: from"));

  const auto client = [&](const char* seconds, const char* report) {
    return std::vector<std::string>{
        "run",       kConfigs + "clients/incision.toml", "--server", kRelay, "--seconds", seconds, "--report",
        file(report)};
  };
  Process first("haptic_client", client("60", "first.json"));
  REQUIRE(server.wait_for("a client took"));
  std::this_thread::sleep_for(std::chrono::seconds(6));  // it cuts
  first.signal(SIGKILL);
  first.wait();
  REQUIRE(server.wait_for("the client is gone", 5));
  Process second("haptic_client", client("8", "second.json"));
  CHECK(second.wait(60) == 0);
  server.signal(SIGINT);
  CHECK(server.wait() == 0);

  const Json report = read_json(file("server.json"));
  CHECK(report["sessions"] == 2);
  CHECK(report["failed_steps"]["other"] == 0);
  CHECK(report["failed_steps"]["out_of_memory"] == 0);
  const std::vector<double> cut = last_row(bytes_of(file("cut.csv")), {"t_s", "tetrahedra", "hot_s"});
  // The second one was hot, too, for most of its eight seconds of fourteen, however slow the steps are here.
  const double simulated = report["steps"].get<double>() / 30;
  CHECK(cut[0] > 0.8 * simulated);
  CHECK(cut[1] > 20);
  CHECK(cut[2] > 0.6 * simulated);
  const Json rendered = read_json(file("second.json"))["tools"][0];
  CHECK(rendered["force"]["max_newton"].get<double>() <= 8);
  CHECK(rendered["safety"]["not_finite"] == 0);
  CHECK(rendered["link"]["lost"].get<int>() > 5);
}
