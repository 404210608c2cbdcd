#ifdef PALPATE_WITH_CAPTURE
// Which law a report, the console and the picture name as the one that was felt: the real programs, virtual
// time.
#include <cstdio>

#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// What a line of Python says that has `tool`, what the picture of a session is drawn from.
std::string drawn(const std::filesystem::path& report, const std::string& expression) {
  const std::string folder = source_dir() + "/scripts/plotting";
  const std::string command =
      "/usr/bin/python3 -B -c \"import sys; from pathlib import Path; sys.path.insert(0, '" + folder +
      "'); import session_report as s; tool = s.read_tools(s.read_json(Path('" + report.string() +
      "')), None)[0]; print(" + expression + ")\" 2>&1";
  FILE* const out = popen(command.c_str(), "r");
  REQUIRE(out != nullptr);
  std::string text;
  for (int c = std::fgetc(out); c != EOF; c = std::fgetc(out)) text += static_cast<char>(c);
  CHECK(pclose(out) == 0);
  return text;
}

struct Replayed {
  TemporaryFolder folder;
  std::string said;
  Json tool;
  std::filesystem::path report() const { return folder.path() / "report.json"; }
  /// The liver's motion, with samples as `record` is told to make them.
  explicit Replayed(const std::vector<std::string>& more) {
    const std::string capture = (folder.path() / "c.pcap").string();
    std::vector<std::string> arguments{"record", kScene,  "--trajectory", kClient,     "--rate",
                                       "33.3",   "--out", capture,        "--seconds", "6"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    output_of("sim_server", arguments, 0);
    said = output_of(
        "haptic_client",
        {"replay", capture, "--client", kClient, "--method", "local_contact", "--report", report().string()},
        0);
    tool = read_json(report())["tools"][0];
  }
};

}  // namespace

TEST_CASE("rendered law: where samples bring the triplet alone, everything names the law that stood in") {
  const Replayed r({"--plain"});
  CHECK(r.tool["rendered"]["law"] == "learned_stiffness");
  CHECK(r.tool["rendered"]["laws"] == Json{{"learned_stiffness", 1.0}});
  CHECK(r.tool["methods"]["local_contact"]["at_work"]["law"] == "learned_stiffness");
  CHECK(r.tool["methods"]["constant"]["at_work"]["law"] == "constant");
  CHECK_THAT(r.said, Catch::Contains("rendered: learned_stiffness 100 % (asked for: local_contact)"));
  CHECK_THAT(r.said, Catch::Contains("local_contact (as learned_stiffness 100 %)"));
  CHECK_THAT(drawn(r.report(), "tool.heading"),
             Catch::Contains("rendered: learned_stiffness (asked: local_contact)"));
  CHECK_THAT(drawn(r.report(), "tool.names['local_contact']"),
             Catch::Contains("local_contact (as learned_stiffness 100 %)"));
}

TEST_CASE("rendered law: where it was itself, its share is told, and all shares make one") {
  const Replayed r({});
  CHECK(r.tool["rendered"]["law"] == "local_contact");
  double sum = 0;
  for (const auto& [law, fraction] : r.tool["rendered"]["laws"].items()) sum += fraction.get<double>();
  CHECK(sum == Approx(1));
  CHECK(r.tool["rendered"]["laws"]["local_contact"].get<double>() > 0.9);
  CHECK_THAT(r.said, Catch::Contains("rendered: local_contact ") && !Catch::Contains("asked for"));
  CHECK(drawn(r.report(), "tool.felt") == "local_contact\n");
}
#endif
