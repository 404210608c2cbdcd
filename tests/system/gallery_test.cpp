// The scenes that come with Palpate and say what they need: each is touched live by the motion made for it,
// and a page sees its surface move.
#include "tests/support/gallery.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>

#include "tests/support/contract.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/web_page.h"

using namespace palpate::test;

namespace fs = std::filesystem;

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
  const auto published = page.next_text("scene");
  REQUIRE(published.is_object());
  REQUIRE(published["tools"].size() == scene.clients.size());
  Process clients("haptic_client", arguments);

  // Until each tool has touched, a force was told, and what deforms has moved by more than rounding.
  std::vector<bool> touched(scene.clients.size());
  double furthest = 0;
  const auto seen = [&] {
    return std::ranges::all_of(touched, std::identity()) &&
           (furthest > 2e-4 || published["model"] == "rigid") &&
           std::ranges::any_of(page.decoder.sample_forces, [](double newton) { return newton > 0.01; });
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(25);
  while (!seen() && std::chrono::steady_clock::now() < end) {
    const auto frame = page.next();
    REQUIRE(frame);
    const auto& rest = page.decoder.rest;
    for (std::size_t k = 0; page.decoder.surfaces > 0 && k < rest.size(); ++k)
      furthest = std::max(furthest, std::abs(page.decoder.positions[k] - static_cast<double>(rest[k])));
    if (frame->kind != 1) continue;
    const auto text = nlohmann::json::parse(frame->payload);
    if (!text.contains("state")) continue;
    const auto& tools = text["state"]["tools"];
    for (std::size_t k = 0; k < touched.size(); ++k)
      if (tools[k]["contact"] == true) touched[k] = true;
  }
  CAPTURE(touched, furthest, server.output(), clients.output());
  CHECK(seen());
  CHECK(page.decoder.triangles > 100);
  clients.signal(SIGINT);
  CHECK(clients.wait() == 0);
  server.signal(SIGINT);
  CHECK(server.wait() == 0);
}
#endif
