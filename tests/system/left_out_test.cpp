// What minimal scenes build and start, by the real program: parts, bytes and threads; and that what is left
// out is not in resident memory either. Each later feature adds its row.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

const std::string kScenes = source_dir() + "/configs/scenes/";

/// A liver by some model, without anything that it does not need.
std::string minimal(const std::string& model, const std::string& more = "") {
  std::string text = "[mesh]\nfile = \"" + kScenes +
                     "../meshes/liver_paper.msh\"\n[deformation]\nmodel = \"" + model + "\"\n" + more +
                     "[[tool]]\nradius = 0.005\n";
  if (model != "rigid")
    text +=
        "[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.4\n"
        "[[fixed]]\nbox = [[-0.11, -0.08, -0.10], [0.11, 0.10, -0.060]]\n";
  return text;
}

Json explained(const std::string& scene) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "explain.json").string();
  Process process("sim_server", {"explain", "--no-cache", scene, "--json", file});
  CHECK(process.wait(120) == 0);
  CAPTURE(process.output());
  return read_json(file);
}

std::set<std::string> parts_of(const Json& explanation) {
  std::set<std::string> parts;
  for (const Json& row : explanation["built"]) {
    if (row["bytes"].get<long>() > 0) parts.insert(row["part"].get<std::string>());
  }
  return parts;
}

/// And be it for set-up alone.
bool was_built(const Json& explanation, const std::string& part) {
  const Json& rows = explanation["built"];
  return std::any_of(rows.begin(), rows.end(), [&](const Json& row) { return row["part"] == part; });
}

/// A server that waits for somebody.
struct Waiting {
  Process process;
  Waiting(const std::string& scene, std::vector<std::string> more = {})
      : process("sim_server", [&] {
          std::vector<std::string> all{"run",         "--no-cache", scene, "--listen",
                                       "127.0.0.1:0", "--seconds",  "30"};
          all.insert(all.end(), more.begin(), more.end());
          return all;
        }()) {
    REQUIRE(process.wait_for("listening"));
  }
  std::string proc(const std::string& name) const {
    return "/proc/" + std::to_string(process.id()) + "/" + name;
  }
  /// By name: those that the program names, and how many others, which wait in libraries.
  std::pair<std::multiset<std::string>, unsigned> threads() const {
    std::multiset<std::string> named;
    unsigned others = 0;
    for (const auto& task : std::filesystem::directory_iterator(proc("task"))) {
      std::ifstream file(task.path() / "comm");
      std::string name;
      std::getline(file, name);
      if (name.starts_with("palpate-")) {
        named.insert(name);
      } else {
        ++others;
      }
    }
    return {named, others};
  }
  /// As soon as these are named, as a thread takes its name only once it runs; or what is there after two
  /// seconds.
  std::pair<std::multiset<std::string>, unsigned> threads(const std::multiset<std::string>& expected) const {
    for (int looks = 0; looks < 200 && threads().first != expected; ++looks)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return threads();
  }
  /// bytes
  long resident() const {
    std::ifstream file(proc("statm"));
    long all = 0, resident = 0;
    file >> all >> resident;
    return resident * 4096;
  }
};

}  // namespace

TEST_CASE("left out: a minimal scene has these parts in memory, and no other") {
  using Parts = std::set<std::string>;
  struct Row {
    std::string model;
    Parts own;
    double most;  // bytes
    std::string keys = {};
  };
  const std::string kTold = "motion told to clients", kUntold = "client_modes = 0\n";
  // Of 1387 vertices (1329 free), 621 on the surface (566 free), 6254 tetrahedra, 7907 edges: the mesh takes
  // 0.15 MB, the contact of one tool without friction 1.43 MB, compliance 72 x 566^2 = 23.1 MB, tensors 72 a
  // vertex and edge, motion 216 a vertex, 40 modes 3 x 8 x 40 of the surface's. Tissue in implicit motion:
  // some 400 a tetrahedron for elements, and its factor. What clients are told of a motion: compliance once
  // more, 40 modes of all vertices.
  const std::vector<Row> rows{
      {"rigid", {"rest_positions"}, 1.7e6},
      {"quasi_static", {"positions", "compliance"}, 24.8e6},
      {"tensor_mass", {"positions", "tensors", "motion", "compliance"}, 26e6, kUntold},
      {"implicit", {"positions", "elements", "motion", "compliance"}, 17e6, kUntold},
#ifdef PALPATE_WITH_SPECTRA
      {"tensor_mass", {"positions", "tensors", "motion", "compliance", kTold}, 51e6},
      {"implicit", {"positions", "elements", "motion", "compliance", kTold}, 42e6},
      {"reduced", {"positions", "compliance", "modes"}, 25.5e6},
#endif
  };
  const TemporaryFolder folder;
  for (const auto& [model, own, most, keys] : rows) {
    DYNAMIC_SECTION(model << " " << keys) {
      Parts expected = own;
      expected.insert({"mesh", "surface", "contact"});
      const Json explanation = explained(folder.write("scene.toml", minimal(model, keys)).string());
      CHECK(parts_of(explanation) == expected);
      CHECK(explanation["bytes"].get<double>() < most);
      const bool factors = model != "rigid" && (model != "tensor_mass" || keys.empty());
      for (const char* part : {"stiffness matrix", "its factor"})
        CHECK(was_built(explanation, part) == factors);
    }
  }
}

TEST_CASE(
    "left out: a server starts two threads, one more to record or for the page, and asks a quiet scene for "
    "no other") {
  const TemporaryFolder folder;
  const std::multiset<std::string> two{"palpate-net", "palpate-sim"};
  const unsigned cores = std::thread::hardware_concurrency();
  for (const char* model : {"rigid", "quasi_static", "tensor_mass", "implicit"}) {
    DYNAMIC_SECTION(model) {
      const Waiting server(folder.write("scene.toml", minimal(model)).string());
      const auto [named, others] = server.threads(two);
      CHECK(named == two);
      // `main`, and what oneTBB and OpenBLAS keep for the other cores.
      CHECK(others <= 1 + 2 * (cores - 1));
    }
  }
#ifdef PALPATE_WITH_VIEWER
  SECTION("with the live page") {
    const Waiting server(folder.write("scene.toml", minimal("rigid")).string(), {"--viewer", "0"});
    auto three = two;
    three.insert("palpate-view");
    CHECK(server.threads(three).first == three);
  }
#endif
#ifdef PALPATE_WITH_CAPTURE
  SECTION("recording") {
    const Waiting server(folder.write("scene.toml", minimal("rigid")).string(),
                         {"--record", (folder.path() / "session.pcap").string()});
    auto three = two;
    three.insert("palpate-record");
    CHECK(server.threads(three).first == three);
  }
#endif
}

TEST_CASE("left out: of a tool that reaches nothing is told when the server starts, and of no other") {
  const TemporaryFolder folder;
  const std::string away = "[[tool]]\nreach = [[5, 5, 5], [6, 6, 6]]\n";
  Waiting both(folder.write("scene.toml", minimal("rigid") + away).string());
  const std::string& said = both.process.output();
  CAPTURE(said);
  CHECK(said.find("tool 2 reaches no part of the surface") != std::string::npos);
  CHECK(said.find("tool 1 reaches no part") == std::string::npos);
  CHECK(said.find("scene.toml:8") != std::string::npos);
}

TEST_CASE("left out: a tool that goes beyond its workspace is told of, and counted") {
  const TemporaryFolder folder;
  const std::string report = (folder.path() / "server.json").string();
  for (const bool wide : {true, false}) {
    CAPTURE(wide);
    const std::string box = wide ? "[[-1, -1, -1], [1, 1, 1]]" : "[[-0.01, 0, -0.01], [0.01, 0.02, 0.01]]";
    const auto scene =
        folder.write("scene.toml", minimal("quasi_static") + "[tool.workspace]\nbox = " + box + "\n");
    Server server({"--report", report}, "127.0.0.1:0", scene.string());
    Process client("haptic_client", client_arguments(server.address, {"--seconds", "2"}));
    CHECK(client.wait() == 0);
    server.process.signal(SIGINT);
    CHECK(server.process.wait() == 0);
    CHECK((server.process.output().find("tool 1 went beyond this") == std::string::npos) == wide);
    CHECK((read_json(report)["tools"][0]["beyond_steps"].get<int>() == 0) == wide);
  }
}

TEST_CASE("left out: what a workspace leaves out is not in resident memory either") {
  const std::string whole = kScenes + "liver_paper.toml", some = kScenes + "liver_falcon.toml";
  const long saved = explained(whole)["bytes"].get<long>() - explained(some)["bytes"].get<long>();
  CHECK(saved > 5'000'000);
  const long resident = Waiting(whole).resident() - Waiting(some).resident();
  CAPTURE(saved, resident);
  CHECK(10 * resident > 7 * saved);
}

TEST_CASE("explain --why names the line that asks for a part, or leaves it out") {
  const auto why = [](const std::string& part) {
    Process process("sim_server", {"explain", "--no-cache", kScenes + "liver_falcon.toml", "--why", part});
    const int code = process.wait(120);
    return std::pair(code, process.output());
  };
  const auto [built, line] = why("compliance");
  CHECK(built == 0);
  CHECK(line.find("model = \"quasi_static\"") != std::string::npos);
  CHECK(line.find("liver_falcon.toml:22") != std::string::npos);
  const auto [left, out] = why("the surface out of reach");
  CHECK(left == 0);
  CHECK(out.find("[tool.workspace]") != std::string::npos);
  const auto [rests, still] = why("motion (mass, velocities)");
  CHECK(rests == 0);
  CHECK(still.find("model = \"quasi_static\"") != std::string::npos);
  const auto [wrong, known] = why("complience");
  CHECK(wrong == 2);
  CHECK(known.find("compliance") != std::string::npos);
}
