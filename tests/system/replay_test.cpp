#ifdef PALPATE_WITH_CAPTURE
// Recording and replaying with the real programs.
#include <csignal>
#include <sys/resource.h>

#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

const std::string kOtherScene = source_dir() + "/configs/scenes/liver_tensor_mass.toml";

/// A capture of the liver in virtual time.
std::string record(const std::string& file, const std::vector<std::string>& more = {}) {
  std::vector<std::string> all{"record",    kScene, "--trajectory", kClient, "--rate", "33.3",
                               "--seconds", "8",    "--out",        file};
  all.insert(all.end(), more.begin(), more.end());
  return output_of("sim_server", all, 0);
}

std::string replay(const std::string& file, const std::vector<std::string>& more, int expected_code = 0) {
  std::vector<std::string> all{"replay", file};
  all.insert(all.end(), more.begin(), more.end());
  return output_of("haptic_client", all, expected_code);
}

}  // namespace

TEST_CASE("record and replay twice: the same bytes, and what the report counts is in the file") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  record(file("a.pcap"), {"--delay-ms", "35", "--report", file("a.json")});
  record(file("b.pcap"), {"--delay-ms", "35"});
  const bool same_capture = bytes_of(file("a.pcap")) == bytes_of(file("b.pcap"));
  CHECK(same_capture);
  const Json recorded = read_json(file("a.json"));
  CHECK(recorded["bytes"] == bytes_of(file("a.pcap")).size());
  CHECK(recorded["tool_states"] == 4001);
  CHECK(recorded["contact_steps"].get<int>() > 50);
  for (const std::string method : {"constant", "linear_position"}) {
    replay(file("a.pcap"), {"--method", method, "--out", file("a.csv"), "--report", file("r.json")});
    replay(file("b.pcap"), {"--method", method, "--out", file("b.csv")});
    const bool same = bytes_of(file("a.csv")) == bytes_of(file("b.csv"));
    CHECK(same);
    replay(file("a.pcap"), {"--method", method, "--rate", "1000", "--out", file("c.csv")});
    CHECK(10 * bytes_of(file("c.csv")).size() > 18 * bytes_of(file("a.csv")).size());
  }
  // A client file of another rate is not the one of this session.
  const std::string faster = folder.write("faster.toml", "rate_hz = 1000\n").string();
  CHECK(replay(file("a.pcap"), {"--client", faster}).find("has 500 ticks a second") != std::string::npos);
  CHECK(replay(file("a.pcap"), {"--client", faster, "--rate", "1000"}).find("ticks a second, and") ==
        std::string::npos);
  CHECK(replay(file("a.pcap"), {"--client", kClient}).find("ticks a second, and") == std::string::npos);
  const Json capture = read_json(file("r.json"))["capture"];
  CHECK(capture["packets"] == recorded["packets"]);
  CHECK(capture["tool_states"] == recorded["tool_states"]);
  CHECK(capture["force_samples"] == recorded["force_samples"]);
  CHECK(capture["missing_ticks"] == 0);
  CHECK(capture["missing_samples"] == 0);
}

TEST_CASE(
    "the recordings of a live session, of either program, replay to the forces that were written, byte for "
    "byte") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  Server server({"--record", file("server.pcap")});
  output_of("haptic_client",
            client_arguments(server.address, {"--seconds", "5", "--record", file("client.pcap"), "--trace",
                                              file("live.csv"), "--report", file("report.json")}),
            0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  const Json report = read_json(file("report.json"));
  const Json& link = report["tools"][0]["link"];
  CHECK(report["tools"][0]["recording"]["packets"] == link["sent"].get<int>() + link["received"].get<int>());
  CHECK(report["tools"][0]["recording"]["dropped"] == 0);
  const Json methods = report["tools"][0]["methods"];
  for (const char* law : {"constant", "linear_time", "linear_position"}) {
    for (const char* key :
         {"mean_percent", "p99_percent", "max_percent", "jump_percent", "paper_mean_percent",
          "paper_max_percent", "paper_max_force_percent", "ns_per_tick"})
      CHECK(methods[law][key].get<double>() > 0);
  }
  CHECK(methods["constant"]["mean_percent"] > methods["linear_position"]["mean_percent"]);
  CHECK(report["tools"][0]["timeline"]["cells"].size() >= 5);
  const std::string live = bytes_of(file("live.csv"));
  CHECK(live.size() > 100000);
  output_of("sim_server",
            {"record", kOtherScene, "--trajectory", kClient, "--rate", "250", "--seconds", "1", "--plain",
             "--out", file("truth.pcap")},
            0);
  for (const char* name : {"client.pcap", "server.pcap"}) {
    replay(file(name), {"--client", kClient, "--out", file("again.csv")});
    const bool same = bytes_of(file("again.csv")) == live;
    CHECK(same);
    // The Welcome tells of which scene the forces are.
    const std::string refused = output_of(
        "sim_server", {"view", file(name), "--scene", kOtherScene, "--viewer", "0", "--seconds", "1"}, 2);
    CHECK(refused.find("was recorded of another scene, which differs by: ") != std::string::npos);
    CHECK(output_of("haptic_client",
                    {"evaluate", file(name), "--truth", file("truth.pcap"), "--out", file("out")}, 2)
              .find("is of another scene than --truth") != std::string::npos);
  }
}

TEST_CASE("a session over 256 kbit/s each way travels packed, and replays to the forces that were written") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  constexpr const char* kRelay = "127.0.0.1:45368";
  Server server({"--record", file("server.pcap")});
  Process relay("link_relay", {"--listen", kRelay, "--server", server.address, "--mbit", "0.256"});
  REQUIRE(relay.wait_for("link_relay: from"));
  output_of("haptic_client",
            client_arguments(kRelay, {"--seconds", "8", "--record", file("client.pcap"), "--trace",
                                      file("live.csv"), "--report", file("report.json")}),
            0);
  relay.signal(SIGINT);
  CHECK(relay.wait() == 0);
  const Json tool = read_json(file("report.json"))["tools"][0];
  CHECK(tool["link"]["levels_s"]["full"] < 3);
  CHECK(tool["link"]["sent"] < tool["loop"]["ticks"].get<int>() / 2);
  CHECK(tool["link"]["uplink"]["came"] > 100);
  const std::string live = bytes_of(file("live.csv"));
  replay(file("client.pcap"), {"--client", kClient, "--out", file("again.csv")});
  const bool same = bytes_of(file("again.csv")) == live;
  CHECK(same);
}

TEST_CASE("a full disk stops the recording, not the session, and is said once") {
  Server server({"--record", "/dev/full"});
  const std::string said = output_of(
      "haptic_client", client_arguments(server.address, {"--seconds", "2", "--record", "/dev/full"}), 0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  for (const std::string& text : {said, server.process.output()}) {
    CAPTURE(text);
    const std::size_t first = text.find("The recording stopped, the session goes on");
    REQUIRE(first != std::string::npos);
    CHECK(text.find("The recording stopped", first + 1) == std::string::npos);
  }
  CHECK(said.find("ticks") != std::string::npos);
}

TEST_CASE("two sessions in one capture: the longest is replayed, which is said, or the one asked for") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  Server server({"--record", file("server.pcap")});
  for (const char* seconds : {"1", "2"})
    output_of("haptic_client", client_arguments(server.address, {"--seconds", seconds}), 0);
  server.process.signal(SIGINT);
  server.process.wait();
  const std::string said = replay(file("server.pcap"), {"--out", file("a.csv")});
  CHECK(said.find("holds 2 sessions; replaying number 2") != std::string::npos);
  CHECK(replay(file("server.pcap"), {"--session", "1", "--out", file("b.csv")}).find("replaying number 1") !=
        std::string::npos);
  CHECK(bytes_of(file("a.csv")).size() > bytes_of(file("b.csv")).size());
  CHECK(replay(file("server.pcap"), {"--session", "3"}, 2).find("there is no number 3") != std::string::npos);
}

TEST_CASE("captures that are none, or broken, and wrong motions: one line, exit 2, nothing left behind") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  record(file("a.pcap"));
  const std::string entire = bytes_of(file("a.pcap"));
  const auto says = [](const std::string& said, const std::string& text) {
    CAPTURE(said);
    CHECK(said.find(text) != std::string::npos);
  };
  const auto with = [&](const std::string& name, const std::string& bytes) {
    return folder.write(name, bytes).string();
  };
  const std::vector<std::string> out{"--out", file("o.csv")};
  says(replay(file("none.pcap"), out, 2), "none.pcap: no such file");
  says(replay(with("empty.pcap", ""), out, 2), "is empty");
  says(replay(with("text.pcap", "hello"), out, 2), "is not a capture");
  says(replay(with("header.pcap", entire.substr(0, 24)), out, 2), "holds no tool states");
  says(replay(file("a.pcap"), {"--method", "constnat"}, 2), "did you mean \"constant\"?");
  CHECK_FALSE(std::filesystem::exists(file("o.csv")));
  says(replay(with("cut.pcap", entire.substr(0, entire.size() / 2)), out), "ends in the middle of a packet");
  CHECK(std::filesystem::exists(file("o.csv")));
  const auto record_error = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"record", kScene, "--out", file("r.pcap")};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return output_of("sim_server", all, 2);
  };
  const std::string nan = with("nan.csv", "t_s,x_m,y_m,z_m\n0,0,0.1,0\n1,nan,0.1,0\n");
  says(record_error({"--trajectory", nan, "--rate", "30"}), "nan.csv:3: column x_m holds \"nan\"");
  says(record_error({"--trajectory", kClient, "--rate", "0"}), "--rate: expected 1 to 20000 Hz");
  says(record_error({"--trajectory", kClient, "--rate", "1000", "--ticks", "500"}),
       "--ticks: 500 Hz is less");
  says(record_error({"--trajectory", kScene, "--rate", "30"}), "has no [trajectory] section");
  CHECK_FALSE(std::filesystem::exists(file("r.pcap")));
}

TEST_CASE("the last tick of a session is in its recording, whenever it ends") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  Server server;
  for (int i = 0; i < 8; ++i) {
    output_of("haptic_client",
              client_arguments(server.address, {"--seconds", "0.1", "--rate", "2000", "--record",
                                                file("a.pcap"), "--trace", file("a.csv")}),
              0);
    replay(file("a.pcap"), {"--client", kClient, "--out", file("b.csv")});
    const bool same = bytes_of(file("a.csv")) == bytes_of(file("b.csv"));
    CHECK(same);
  }
}

TEST_CASE("a recording that hits its quota stops, the session goes on") {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "a.pcap").string();
  Server server;
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{100'000, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "3", "--record", file}));
  setrlimit(RLIMIT_FSIZE, &limit);
  CHECK(client.wait() == 0);
  CHECK(client.output().find("The recording stopped, the session goes on") != std::string::npos);
  CHECK(replay(file, {}).find("ticks at") != std::string::npos);  // what there was room for
}

TEST_CASE("no output overwrites an input, another output, a link or an earlier recording") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  record(file("a.pcap"));
  const std::string entire = bytes_of(file("a.pcap"));
  CHECK(replay(file("a.pcap"), {"--out", file("a.pcap")}, 2).find("name the same file") != std::string::npos);
  CHECK(replay(file("a.pcap"), {"--out", file("x"), "--report", file("./x")}, 2).find("name the same file") !=
        std::string::npos);
  std::filesystem::create_symlink("a.pcap", file("link"));
  CHECK(replay(file("a.pcap"), {"--out", file("link")}, 2).find("name the same file") != std::string::npos);
  const bool untouched = bytes_of(file("a.pcap")) == entire;
  CHECK(untouched);
  std::filesystem::create_symlink("there.csv", file("link.csv"));
  replay(file("a.pcap"), {"--out", file("link.csv")});
  CHECK(std::filesystem::is_symlink(file("link.csv")));
  CHECK(std::filesystem::is_regular_file(file("there.csv")));
  CHECK_THAT(output_of("haptic_client", client_arguments("127.0.0.1:9", {"--record", file("a.pcap")}), 1),
             Catch::Contains("nothing listens"));
  const bool still_there = bytes_of(file("a.pcap")) == entire;
  CHECK(still_there);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) ==
        4);  // nothing half-written left
}
TEST_CASE("replay of the first part of a recording names the next") {
  const TemporaryFolder folder;
  const std::string whole = (folder.path() / "F.pcap").string();
  record(whole);
  CHECK_THAT(replay(whole, {}), !Catch::Matchers::Contains("F-2.pcap"));
  std::filesystem::copy_file(whole, folder.path() / "F-2.pcap");
  CHECK_THAT(replay(whole, {}), Catch::Matchers::Contains("mergecap -a -F pcap -w ALL.pcap"));
}
#endif
