// What minimal scenes start, by the real program: threads; and that what is left out is not in resident
// memory either. What they build: programs/left_out_test.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "tests/support/explained.h"

using namespace palpate::test;

namespace {

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
    for (int polls = 0; polls < 200 && threads().first != expected; ++polls)
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
  const std::string entire = kSceneFolder + "liver_paper.toml", some = kSceneFolder + "liver_falcon.toml";
  const long saved = explained(entire)["bytes"].get<long>() - explained(some)["bytes"].get<long>();
  CHECK(saved > 5'000'000);
  const long resident = Waiting(entire).resident() - Waiting(some).resident();
  CAPTURE(saved, resident);
  CHECK(10 * resident > 7 * saved);
}
