// A capture in the live page, and the scenes that come along, by the real program.
#ifdef PALPATE_WITH_VIEWER
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fmt/core.h>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/session_capture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/web_page.h"

using namespace palpate::test;

namespace {

#ifdef PALPATE_WITH_CAPTURE
/// What `/session` holds.
struct PlayedSession {
  std::vector<nlohmann::json> texts;
  PageDecoder page;
  std::vector<double> times, entire_at;
  double furthest = 0;  // that a vertex was from rest, m

  explicit PlayedSession(const std::string& bytes) {
    std::size_t at = 0;
    while (at < bytes.size()) {
      REQUIRE(bytes.size() - at >= 16);
      std::uint32_t size = 0;
      double t = 0;
      std::memcpy(&size, bytes.data() + at, 4);
      std::memcpy(&t, bytes.data() + at + 8, 8);
      const std::string record = bytes.substr(at + 16, size);
      REQUIRE(record.size() == size);
      if (bytes[at + 4] == 0) {
        texts.push_back(nlohmann::json::parse(record));
      } else {
        take(record, t);
      }
      REQUIRE((times.empty() || t >= times.back()));
      times.push_back(t);
      at += 16 + size;
    }
  }
  void take(const std::string& record, double t) {
    const std::size_t entire = page.entire_ones;
    page.take(std::as_bytes(std::span(record)));
    if (page.entire_ones > entire) entire_at.push_back(t);
    if (record[0] != 2) return;
    for (std::size_t k = 0; k < page.rest.size(); ++k)
      furthest = std::max(furthest, std::abs(page.positions[k] - static_cast<double>(page.rest[k])));
  }
};

/// Of `view`, ended when it was asked for the session.
struct Viewed {
  std::string scene, session, said;
  explicit Viewed(const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"view"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--viewer", "0"});
    Process process("sim_server", all);
    const PageAddress address = PageAddress::of(process, "Ctrl-C ends it");
    const std::string answer =
        answer_to(address.port, "GET /session HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    session = answer.substr(std::min(answer.size(), answer.find("\r\n\r\n") + 4));
    WebPage page(address);
    page.hello();
    scene = page.next_text("scene").dump();
    CHECK_FALSE(page.next(0.3));  // all else stands in the session
    process.signal(SIGINT);
    CHECK(process.wait() == 0);
    said = process.output();
  }
};
#endif

}  // namespace

#ifdef PALPATE_WITH_CAPTURE
TEST_CASE("view: a capture with its scene is stepped again, to the same forces") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "a.pcap").string(), report = (folder.path() / "a.json").string();
  output_of("sim_server",
            {"record", kScene, "--trajectory", kClient, "--rate", "30", "--delay-ms", "35", "--seconds", "10",
             "--out", file, "--report", report},
            0);
  const auto recorded = read_json(report);
  const Viewed viewed({file, "--scene", kScene});
  const PlayedSession played(viewed.session);
  CHECK(nlohmann::json::parse(viewed.scene)["recorded"] == true);
  CHECK(played.texts[0]["scene"]["recorded"] == true);
  CHECK(played.texts[0]["scene"]["title"] == "Palpate a liver on the mesh of 1999");
  const auto samples = recorded["force_samples"].get<std::size_t>();
  CHECK(played.page.sample_forces.size() == samples);
  CHECK(played.page.surfaces == samples);
  CHECK(*std::ranges::max_element(played.page.sample_forces) ==
        Approx(recorded["max_newton"].get<double>()).epsilon(1e-5));
  CHECK(played.furthest > 1e-3);
  for (std::size_t k = 1; k < played.entire_at.size(); ++k)
    CHECK(played.entire_at[k] - played.entire_at[k - 1] <= 1);
  CHECK(played.entire_at.size() >= 10);
  CHECK(played.texts.back()["state"]["step"] == samples);
  CHECK(viewed.said.find("stepped again") != std::string::npos);
  CHECK(viewed.said.find("is it the scene") == std::string::npos);

  // Another scene is not taken for it.
  const std::string other = source_dir() + "/configs/scenes/liver_tensor_mass.toml";
  const std::string refused =
      output_of("sim_server", {"view", file, "--scene", other, "--viewer", "0", "--seconds", "1"}, 2);
  CHECK(refused.find("was recorded of another scene, which differs by: ") != std::string::npos);
  CHECK(refused.find("model") != std::string::npos);

  // Without one there is no organ, but tools and forces.
  const PlayedSession bare(Viewed({file}).session);
  CHECK(bare.page.surfaces == 0);
  CHECK(bare.page.sample_forces == played.page.sample_forces);
  CHECK(bare.texts.back()["state"]["tools"].size() == 1);
}

TEST_CASE("view: each tool has the radius of its own session, and no session may be of another scene") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  {
    CaptureOf capture(file);
    capture.welcome({.tool = 0, .tool_radius = 0.008, .scene = {.mesh = 1}}, 7, 5000);
    capture.welcome({.tool = 1, .tool_radius = 0.003}, 8, 6000);
    for (std::uint64_t n = 1; n <= 20; ++n) {
      const auto t = static_cast<std::int64_t>(n) * 10'000'000;
      if (n <= 10) capture.sample({.tool = 0, .number = n, .tool_t_ns = t}, n + 1, 7, 5000);
      capture.sample({.tool = 1, .number = n, .tool_t_ns = t}, n + 1, 8, 6000);
    }
    capture.close();
  }
  const auto tools = nlohmann::json::parse(Viewed({file.string()}).scene)["tools"];
  REQUIRE(tools.size() == 2);
  CHECK(tools[0]["radius"] == 0.008);
  CHECK(tools[1]["radius"] == 0.003);
  const std::string scene = source_dir() + "/configs/scenes/wall.toml";
  const std::string refused = output_of(
      "sim_server", {"view", file.string(), "--scene", scene, "--viewer", "0", "--seconds", "1"}, 2);
  CHECK(refused.find("was recorded of another scene, which differs by: mesh") != std::string::npos);
  CHECK(refused.find("(its session of 0.1 s with tool 1)") != std::string::npos);
}

TEST_CASE("view: what is no capture of a session is told in one line") {
  const TemporaryFolder folder;
  const std::string none = folder.write("none.pcap", "nothing").string();
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"view", none, "--viewer", "0"},
                                                    {"view", "absent.pcap", "--viewer", "0"},
                                                    {"view", none, "--viewer", "off"}}) {
    const auto said = output_of("sim_server", arguments, 2);
    CHECK(std::ranges::count(said, '\n') == 1);
  }
}
#endif

TEST_CASE("scenes: the gallery is found beside an installed program as in the source") {
  const auto said = output_of("sim_server", {"scenes"}, 0);
  namespace fs = std::filesystem;
  for (const auto& entry : fs::directory_iterator(fs::path(source_dir()) / "configs" / "scenes")) {
    const bool published =
        said.find(fmt::format("\n{}: ", entry.path().stem().string())) != std::string::npos;
    CAPTURE(entry.path());
    CHECK(published == (bytes_of(entry.path()).find("\n# Needs: ") != std::string::npos));
  }
  CHECK(said.find("wall: A stiff wall\n  A stiff wall: nothing deforms") != std::string::npos);

  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "bin");
  fs::create_directories(folder.path() / "share/palpate/scenes");
  const auto program = folder.path() / "bin" / "sim_server";
  const auto called = fs::relative(program, bin_dir()).string();
  fs::copy_file(fs::path(bin_dir()) / "sim_server", program);
  const auto installed = output_of(called, {"scenes"}, 2);
  CHECK(std::ranges::count(installed, '\n') == 1);
  std::ofstream(folder.path() / "share/palpate/scenes/mine.toml")
      << "# Of mine.\n# Needs: it.\ntitle = \"Mine\"\n";
  std::ofstream(folder.path() / "share/palpate/scenes/test.toml") << "# Of a test.\ntitle = \"Test\"\n";
  const auto published = output_of(called, {"scenes"}, 0);
  CHECK(published.find("mine: Mine\n  Of mine.\n  Needs: it.\n") != std::string::npos);
  CHECK(published.find("Of a test") == std::string::npos);
}

#endif
