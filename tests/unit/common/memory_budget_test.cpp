#include "common/memory_budget.h"

#include <cmath>
#include <fstream>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;

namespace {

/// A machine whose files say what a test wants them to.
struct Machine {
  test::TemporaryFolder folder;

  void write(const std::string& name, const std::string& text) const {
    const auto file = folder.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  /// The files of a control group's memory.
  void limit(const std::string& group, const std::string& most, const std::string& now) const {
    write("sys/fs/cgroup" + group + "/memory.max", most + "\n");
    write("sys/fs/cgroup" + group + "/memory.current", now + "\n");
  }
  double free() const { return free_memory(folder.path()); }
};

const std::string kMeminfo =
    "MemTotal:        8000000 kB\nMemFree:          100000 kB\nMemAvailable:    2000000 kB\nCached: 5 kB\n";

}  // namespace

TEST_CASE("free memory is what the kernel calls available") {
  Machine machine;
  CHECK(std::isinf(machine.free()));
  machine.write("proc/meminfo", kMeminfo);
  CHECK(machine.free() == 2000000. * 1024);
  machine.write("proc/meminfo", "MemTotal: 8000000 kB\nMemAvailable: many\n");
  CHECK(std::isinf(machine.free()));
}

TEST_CASE("a control group leaves less, with its caches counted as free") {
  Machine machine;
  machine.write("proc/meminfo", kMeminfo);
  SECTION("without a limit") {
    machine.limit("", "max", "500000000");
    CHECK(machine.free() == 2000000. * 1024);
  }
  SECTION("that of a container, at the root") {
    machine.limit("", "1000000000", "600000000");
    CHECK(machine.free() == 4e8);
    machine.write("sys/fs/cgroup/memory.stat", "anon 5\ninactive_file 100000000\nactive_file 7\n");
    CHECK(machine.free() == 5e8);
  }
  SECTION("its own, or one above") {
    machine.write("proc/self/cgroup", "1:name=systemd:/else\n0::/user/shell\n");
    machine.limit("/user", "900000000", "600000000");
    machine.limit("/user/shell", "max", "600000000");
    CHECK(machine.free() == 3e8);
    machine.limit("/user/shell", "700000000", "600000000");
    CHECK(machine.free() == 1e8);
    machine.limit("/user/shell", "500000000", "600000000");
    CHECK(machine.free() == 0);
  }
  SECTION("larger than the machine") {
    machine.limit("", "900000000000", "0");
    CHECK(machine.free() == 2000000. * 1024);
  }
}

TEST_CASE("what does not fit is refused with both numbers and a remedy") {
  CHECK_NOTHROW(require_memory(1e9, 1e9, "scene.toml", "W", "wait"));
  try {
    require_memory(2.592e9, 1.9e9, "scene.toml", "the compliance of 6000 nodes",
                   "give [[tool]] a `reach` box");
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.exit_code() == 2);
    CHECK(std::string(error.what()) ==
          "scene.toml: the compliance of 6000 nodes would take 2.6 GB, and 1.9 GB are free; give [[tool]] a "
          "`reach` box");
  }
  CHECK(bytes_text(27e6) == "27 MB");
  CHECK(bytes_text(4181832) == "4.18 MB");
  CHECK(bytes_text(0) == "0 MB");
}
