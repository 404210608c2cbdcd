// The scenes that come with Palpate and say what they need: each loads, and is touched in virtual time by the
// motion made for it.
#include "tests/support/gallery.h"

#include "tests/support/contract.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

#ifdef PALPATE_WITH_CAPTURE
CONTRACT("a scene of the gallery is touched in virtual time", GalleryScene, scene, gallery()) {
  const TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  std::vector<std::string> arguments{"record", scene.file, "--rate", "30", "--seconds", "8", "--plain"};
  for (const std::string& client : scene.clients) arguments.insert(arguments.end(), {"--trajectory", client});
  arguments.insert(arguments.end(), {"--report", report, "--out", (folder.path() / "F.pcap").string()});
  output_of("sim_server", arguments, 0, 100);
  const auto figures = read_json(report);
  CHECK(figures["contact_steps"].get<int>() > 10);
  CHECK(figures["flagged"] == 0);
  CHECK(figures["max_newton"].get<double>() > 0.05);
  CHECK(figures["max_newton"].get<double>() < 20);
}
#endif
