#ifdef PALPATE_WITH_CAPTURE
// Laws against the truth, offline: the real programs, virtual time.
#include <chrono>
#include <fstream>
#include <iterator>

#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

struct Study {
  TemporaryFolder folder;
  std::string file(const std::string& name) const { return (folder.path() / name).string(); }
  void record(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"record", kScene,    "--trajectory", kClient,
                                       "--out",  file(out), "--seconds",    "20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    output_of("sim_server", arguments, 0);
  }
};

const Json& row(const Json& rows, const std::string& method, bool blended) {
  for (const Json& r : rows) {
    if (r["method"] == method && r["blended"] == blended) return r;
  }
  throw std::runtime_error("no row of " + method);
}

Json without_timings(Json rows) {
  for (Json& r : rows) {
    r.erase("ns_per_tick");
    r.erase("ns_per_tick_p99");
    r.erase("ns_per_arrival");
  }
  return rows;
}

}  // namespace

TEST_CASE("evaluate: on a grasped organ, the paper's protocol gives the paper's table") {
  const Study study;
  const std::string root = source_dir();
  output_of(
      "sim_server",
      {"record", root + "/configs/scenes/grasp.toml", "--trajectory", root + "/configs/clients/grasp.toml",
       "--rate", "33.333333333333336", "--out", study.file("grasp.pcap")},
      0);
  output_of("haptic_client", {"evaluate", study.file("grasp.pcap"), "--out", study.file("out")}, 0);
  const Json rows = read_json(study.folder.path() / "out" / "summary.json");
  const auto mean = [&](const char* law) {
    return row(rows, law, false)["paper_mean_percent"].get<double>();
  };
  // Picinbono and Lombardo (1999): 1.1, 0.3 and 0.1 %.
  CHECK(mean("constant") == Approx(1.1).epsilon(0.35));
  CHECK(mean("linear_time") == Approx(0.3).epsilon(0.35));
  CHECK(mean("linear_position") == Approx(0.1).epsilon(0.35));
  CHECK(mean("learned_stiffness") <= 0.03);
  CHECK(mean("tangent") <= 0.015);
}

TEST_CASE(
    "record --real-time: it takes its time, and steps that take longer than a period are told as late") {
  const TemporaryFolder folder;
  const auto recorded = [&](const char* rate) {
    const auto file = [&](const char* ending) {
      return (folder.path() / (rate + std::string(ending))).string();
    };
    const auto begin = std::chrono::steady_clock::now();
    output_of("sim_server",
              {"record", source_dir() + "/configs/scenes/liver_implicit.toml", "--trajectory", kClient,
               "--rate", rate, "--seconds", "0.5", "--plain", "--real-time", "--out", file(".pcap"),
               "--report", file(".json")},
              0);
    CHECK(std::chrono::steady_clock::now() - begin >= std::chrono::milliseconds(400));
    return read_json(file(".json"));
  };
  CHECK(recorded("4")["force_samples"].get<int>() >= 1);
  // A step of that takes some milliseconds, and no machine does it in a twentieth of one.
  const Json hurried = recorded("20000");
  const int samples = hurried["force_samples"].get<int>(), late = hurried["late"].get<int>();
  CHECK(samples < 5000);
  CHECK(samples + late > 9000);
}

TEST_CASE(
    "evaluate --keep 4 of a capture at 80 Hz is what a capture at 20 Hz gives, where tissue is at rest") {
  const Study study;
  const std::string root = source_dir();
  for (const char* rate : {"80", "20"}) {
    output_of(
        "sim_server",
        {"record", root + "/configs/scenes/grasp.toml", "--trajectory", root + "/configs/clients/grasp.toml",
         "--rate", rate, "--seconds", "20", "--out", study.file(rate)},
        0);
  }
  const auto scores = [&](const char* capture, const char* keep) {
    output_of("haptic_client", {"evaluate", study.file(capture), "--keep", keep, "--out", study.file("out")},
              0);
    return read_json(study.folder.path() / "out" / "summary.json");
  };
  const Json fast = scores("80", "1"), stored = scores("80", "4"), slow = scores("20", "1");
  for (const char* law : {"constant", "linear_time", "linear_position"}) {
    const Json& a = row(stored, law, false);
    const Json& b = row(slow, law, false);
    for (const char* key : {"paper_mean_percent", "paper_max_percent"}) {
      CAPTURE(law, key);
      CHECK(a[key].get<double>() == Approx(b[key].get<double>()).epsilon(1e-3));
      CHECK(row(fast, law, false)[key].get<double>() < 0.7 * a[key].get<double>());
    }
  }
}

TEST_CASE("record: a tool without a motion, and more motions than tools, are told of, exit 2") {
  const Study study;
  CHECK_THAT(output_of("sim_server",
                       {"record", kScene, "--trajectory", kClient, "--rate", "30", "--tool", "2", "--out",
                        study.file("a.pcap")},
                       2),
             Catch::Contains("--tool 2") && Catch::Contains("--trajectory once for each tool"));
  CHECK_THAT(output_of("sim_server",
                       {"record", kScene, "--trajectory", kClient, "--trajectory", kClient, "--rate", "30",
                        "--out", study.file("a.pcap")},
                       2),
             Catch::Contains("2 motions"));
  CHECK_FALSE(std::filesystem::exists(study.folder.path() / "a.pcap"));
}

TEST_CASE("evaluate: on the liver, 33 Hz and 35 ms, two tangents are far ahead of the paper's laws") {
  const Study study;
  study.record("truth.pcap", {"--rate", "2000", "--plain", "--report", study.file("truth.json")});
  study.record("slow.pcap", {"--rate", "33.3", "--delay-ms", "35", "--report", study.file("slow.json")});
  const auto evaluate = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"evaluate", study.file("slow.pcap"), "--out", study.file(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    output_of("haptic_client", arguments, 0);
    return read_json(study.folder.path() / out / "summary.json");
  };
  const Json rows = evaluate("a", {"--truth", study.file("truth.pcap"), "--world", "liver"});
  CHECK(without_timings(rows) ==
        without_timings(evaluate("b", {"--truth", study.file("truth.pcap"), "--world", "liver"})));
  const auto mean = [&](const char* law) { return row(rows, law, false)["mean_percent"].get<double>(); };
  CHECK(mean("constant") > mean("linear_position"));
  CHECK(mean("linear_position") > 4 * mean("two_tangents"));
  CHECK(mean("linear_position") > 50 * mean("local_contact"));
  const Json& one = row(rows, "two_tangents", true);
  CHECK(one["world"] == "liver");
  CHECK(one["reference"] == "truth");
  CHECK(one["rate_hz"].get<double>() == Approx(33.3).epsilon(0.01));
  CHECK(one["delay_ms"].get<double>() == Approx(36).margin(1.1));  // seen at the next tick
  CHECK(one["jump_percent"].get<double>() < 1e-6);                 // blended
  CHECK(one["bytes_per_sample"].get<double>() == Approx(28 + 341).epsilon(0.2));
  CHECK(row(rows, "constant", true)["bytes_per_sample"].get<double>() < 160);  // uses none of the tangents
  CHECK(one["between"] == "contact");
  // What a session scores itself against is off by less than a tenth of what the best law is.
  for (const char* key : {"mean_percent", "p99_percent", "max_percent"}) {
    CAPTURE(key);
    CHECK(10 * one["between_" + std::string(key)].get<double>() <
          row(rows, "local_contact", false)[key].get<double>());
  }
  // The server counts jumps in its own forces as the client does in what it got of them.
  const Json dense = read_json(study.folder.path() / "truth.json"),
             sparse = read_json(study.folder.path() / "slow.json");
  CHECK(one["snaps"] == dense["snaps"]);
  CHECK(one["largest_snap_percent"] == dense["largest_snap_percent"]);
  CHECK_FALSE(dense.contains("unexplained_jumps"));
  CHECK_FALSE(sparse.contains("snaps"));
  CHECK(one["unexplained_jumps"] == sparse["unexplained_jumps"]);
  CHECK(one["largest_unexplained_jump_percent"].get<double>() > 0);
  CHECK(one["max_10ms_percent"] < one["max_percent"]);
  CHECK(one["max_of_rms_percent"].get<double>() / one["max_percent"].get<double>() ==
        Approx(one["p99_of_rms_percent"].get<double>() / one["p99_percent"].get<double>()));
  // Without a truth the force between the samples is the reference: as in a replay.
  const Json curves = evaluate("c", {"--method", "constant"}), solved = evaluate("d", {});
  CHECK(curves.size() == 2);
  CHECK(curves[0]["reference"] == "hermite");
  CHECK(curves[0]["snaps"].is_null());
  CHECK(solved[0]["reference"] == "contact");
  for (const char* law : {"constant", "linear_position", "two_tangents", "local_contact"}) {
    CAPTURE(law);
    CHECK(row(solved, law, false)["mean_percent"].get<double>() == Approx(mean(law)).epsilon(0.1));
  }
}

TEST_CASE(
    "evaluate: a told compliance of 0.7 is another model for the law that solves contact, and only for it") {
  const Study study;
  study.record("slow.pcap", {"--rate", "33.3", "--delay-ms", "35"});
  const auto evaluate = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"evaluate", study.file("slow.pcap"), "--out",    study.file(out),
                                       "--method", "local_contact",         "--method", "two_tangents"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    output_of("haptic_client", arguments, 0);
    return without_timings(read_json(study.folder.path() / out / "summary.json"));
  };
  const Json published = evaluate("told", {}), same = evaluate("same", {"--compliance", "1"}),
             stiffer = evaluate("stiffer", {"--compliance", "0.7"});
  CHECK(same == published);
  for (const bool blended : {false, true}) {
    // The reference is solved on that model, too, but corrected at every sample; the line knows no model.
    const Json &other = row(published, "two_tangents", blended),
               &same_law = row(stiffer, "two_tangents", blended);
    for (const char* key : {"paper_mean_percent", "paper_max_percent", "paper_max_force_percent"})
      CHECK(same_law[key] == other[key]);
    CHECK(same_law["mean_percent"].get<double>() ==
          Approx(other["mean_percent"].get<double>()).epsilon(1e-3));
    const Json &right = row(published, "local_contact", blended),
               &wrong = row(stiffer, "local_contact", blended);
    CHECK(wrong["mean_percent"] != right["mean_percent"]);
    CHECK(wrong["model_bytes"] == right["model_bytes"]);
    CHECK(right["model_bytes"].get<double>() > 1e6);
  }
}

TEST_CASE("evaluate: wrong input") {
  const Study study;
  study.record("slow.pcap", {"--rate", "33.3"});
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"evaluate", study.file("slow.pcap"), "--out", study.file("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return output_of("haptic_client", arguments, 2);
  };
  CHECK(refused({"--truth", study.file("slow.pcap")}).find("--rate 2000 --plain") != std::string::npos);
  CHECK(refused({"--method", "linear_tim"}).find("linear_time") != std::string::npos);
  CHECK(refused({"--truth", study.file("none.pcap")}).find("none.pcap") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(study.folder.path() / "out" / "summary.json"));
}
TEST_CASE("evaluate: a truth of another motion is refused, with how far apart the tools are") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  // Both touch the wall; one of them 2 mm beside the other.
  for (const char* x : {"0", "0.002"}) {
    std::string rows = "t_s,x_m,y_m,z_m\n";
    for (const char* end : {"0,", "1,", "2,"})
      rows += std::string(end) + x + (end[0] == '1' ? ",0.004,0\n" : ",0.010,0\n");
    folder.write(std::string("motion_") + x + ".csv", rows);
  }
  const std::string scene = source_dir() + "/configs/scenes/block.toml";
  const auto record = [&](const std::string& motion, const std::string& rate, const std::string& out) {
    output_of("sim_server",
              {"record", scene, "--trajectory", file(motion), "--rate", rate, "--out", file(out), "--plain"},
              0);
  };
  record("motion_0.csv", "33.3", "a.pcap");
  record("motion_0.csv", "500", "truth.pcap");
  record("motion_0.002.csv", "500", "other.pcap");
  const auto evaluate = [&](const std::string& truth, int expected_code) {
    return output_of(
        "haptic_client",
        {"evaluate", file("a.pcap"), "--truth", file(truth), "--method", "constant", "--out", file("out")},
        expected_code);
  };
  CHECK_THAT(evaluate("truth.pcap", 0), !Catch::Matchers::Contains("mm away"));
  // The same motion on tissue that is twice as stiff.
  std::ifstream in(scene);
  std::string text(std::istreambuf_iterator<char>(in), {});
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"48e3", "96e3"}, {"../meshes/", source_dir() + "/configs/meshes/"}, {"clients = [", "# ["}}) {
    REQUIRE(text.find(from) != std::string::npos);
    text.replace(text.find(from), from.size(), to);
  }
  const std::string stiff = folder.write("stiff.toml", text).string();
  output_of("sim_server",
            {"record", stiff, "--trajectory", file("motion_0.csv"), "--rate", "500", "--out",
             file("stiff.pcap"), "--plain"},
            0);
  CHECK_THAT(evaluate("stiff.pcap", 2), Catch::Matchers::Contains("another scene") &&
                                            Catch::Matchers::Contains("differs by: material;") &&
                                            Catch::Matchers::Contains("record the truth again"));
  CHECK_THAT(evaluate("other.pcap", 2), Catch::Matchers::Contains("up to 2 mm away"));
  // So is one of a part of it.
  output_of("sim_server",
            {"record", scene, "--trajectory", file("motion_0.csv"), "--rate", "500", "--seconds", "0.5",
             "--out", file("part.pcap"), "--plain"},
            0);
  CHECK_THAT(evaluate("part.pcap", 2), Catch::Matchers::Contains("knows the time of") &&
                                           Catch::Matchers::Contains("would not be scored"));
}
#endif
