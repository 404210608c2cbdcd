// Another scene that a page chooses, of the real server: those that cannot be served do not end it.
#ifdef PALPATE_WITH_VIEWER
#include <algorithm>
#include <csignal>

#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/web_page.h"

using namespace palpate::test;

namespace fs = std::filesystem;

namespace {

/// A scene of the gallery, with the mesh at `mesh`.
std::string scene_on(const std::string& title, const std::string& mesh) {
  return "# A scene.\n# Needs: nothing.\ntitle = \"" + title + "\"\n[mesh]\nfile = \"" + mesh +
         "\"\n[[fixed]]\nbox = [[-0.031, -0.0401, -0.031], [0.031, -0.0399, 0.031]]\n[material]\n"
         "young_modulus = 48e3\npoisson_ratio = 0.45\n[deformation]\nmodel = \"quasi_static\"\n[[tool]]\n";
}

}  // namespace

TEST_CASE("choice: a scene that is wrong is told of, and the one before goes on") {
  const TemporaryFolder folder;
  const fs::path scenes = folder.path() / "share/palpate/scenes";
  fs::create_directories(folder.path() / "bin"), fs::create_directories(scenes);
  const fs::path program = folder.path() / "bin" / "sim_server";
  fs::copy_file(fs::path(bin_dir()) / "sim_server", program);
  const std::string mesh = source_dir() + "/configs/meshes/block.msh";
  std::ofstream(scenes / "good.toml") << scene_on("Good", mesh);
  std::ofstream(scenes / "other.toml") << scene_on("Other", mesh);
  std::ofstream(scenes / "unreadable.toml") << "# Needs: nothing.\ntitle = \"Unreadable\"\nnonsense = 1\n";
  const std::string no_mesh = folder.write("none.msh", "no mesh").string();
  std::ofstream(scenes / "unbuildable.toml") << scene_on("Unbuildable", no_mesh);
  const auto called = fs::relative(program, bin_dir()).string();
  Process server(called, {"run", (scenes / "good.toml").string(), "--listen", "127.0.0.1:0", "--viewer", "0",
                          "--cache", (folder.path() / "cache").string()});
  const PageAddress address = PageAddress::of(server);

  WebPage page(address);
  page.hello(address.token);
  page.say(R"({"choose": "unreadable"})");
  REQUIRE(server.wait_for("unreadable.toml"));
  REQUIRE(server.wait_for("this scene goes on"));
  CHECK(page.next_text("state").is_object());  // it was never closed
  CHECK(server.running());

  page.say(R"({"choose": "unbuildable"})");
  REQUIRE(server.wait_for("good.toml comes back)", 30));
  CHECK(server.output().find("none.msh") != std::string::npos);
  const auto ready = [&](const std::string& title) {
    const std::string& said = server.output();
    const std::size_t back = said.find("comes back)");
    return back != std::string::npos && said.find("\"" + title + "\" ready", back) != std::string::npos;
  };
  for (int k = 0; k < 300 && !ready("Good"); ++k) server.wait_for("what is never said", 0.1);
  REQUIRE(ready("Good"));
  WebPage again(address);
  again.hello(address.token);
  CHECK(again.next_text("scene")["title"] == "Good");
  again.say(R"({"choose": "other"})");
  REQUIRE(server.wait_for("\"Other\" ready", 30));
  server.signal(SIGINT);
  CHECK(server.wait() == 0);
}
#endif
