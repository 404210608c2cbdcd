#ifdef PALPATE_WITH_CAPTURE
// Recorded motions through the real programs: what they say of a file, what they refuse, and the force on a
// tool that turns.
#include <algorithm>

#include "tests/support/column.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;
using Catch::Matchers::Contains;

namespace {

/// A rigid column of 1000 N/m, its top at y = 0.4 m, and a tool over it.
struct Recording {
  TemporaryFolder folder;
  std::string report = (folder.path() / "report.json").string(), scene;

  explicit Recording(const std::string& tool) {
    folder.write("column.msh", column());
    scene = folder
                .write("scene.toml",
                       "rate_hz = 100\n[mesh]\nfile = \"column.msh\"\n[deformation]\nmodel = "
                       "\"rigid\"\nstiffness = 1000\n[[tool]]\n" +
                           tool)
                .string();
  }
  std::string file(const std::string& name, const std::string& text) {
    return folder.write(name, text).string();
  }
  std::string record(const std::string& motion, int expected_code) {
    return output_of("sim_server",
                     {"record", scene, "--trajectory", motion, "--rate", "100", "--out",
                      (folder.path() / "r.pcap").string(), "--force", "--report", report},
                     expected_code);
  }
};

/// A second at 100 Hz at rest, without the rows from 30 to 69.
std::string with_hole() {
  std::string rows = "t_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 100; ++i) {
    if (i < 30 || i >= 70) rows += fmt::format("{},0.05,0.5,0.05\n", 0.01 * i);
  }
  return rows;
}

}  // namespace

TEST_CASE("record: a motion that never touches says so, and how near it came") {
  Recording bench("radius = 0.03\n");
  const std::string motion =
      bench.file("above.csv", "t_s,x_m,y_m,z_m\n0,0.05,0.6,0.05\n0.5,0.05,0.5,0.05\n1,0.05,0.5,0.05\n");
  const std::string said = bench.record(motion, 0);
  CHECK_THAT(said, Contains("tool 1 never touched the organ: it came within 70.0 mm of it"));
  CHECK_THAT(said, Contains("above.csv: 3 rows, 1 s at 2 Hz, x 50 to 50 mm, y 500 to 600 mm, z 50 to 50 mm"));
  CHECK(read_json(bench.report)["missed_by_m"].get<double>() == Approx(0.07).epsilon(1e-6));
  bench.record(bench.file("in.csv", "t_s,x_m,y_m,z_m\n0,0.05,0.42,0.05\n1,0.05,0.42,0.05\n"), 0);
  CHECK(read_json(bench.report)["missed_by_m"].is_null());
}

TEST_CASE("record: a capsule turns as its file says, so that its far end presses 15 mm deep") {
  Recording bench("shape = \"capsule\"\nradius = 0.01\nlength = 0.06\n");
  // Along +z it lies 45 mm above; turned by 90 degrees about x its far end is at y = 0.395 m.
  const auto text = [](const char* q) {
    return fmt::format(
        "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0.05,0.455,0.05,1,0,0,0\n0.5,0.05,0.455,0.05,{0}\n"
        "1,0.05,0.455,0.05,{0}\n",
        q);
  };
  bench.record(bench.file("still.csv", text("1,0,0,0")), 0);
  CHECK(read_json(bench.report)["max_newton"] == 0);
  bench.record(bench.file("turned.csv", text("0.70710678,0.70710678,0,0")), 0);
  CHECK(read_json(bench.report)["max_newton"].get<double>() == Approx(1000 * 0.015).epsilon(1e-3));
}

TEST_CASE("record, study and run: a hole is one line and exit code 2, until the client file accepts it") {
  Recording bench("radius = 0.03\n");
  const std::string motion = bench.file("hole.csv", with_hole()),
                    client = bench.file("client.toml", "[trajectory]\nfile = \"hole.csv\"\n"),
                    accepts = bench.file("accepts.toml", "[trajectory]\nfile = \"hole.csv\"\ngap = 0.45\n");
  const std::string soft = bench.file(
      "soft.toml",
      "rate_hz = 30\n[mesh]\nfile = \"column.msh\"\n[material]\nyoung_modulus = 2e4\npoisson_ratio = 0.3\n"
      "[[fixed]]\nbox = [[-1, -1, -1], [1, 0.001, 1]]\n[[tool]]\nradius = 0.03\n[deformation]\nmodel = "
      "\"quasi_static\"\n");
  const std::string hole = "hole.csv:32: a hole of 0.41 s at 0.29 s: no rows, which come every 0.01 s";
  for (const std::string& given : {motion, client}) CHECK_THAT(bench.record(given, 2), Contains(hole));
  CHECK_THAT(bench.record(accepts, 0), Contains("hole.csv: 61 rows, 1 s"));
  CHECK_THAT(
      output_of("sim_server",
                {"study", soft, "--trajectory", client, "--out", (bench.folder.path() / "study").string()},
                2),
      Contains(hole));
  CHECK_THAT(output_of("haptic_client", {"run", client, "--server", "127.0.0.1:9", "--seconds", "1"}, 2),
             Contains(hole));
}

TEST_CASE("record: a capture of before is kept beside the new one, unless --force is given") {
  Recording bench("radius = 0.03\n");
  const auto path = [&](const char* name) { return (bench.folder.path() / name).string(); };
  const std::string motion = bench.file("in.csv", "t_s,x_m,y_m,z_m\n0,0.05,0.42,0.05\n1,0.05,0.42,0.05\n");
  const auto record = [&](const char* name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"record", bench.scene, "--trajectory", motion,
                                       "--rate", "100",       "--out",        path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return output_of("sim_server", arguments, 0);
  };
  bench.file("old.pcap", "of before");
  CHECK_THAT(record("old.pcap"), Contains("what was there is kept as " + path("old.pcap.~1~")));
  CHECK(bytes_of(path("old.pcap.~1~")) == "of before");
  const std::string first = bytes_of(path("old.pcap"));
  CHECK(first.size() > 1000);
  record("old.pcap");
  CHECK(bytes_of(path("old.pcap.~2~")) == first);
  record("old.pcap", {"--force"});
  CHECK_FALSE(std::filesystem::exists(path("old.pcap.~3~")));
  bench.file("empty.pcap", "");  // nothing to lose
  record("empty.pcap");
  CHECK_FALSE(std::filesystem::exists(path("empty.pcap.~1~")));
}
#endif
