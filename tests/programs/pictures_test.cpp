// The pictures that scripts draw: what they say, read from an SVG, whose text is text.
#include <cstdio>
#include <fmt/core.h>
#include <fstream>
#include <iterator>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

/// Exit code and output of a script of plotting/.
std::pair<int, std::string> plotted(const std::string& arguments) {
  const std::string command =
      "/usr/bin/python3 -B " + source_dir() + "/scripts/plotting/" + arguments + " 2>&1";
  FILE* const out = popen(command.c_str(), "r");
  REQUIRE(out != nullptr);
  std::string text;
  for (int c = std::fgetc(out); c != EOF; c = std::fgetc(out)) text += static_cast<char>(c);
  return {WEXITSTATUS(pclose(out)), text};
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Half a second at 100 Hz; from 0.2 s on the force grows by 1 N in 0.1 s and stays. A sample each 50 ms, of
/// 20 ms ago. The law "near" is 0.002 N above it, "nearer" 0.003; "late" is what it was 20 ms ago.
std::string trace() {
  const auto force = [](double t) { return std::clamp((t - 0.2) / 0.1, 0.0, 1.0); };
  std::string text = "tick,t_s,fx_n,fy_n,fz_n,sample,sample_t_s,sample_n,late_n,near_n,nearer_n\n";
  for (int i = 0; i < 50; ++i) {
    const double t = 0.01 * i, f = force(t), late = force(t - 0.02);
    const std::string sample =
        i % 5 == 2 ? fmt::format("{},{:.3f},{}", 1 + i / 5, t - 0.02, late) : fmt::format("{},,", 1 + i / 5);
    text += fmt::format("{},{:.3f},0,{},0,{},{},{},{}\n", i + 1, t, late, sample, late, f + 0.002, f + 0.003);
  }
  return text;
}

}  // namespace

TEST_CASE(
    "force.py: an SVG beside the PNG names rate and delay, each error, and lines that lie on each other") {
  const TemporaryFolder folder;
  const std::string csv = folder.write("trace.csv", trace()).string(),
                    png = (folder.path() / "force.png").string();
  const auto [code, said] = plotted("force.py " + csv + " " + png + " --plot-format svg");
  CAPTURE(said);
  REQUIRE(code == 0);
  CHECK(std::filesystem::file_size(png) > 10000);
  const std::string drawn = text_of(folder.path() / "force.svg");
  CHECK_THAT(drawn, Catch::Contains("server 20 Hz"));
  CHECK_THAT(drawn, Catch::Contains("delay 20 ms"));
  CHECK_THAT(drawn, Catch::Contains(">late<"));
  CHECK_THAT(drawn, Catch::Contains(">near<") && Catch::Contains(">= nearer<"));
  CHECK_THAT(drawn, Catch::Contains("mN on average"));
}

TEST_CASE("force.py: a format it does not write, and an output that is no PNG, are refused, exit 2") {
  const TemporaryFolder folder;
  const std::string csv = folder.write("trace.csv", trace()).string();
  CHECK(plotted("force.py " + csv + " " + (folder.path() / "f.png").string() + " --plot-format gif").first ==
        2);
  CHECK(plotted("force.py " + csv + " " + (folder.path() / "f.pdf").string()).first == 2);
  CHECK_FALSE(std::filesystem::exists(folder.path() / "f.png"));
}

namespace {

/// A study of stability of one wall, in which the law that calls the tangent holds what the direct loop
/// holds.
void write_stability_study(const TemporaryFolder& folder, bool quick) {
  folder.write(
      "summary.json",
      R"([{"method": "tangent", "world": "linear", "operator": "typical", "rate_hz": 30, "delay_ms": 38,
                    "passivity": false, "stable_to_n_m": 950, "direct_limit_n_m": 1000},
                   {"method": "tangent", "world": "linear", "operator": "typical", "rate_hz": 30, "delay_ms": 38,
                    "passivity": true, "stable_to_n_m": 950, "direct_limit_n_m": 1000}])");
  folder.write("study.json",
               fmt::format("{{\"study\": \"stability\", \"quick\": {}}}", quick ? "true" : "false"));
}

}  // namespace

TEST_CASE("goals.py: a whole study meets a goal or misses it, a quick one can do neither, and says so") {
  const TemporaryFolder folder;
  write_stability_study(folder, false);
  const std::string entire = plotted("goals.py " + folder.path().string()).second;
  CHECK_THAT(entire, Catch::Contains(">= 90    95        yes") && !Catch::Contains("quick"));
  write_stability_study(folder, true);
  const std::string quick = plotted("goals.py " + folder.path().string()).second;
  CAPTURE(quick);
  CHECK_THAT(quick, Catch::Contains("--quick") && Catch::Contains("95") && !Catch::Contains("yes"));
  CHECK(text_of(folder.path() / "goals.txt") == quick);
}

TEST_CASE(
    "stability.py: an SVG beside the PNG names laws and hands in words, and says --quick of a quick study") {
  const TemporaryFolder folder;
  for (const bool quick : {false, true}) {
    write_stability_study(folder, quick);
    CAPTURE(quick);
    REQUIRE(plotted("stability.py " + folder.path().string() + " --plot-format svg").first == 0);
    CHECK(std::filesystem::exists(folder.path() / "stability_linear.png"));
    const std::string drawn = text_of(folder.path() / "stability_linear.svg");
    CHECK_THAT(drawn, Catch::Contains(">tangent<") && Catch::Contains("950"));
    CHECK((drawn.find("--quick") != std::string::npos) == quick);
  }
}

TEST_CASE("laws_animation.py: a small GIF of two laws, in as many pictures as four times the time has") {
  const TemporaryFolder folder;
  const std::string csv = folder.write("trace.csv", trace()).string(),
                    gif = (folder.path() / "laws.gif").string();
  const auto [code, said] =
      plotted("laws_animation.py " + csv + " " + gif + " --laws late near --seconds 0.2 0.45");
  CAPTURE(said);
  REQUIRE(code == 0);
  const std::string drawn = text_of(gif);
  CHECK(drawn.starts_with("GIF89a"));
  CHECK(drawn.size() < 700000);
  // 12 a second, and then one that stays: each has a graphic control extension of 4 bytes.
  std::size_t pictures = 0;
  for (std::size_t at = drawn.find("\x21\xf9\x04"); at != std::string::npos;
       at = drawn.find("\x21\xf9\x04", at + 1))
    ++pictures;
  CHECK(pictures >= 12);
  CHECK(pictures <= 14);

  const auto [wrong, published] = plotted("laws_animation.py " + csv + " " + gif + " --laws late absent");
  CHECK(wrong == 2);
  CHECK_THAT(published, Catch::Contains("--laws absent") && Catch::Contains("late, near, nearer"));
  CHECK(std::ranges::count(published, '\n') == 1);
}
