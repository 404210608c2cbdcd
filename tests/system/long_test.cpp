// What takes minutes: `scripts/check --all` runs it, `scripts/test` does not.
#include <csignal>
#include <sys/resource.h>

#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// Resident memory of a running process, kB.
long resident_kb(const Process& process) {
  std::ifstream in("/proc/" + std::to_string(process.id()) + "/status");
  for (std::string word; in >> word;) {
    long kb = 0;
    if (word == "VmRSS:" && in >> kb) return kb;
  }
  return -1;
}

}  // namespace

#ifdef PALPATE_WITH_CAPTURE
/// The most any child of this process that has ended ever held, MB.
static long children_peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return usage.ru_maxrss / 1024;
}

TEST_CASE("a capture of 4 GB is replayed in flat memory", "[.long]") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "big.pcap").string();
  output_of("sim_server",
            {"record", kScene, "--trajectory", kClient, "--rate", "30", "--ticks", "20000", "--seconds",
             "1190", "--out", file},
            0, 300);
  CHECK(std::filesystem::file_size(file) > std::uintmax_t{4} << 30);
  const std::string said = output_of("haptic_client", {"replay", file, "--client", kClient}, 0, 300);
  CHECK(said.find("23800001 ticks at 20000 Hz") != std::string::npos);
  CHECK(children_peak_mb() < 100);
}
#endif

TEST_CASE("a session of ten minutes: memory stays flat, the paper's table is printed", "[.long]") {
  const TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  Server server;
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "600", "--report", report}));
  REQUIRE(client.wait_for(" 30.", 60));
  const long client_early = resident_kb(client), server_early = resident_kb(server.process);
  REQUIRE(client.wait_for(" 595.", 620));
  CHECK(resident_kb(client) <= client_early + 256);
  CHECK(resident_kb(server.process) <= server_early + 256);
  CHECK(client.wait() == 0);
  CHECK(client.output().find("paper: % of force on the line") != std::string::npos);
  CHECK(read_json(report)["tools"][0]["methods"]["constant"]["paper_mean_percent"].get<double>() > 0);
  WARN(client.output().substr(client.output().find("haptic_client: simulated")));
}
