// Both real programs as processes, on 127.0.0.1.
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "protocol/udp_socket.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

/// Columns of a trace: time, and the magnitude of the written force.
std::vector<std::pair<double, double>> written_force(const std::filesystem::path& trace) {
  std::ifstream in(trace);
  std::string line;
  std::getline(in, line);
  std::vector<std::pair<double, double>> rows;
  while (std::getline(in, line)) {
    double t = 0, p[3], f[3];
    if (std::sscanf(line.c_str(), "%*d,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &t, p, p + 1, p + 2, f, f + 1, f + 2) ==
        7) {
      rows.emplace_back(t, std::hypot(f[0], f[1], f[2]));
    }
  }
  return rows;
}

/// Time and number of the newest sample of each tick.
std::vector<std::pair<double, std::uint64_t>> newest_samples(const std::filesystem::path& trace) {
  std::ifstream in(trace);
  std::string line;
  std::getline(in, line);
  std::vector<std::pair<double, std::uint64_t>> rows;
  while (std::getline(in, line)) {
    double t = 0;
    unsigned long long sample = 0;
    if (std::sscanf(line.c_str(), "%*d,%lf,%*f,%*f,%*f,%*f,%*f,%*f,%llu", &t, &sample) == 2)
      rows.emplace_back(t, sample);
  }
  return rows;
}

}  // namespace

TEST_CASE("a session: force in contact, zero out of it, nothing above the clamp, both reports complete") {
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  Server server({"--report", file("server.json")});
  Process client("haptic_client",
                 client_arguments(server.address, {"--seconds", "5", "--report", file("report.json"),
                                                   "--trace", file("trace.csv")}));
  CHECK(client.wait() == 0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);

  const Json report = read_json(file("report.json")), tool = report["tools"][0];
  CHECK(tool["device"] == "simulated");
  CHECK(tool["loop"]["rate_hz"] == 500);
  const double due = tool["loop"]["ticks"].get<double>() + tool["loop"]["missed"].get<double>();
  CHECK(due == Approx(2500).epsilon(0.05));
  for (const char* key : {"p50", "p99", "p999", "max"}) CHECK(tool["loop"]["period_us"].contains(key));
  for (const char* key : {"p50", "p99", "max"}) CHECK(tool["loop"]["tick_us"].contains(key));
  for (const char* key : {"p50", "p99", "max"}) CHECK(tool["force"]["age_ms"].contains(key));
  CHECK(tool["force"]["samples"].get<int>() > 100);
  CHECK(tool["force"]["max_newton"].get<double>() > 0.2);
  CHECK(tool["force"]["max_newton"].get<double>() <= 8);
  CHECK(tool["motion"]["mean_speed_m_s"].get<double>() > 0.001);
  for (const char* key : {"mean_speed_m_s", "max_speed_m_s", "spatial_sampling_mm"})
    CHECK(tool["motion"].contains(key));
  for (const char* key :
       {"clamped", "slewed", "damped", "softened", "least_gain", "weak_s", "ramped", "storms"})
    CHECK(tool["safety"].contains(key));
  for (const char* key : {"sent", "received", "lost", "reordered", "duplicated", "rejected"})
    CHECK(tool["link"].contains(key));
  CHECK(tool["link"]["rejected"] == 0);

  const Json sim = read_json(file("server.json"));
  CHECK(sim["rate_hz"] == 30);
  const bool warned = server.process.output().find("make the force older") != std::string::npos;
  CHECK(sim["real_time"] == !warned);
  for (const char* key : {"p50", "p99", "max"}) CHECK(sim["step_ms"].contains(key));
  CHECK(sim["setup_ms"].get<double>() > 0);
  for (const char* key : {"vertices", "edges", "tetrahedra"}) CHECK(sim["mesh"][key].get<int>() > 1000);
  CHECK(sim["memory_bytes"]["compliance"].get<long>() > 1000000);
  CHECK(sim["state_hash"].get<std::string>().size() == 16);

  int zero = 0, contact = 0;
  for (const auto& [t, f] : written_force(file("trace.csv"))) {
    CHECK(f <= 8);
    zero += f == 0 ? 1 : 0;
    contact += f > 0.1 ? 1 : 0;
  }
  CHECK(zero > 50);
  CHECK(contact > 100);
}

TEST_CASE(
    "the server is killed and started again: force to zero within 400 ms, said once, back by itself and "
    "softly",
    "[in_time]") {
  const TemporaryFolder folder;
  const std::string trace = (folder.path() / "trace.csv").string(),
                    report = (folder.path() / "report.json").string();
  auto server = std::make_unique<Server>();
  const std::string address = server->address;
  // A hand that presses and stays, so that force is missed when it goes.
  const auto press =
      folder.write("press.csv", "t_s,x_m,y_m,z_m\n0,-0.02,0.10,0\n1,-0.02,0.065,0\n2,-0.02,0.065,0.00001\n");
  const auto config =
      folder.write("client.toml", "server = \"" + address + "\"\n[trajectory]\nfile = \"press.csv\"\n");
  Process client("haptic_client",
                 {"run", config.string(), "--seconds", "90", "--trace", trace, "--report", report});
  REQUIRE(client.wait_for("connected"));
  std::this_thread::sleep_for(std::chrono::milliseconds(3000));
  server->process.signal(SIGKILL);
  server->process.wait();
  REQUIRE(client.wait_for("force goes to zero", 2));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it is there before the server is back
  server = std::make_unique<Server>(std::vector<std::string>{}, address);
  REQUIRE(client.wait_for("is back: soft start", 5));
  std::this_thread::sleep_for(std::chrono::milliseconds(3000));  // the force rises
  client.signal(SIGINT);
  CHECK(client.wait() == 0);
  const std::string& said = client.output();
  CHECK(said.find("force goes to zero") == said.rfind("force goes to zero"));

  // In the trace: force, then within 400 ms of the last sample a stretch of exact zeros, then force that
  // rises slowly.
  const auto rows = written_force(trace);
  double lost_at = -1, zero_at = -1, risen_at = -1, full = 0;
  for (const auto& [t, f] : rows) {
    if (t > 2 && t < 2.8) full = std::max(full, f);
    if (full > 0 && zero_at < 0 && t > 2.8 && f == 0) zero_at = t;
    if (zero_at > 0 && risen_at < 0 && t > zero_at + 0.05 && f > 0.8 * full) risen_at = t;
  }
  // When the last sample came: its number stands in each row.
  std::uint64_t newest = 0;
  for (const auto& [t, sample] : newest_samples(trace)) {
    if (t < zero_at && sample != newest) lost_at = t;
    newest = sample;
  }
  CAPTURE(full, lost_at, zero_at, risen_at);
  CHECK(full > 0.2);
  REQUIRE(zero_at > 0);
  CHECK(zero_at - lost_at <= 0.4);
  REQUIRE(risen_at > 0);
  double first_force = risen_at;
  for (const auto& [t, f] : rows) {
    if (t > zero_at && t < first_force && f > 0) first_force = t;
  }
  CHECK(risen_at - first_force > 0.5);
  CHECK(read_json(report)["tools"][0]["safety"]["ramped"] == 1);
}

TEST_CASE("the client is killed: the server drops its tool within a second and takes the next client",
          "[in_time]") {
  Server server;
  Process first("haptic_client", client_arguments(server.address, {}));
  REQUIRE(server.process.wait_for("a client took the tool"));
  REQUIRE(first.wait_for("connected"));
  first.signal(SIGKILL);
  CHECK(server.process.wait_for("the tool is free", 1.2));
  Process second("haptic_client", client_arguments(server.address, {"--seconds", "1"}));
  CHECK(second.wait() == 0);
}

TEST_CASE("a second client is told that the tool is taken, exit 1, and the first is not disturbed") {
  Server server;
  Process first("haptic_client", client_arguments(server.address, {"--seconds", "8"}));
  REQUIRE(first.wait_for("connected"));
  CHECK(output_of("haptic_client", client_arguments(server.address, {}), 1).find("no free tool") !=
        std::string::npos);
  CHECK(first.wait() == 0);
  CHECK(first.output().find("force goes to zero") == std::string::npos);
}

TEST_CASE("Ctrl-C on either side leaves cleanly with its report") {
  const TemporaryFolder folder;
  const std::string ours = (folder.path() / "report.json").string(),
                    theirs = (folder.path() / "server.json").string();
  Server server({"--report", theirs});
  Process client("haptic_client", client_arguments(server.address, {"--report", ours}));
  REQUIRE(client.wait_for("connected"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  client.signal(SIGINT);
  CHECK(client.wait() == 0);
  CHECK(read_json(ours)["tools"][0]["loop"]["ticks"].get<int>() > 50);
  CHECK(server.process.wait_for("the tool is free", 1));  // by the Bye, at once
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  CHECK(read_json(theirs).contains("state_hash"));
}

TEST_CASE("Ctrl-C while waiting for a server ends the client, exit 0, with its report", "[in_time]") {
  const TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  Process client("haptic_client", client_arguments("127.0.0.1:9", {"--report", report}));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  client.signal(SIGINT);
  CHECK(client.wait() == 0);
  CHECK(read_json(report)["tools"][0]["loop"]["ticks"] == 0);
  CHECK(client.output().find("nothing was rendered") != std::string::npos);
  CHECK(client.output().find("largest force") == std::string::npos);
}

TEST_CASE("no server: exit 1 after 5 s with what to look at, port in use: exit 1") {
  CHECK(output_of("haptic_client", client_arguments("127.0.0.1:9", {}), 1)
            .find("nothing listens at 127.0.0.1:9 (Connection refused)") != std::string::npos);
  // The limited broadcast: the system refuses to send there.
  const std::string nowhere =
      output_of("haptic_client", client_arguments("255.255.255.255:9", {"--insecure"}), 1);
  CHECK_THAT(nowhere, Catch::Contains("nothing can be sent to 255.255.255.255:9: "));
  Server server;
  CHECK(output_of("sim_server", {"run", kScene, "--listen", server.address}, 1).find("is in use") !=
        std::string::npos);
}

TEST_CASE("garbage on the server's port is counted, and changes nothing") {
  const TemporaryFolder folder;
  const std::string theirs = (folder.path() / "server.json").string();
  Server server({"--report", theirs});
  {
    palpate::protocol::UdpSocket stranger(palpate::protocol::resolve("127.0.0.1:0", "test"));
    const auto to = palpate::protocol::resolve(server.address, "test");
    std::array<std::byte, 600> bytes{};
    for (std::size_t size = 0; size < bytes.size(); size += 7) stranger.send({bytes.data(), size}, to);
  }
  Process client("haptic_client", client_arguments(server.address, {"--seconds", "1"}));
  CHECK(client.wait() == 0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  CHECK(read_json(theirs)["link"]["rejected"] == 86);
}

TEST_CASE("wrong input: one line that says what, where and what to do, exit 2, nothing left behind") {
  const TemporaryFolder folder;
  const std::string mesh = "[mesh]\nfile = \"" + source_dir() + "/configs/meshes/liver_paper.msh\"\n";
  const std::string fixed = "[[fixed]]\nbox = [[-1, -1, -1], [1, 1, -0.06]]\n";
  const std::string rest =
      "[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.45\n[deformation]\nmodel = "
      "\"quasi_static\"\n[[tool]]\n";
  const auto scene_error = [&](const std::string& text) {
    const std::string file = folder.write("scene.toml", text).string();
    return output_of(
        "sim_server",
        {"run", file, "--listen", "127.0.0.1:0", "--report", (folder.path() / "s.json").string()}, 2);
  };
  const auto client_error = [&](const std::string& text) {
    const std::string file = folder.write("client.toml", text).string();
    return output_of("haptic_client", {"run", file, "--report", (folder.path() / "r.json").string()}, 2);
  };
  const auto says = [](const std::string& output, const std::string& what) {
    CAPTURE(output, what);
    CHECK(output.find(what) != std::string::npos);
  };
  const auto with_mesh = [&](const std::string& name, const std::string& text) {
    folder.write(name, text);
    return "[mesh]\nfile = \"" + name + "\"\n" + fixed + rest;
  };
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
  says(scene_error("[mesh]\nfile = \"none.msh\"\n" + fixed + rest), "none.msh: no such file");
  says(scene_error(with_mesh("cut.msh", head)), "cut.msh:11: the file ends without $Elements");
  says(scene_error(with_mesh("inverted.msh", head + "$Elements\n1\n1 4 2 0 0 1 3 2 4\n$EndElements\n")),
       "is inverted");
  says(scene_error(with_mesh("old.msh", "$NOD\n1\n")), "gmsh \"");
  says(scene_error(mesh + rest), "no fixed nodes");
  says(scene_error(mesh + "[[fixed]]\nbox = [[5, 5, 5], [6, 6, 6]]\n" + rest),
       "scene.toml:3: no vertex of the mesh lies in");
  says(scene_error(mesh + "[[fixed]]\nsurface_tag = \"atachment\"\n" + rest), "did you mean \"attachment\"?");
  std::string text = mesh + fixed + rest;
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.find(from), from.size(), to);
  };
  says(scene_error(replaced("0.45", "0.5")),
       "scene.toml:7: `[material] poisson_ratio` must be between 0 and 0.499999");
  says(scene_error(replaced("young_modulus = 1e4", "young_modulus = \"soft\"")), "must be a number (Pa)");
  says(scene_error(replaced("young_modulus", "youngs_modulus")),
       "unknown key `[material] youngs_modulus`; did you mean \"young_modulus\"?");
  says(scene_error(replaced("[[tool]]", "[[tool]]\nradios = 1")),
       "unknown key `[[tool]] radios`; did you mean \"radius\"?");
  says(scene_error(replaced("quasi_static", "quasistatic")),
       "unknown deformation model \"quasistatic\"; did you mean \"quasi_static\"?");
  says(client_error("method = \"linear\""), "client.toml:1: unknown method \"linear\"");
  says(client_error("[device]\nname = \"falkon\""), "client.toml:2: unknown device \"falkon\"");
  folder.write("bad.csv", "t_s,x_m,y_m,z_m\n0,0,0,0\n1,0,zero,0\n");
  says(client_error("[trajectory]\nfile = \"bad.csv\""), "bad.csv:3: column y_m holds \"zero\"");
  says(client_error("\nserver = \"nohost\""), "client.toml:2: \"nohost\" is no address");
  says(client_error("rate_hz = 50"), "must be between 100 and 4000 (Hz), not 50");
  says(output_of("haptic_client", {"run", "--method", "constnat"}, 2), "did you mean \"constant\"?");
  says(output_of("haptic_client", {"run", "--server", "nowhere"}, 2), "expected HOST:PORT");
  says(output_of("sim_server", {"run", kScene, "--report", "/nowhere/s.json"}, 2), "cannot be written");
  says(output_of("sim_server", {"dance"}, 2), "--help");
  says(output_of("sim_server", {"rnu", kScene}, 2), "did you mean \"run\"?");
  says(output_of("haptic_client", {"evalate", "x.pcap"}, 2), "did you mean \"evaluate\"?");
  CHECK_FALSE(std::filesystem::exists(folder.path() / "s.json"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "r.json"));
}

TEST_CASE("what is there already is kept: an output never takes the place of a mesh, a scene or a motion") {
  const TemporaryFolder folder;
  const std::string root = source_dir();
  const auto copied = [&](const std::string& from) {
    const auto file = folder.path() / std::filesystem::path(from).filename();
    std::filesystem::copy_file(root + "/configs/" + from, file);
    return file.string();
  };
  const auto contents = [](const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string mesh = copied("meshes/block.msh"), motion = copied("trajectories/block_palpation.csv"),
                    other = copied("scenes/liver_weight.toml");
  const std::string scene =
      folder.write("scene.toml", "[mesh]\nfile = \"block.msh\"\n[deformation]\nmodel = \"rigid\"\n[[tool]]\n")
          .string();
  const std::string client =
      folder.write("client.toml", "[trajectory]\nfile = \"block_palpation.csv\"\n").string();
  const std::string mesh_was = contents(mesh), motion_was = contents(motion), other_was = contents(other);
  for (const std::string& out : {mesh, other, motion}) {
    CAPTURE(out);
    const std::string said =
        output_of("sim_server", {"record", scene, "--trajectory", client, "--rate", "30", "--out", out}, 2);
    CHECK(said.find(out) != std::string::npos);
  }
  const std::string traced = output_of("haptic_client", {"run", client, "--trace", motion}, 2);
  CHECK(traced.find("name the same file") != std::string::npos);
  output_of("haptic_client", {"run", client, "--report", motion}, 2);
  output_of("sim_server", {"run", scene, "--listen", "127.0.0.1:0", "--report", mesh}, 2);
  CHECK(contents(mesh) == mesh_was);
  CHECK(contents(motion) == motion_was);
  CHECK(contents(other) == other_was);
}

TEST_CASE("a tool that was held, but never touched: the server says so, and how near it came") {
  const TemporaryFolder folder;
  const std::string report = (folder.path() / "server.json").string();
  Server server({"--report", report}, "127.0.0.1:0", source_dir() + "/configs/scenes/block.toml");
  // The hand holds still at (0, 0.1, 0); the block's top is y = 0, the tool's radius 6 mm.
  const std::string client = folder.write("client.toml", "").string();
  Process process("haptic_client", {"run", client, "--server", server.address, "--seconds", "1"});
  CHECK(process.wait() == 0);
  server.process.signal(SIGINT);
  CHECK(server.process.wait() == 0);
  CHECK(read_json(report)["tools"][0]["missed_by_m"].get<double>() == Approx(0.094).epsilon(0.01));
  CHECK(server.process.output().find("never touched the organ") != std::string::npos);
}
