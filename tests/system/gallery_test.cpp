// The scenes that come with Palpate and say what they need: each loads, is touched by the motion made for it,
// in virtual time and live, and a page sees its surface move.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>

#include "tests/support/contract.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/web_page.h"

using namespace palpate::test;

namespace {

namespace fs = std::filesystem;

/// A scene file with "# Needs: " in its head.
struct GalleryScene {
  std::string name, file, needs;
  std::vector<std::string> clients;  // those that it names
};

/// What stands in quotes after "clients = [" in a scene file of ours, from its folder.
std::vector<std::string> clients_in(const std::string& text, const fs::path& folder) {
  std::vector<std::string> clients;
  const std::size_t begin = text.find("clients = [");
  if (begin == std::string::npos) return clients;
  const std::size_t end = text.find(']', begin);
  for (std::size_t at = text.find('"', begin); at < end; at = text.find('"', at + 1)) {
    const std::size_t close = text.find('"', at + 1);
    clients.push_back((folder / text.substr(at + 1, close - at - 1)).lexically_normal().string());
    at = close;
  }
  return clients;
}

std::vector<GalleryScene> gallery() {
  std::vector<GalleryScene> scenes;
  const fs::path folder = fs::path(source_dir()) / "configs" / "scenes";
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string text = bytes_of(entry.path());
    const std::size_t needs = text.find("# Needs: ");
    if (needs == std::string::npos) continue;
    scenes.push_back({entry.path().stem().string(), entry.path().string(),
                      text.substr(needs + 2, text.find('\n', needs) - needs - 2), clients_in(text, folder)});
  }
  std::ranges::sort(scenes, {}, &GalleryScene::name);
  return scenes;
}

}  // namespace

TEST_CASE("gallery: the scenes that a newcomer is told of are there, with what each needs") {
  const auto said = output_of("sim_server", {"scenes"}, 0);
  const std::vector<GalleryScene> scenes = gallery();
  for (const char* name : {"block_fibres", "liver", "liver_big", "liver_breathing", "liver_lump",
                           "liver_two_tools", "minimal", "wall"}) {
    CAPTURE(name);
    CHECK(std::ranges::count(scenes, name, &GalleryScene::name) == 1);
  }
  for (const GalleryScene& scene : scenes) {
    CAPTURE(scene.name);
    CHECK(said.find("\n  " + scene.needs + "\n") != std::string::npos);
    REQUIRE_FALSE(scene.clients.empty());
    for (const std::string& client : scene.clients) {
      CHECK(fs::is_regular_file(client));
      CHECK(scene.needs.find(fs::path(client).filename()) != std::string::npos);
    }
  }
}

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

#ifdef PALPATE_WITH_VIEWER
CONTRACT("a scene of the gallery is felt, and seen by a page", GalleryScene, scene, gallery()) {
  Process server("sim_server", {"run", scene.file, "--listen", "127.0.0.1:0", "--viewer", "0"});
  REQUIRE(server.wait_for("listening on 127.0.0.1:", 60));
  const PageAddress address = PageAddress::of(server);
  const std::string said = server.output(), listening = "listening on ";
  const std::size_t begin = said.find(listening) + listening.size();
  std::vector<std::string> arguments{"run"};
  arguments.insert(arguments.end(), scene.clients.begin(), scene.clients.end());
  arguments.insert(arguments.end(),
                   {"--server", said.substr(begin, said.find(' ', begin) - begin), "--seconds", "30"});
  WebPage page(address);
  REQUIRE(page.open());
  page.hello();
  const auto told = page.next_text("scene");
  REQUIRE(told.is_object());
  REQUIRE(told["tools"].size() == scene.clients.size());
  Process clients("haptic_client", arguments);

  // Until each tool has touched, a force was told, and what deforms has moved by more than rounding.
  std::vector<bool> touched(scene.clients.size());
  double farthest = 0;
  const auto seen = [&] {
    return std::ranges::all_of(touched, std::identity()) && (farthest > 2e-4 || told["model"] == "rigid") &&
           std::ranges::any_of(page.decoder.sample_forces, [](double newton) { return newton > 0.01; });
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(25);
  while (!seen() && std::chrono::steady_clock::now() < end) {
    const auto frame = page.next();
    REQUIRE(frame);
    const auto& rest = page.decoder.rest;
    for (std::size_t k = 0; page.decoder.surfaces > 0 && k < rest.size(); ++k)
      farthest = std::max(farthest, std::abs(page.decoder.positions[k] - static_cast<double>(rest[k])));
    if (frame->kind != 1) continue;
    const auto text = nlohmann::json::parse(frame->payload);
    if (!text.contains("state")) continue;
    const auto& tools = text["state"]["tools"];
    for (std::size_t k = 0; k < touched.size(); ++k)
      if (tools[k]["contact"] == true) touched[k] = true;
  }
  CAPTURE(touched, farthest, server.output(), clients.output());
  CHECK(seen());
  CHECK(page.decoder.triangles > 100);
  clients.signal(SIGINT);
  CHECK(clients.wait() == 0);
  server.signal(SIGINT);
  CHECK(server.wait() == 0);
}
#endif
