#include "sim_server/setup_cache/setup_cache.h"

#include <atomic>
#include <fstream>
#include <thread>

#include "common/error.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

namespace fs = std::filesystem;

Digest key_of(std::uint64_t number) {
  Fingerprint fingerprint;
  fingerprint.add(std::span<const std::uint64_t>(&number, 1));
  return fingerprint.digest();
}

Eigen::MatrixXd numbers(int n) {
  return Eigen::MatrixXd::NullaryExpr(n, n, [](Eigen::Index i, Eigen::Index j) {
    return 0.1 * static_cast<double>(i) - 0.3 * static_cast<double>(j);
  });
}

fs::path file_of(const fs::path& folder, std::uint64_t number) {
  return folder / (to_text(key_of(number)) + ".setup");
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

std::ptrdiff_t files_in(const fs::path& folder) {
  const fs::directory_iterator files(folder);
  return std::distance(begin(files), end(files));
}

}  // namespace

TEST_CASE("setup cache: what is kept is found, bit by bit, and stays as it is when a finder writes on it") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path() / "not" / "there");
  CHECK_FALSE(cache.find(key_of(1)));
  cache.keep(key_of(1), 2.5, numbers(15));
  CHECK_FALSE(cache.find(key_of(2)));
  for (int again = 0; again < 2; ++again) {
    const auto found = cache.find(key_of(1));
    REQUIRE(found);
    CHECK(found->matrix() == numbers(15));
    CHECK(found->note_of_saved("there") == "from there, which saved 2.5 s");
    found->matrix().setZero();  // copy-on-write
  }
}

TEST_CASE("setup cache: a matrix of more than a million rows is found, as of the modes of a large organ") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path());
  const Eigen::MatrixXd tall = Eigen::VectorXd::LinSpaced(1'300'000, 0, 1);
  cache.keep(key_of(1), 1, tall);
  const auto found = cache.find(key_of(1));
  REQUIRE(found);
  CHECK(found->matrix() == tall);
}

TEST_CASE("setup cache: an entry with any byte of header or numbers changed, or cut, is never taken") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path());
  const auto keep = [&] { cache.keep(key_of(7), 1, numbers(12)); };
  keep();
  const fs::path file = file_of(folder.path(), 7);
  const std::string entire = bytes_of(file);
  REQUIRE(entire.size() == 4096 + 12 * 12 * sizeof(double));
  const std::size_t header = 48;  // bytes that mean something; the rest of the page is padding
  for (std::size_t at = 0; at < entire.size(); at += at < header ? 1 : at < 4096 ? 4096 - header : 7) {
    if (at >= header && at < 4096) continue;
    CAPTURE(at);
    std::string spoilt = entire;
    spoilt[at] = static_cast<char>(spoilt[at] ^ 0x40);
    write_bytes(file, spoilt);
    CHECK_FALSE(cache.find(key_of(7)));
    CHECK_FALSE(fs::exists(file));  // removed, to be made again
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{4096}, entire.size() - 1}) {
    CAPTURE(size);
    write_bytes(file, entire.substr(0, size));
    CHECK_FALSE(cache.find(key_of(7)));
  }
  write_bytes(file, entire + "x");
  CHECK_FALSE(cache.find(key_of(7)));
  keep();
  CHECK(cache.find(key_of(7)));
  fs::rename(file, file_of(folder.path(), 8));  // another's name
  CHECK_FALSE(cache.find(key_of(8)));
}

TEST_CASE("setup cache: an entry that would pass the bound removes all others, and no file of anybody else") {
  const test::TemporaryFolder folder;
  const auto keep = [&](std::uint64_t k, double entries) {
    SetupCache(folder.path(), entries * (4096 + 8 * 20 * 20)).keep(key_of(k), 1, numbers(20));
  };
  const std::vector<std::string> others{"notes.txt", "film.setup", "0123456789abcdef0123456789abcdeF.setup",
                                        "0123456789abcdef0123456789abcdef.txt"};
  for (const std::string& other : others) write_bytes(folder.path() / other, "mine");
  const fs::path half = file_of(folder.path(), 9).string() + ".0123abcd";  // of a writer that was interrupted
  write_bytes(half, "half");
  for (const std::uint64_t k : {1, 2}) keep(k, 2.5);
  CHECK(fs::exists(half));
  keep(3, 2.5);
  const SetupCache cache(folder.path());
  CHECK_FALSE(cache.find(key_of(1)));
  CHECK_FALSE(cache.find(key_of(2)));
  CHECK(cache.find(key_of(3)));
  CHECK_FALSE(fs::exists(half));
  keep(4, 0.5);  // too large even alone
  CHECK_FALSE(cache.find(key_of(4)));
  CHECK(cache.find(key_of(3)));
  for (const std::string& other : others) CHECK(bytes_of(folder.path() / other) == "mine");
}

TEST_CASE("setup cache: writers and finders at once find nothing, or all of an entry") {
  const test::TemporaryFolder folder;
  std::atomic<int> taken = 0, wrong = 0;
  {
    std::vector<std::jthread> programs;
    for (int i = 0; i < 4; ++i)
      programs.emplace_back([&] {
        const SetupCache cache(folder.path(), 3 * 8 * 50 * 50);  // holds the first three of four entries
        for (int round = 0; round < 50; ++round) {
          const auto k = static_cast<std::uint64_t>(round % 4);
          if (const auto found = cache.find(key_of(k))) ++(found->matrix() == numbers(50) ? taken : wrong);
          cache.keep(key_of(k), 1, numbers(50));
        }
      });
  }
  CHECK(wrong == 0);
  CHECK(taken > 0);
}

TEST_CASE("setup cache: a folder that cannot be written to is one in which nothing is found") {
  const test::TemporaryFolder folder;
  write_bytes(folder.path() / "file", "");
  const SetupCache cache(folder.path() / "file" / "folder");
  cache.keep(key_of(1), 1, numbers(3));
  CHECK_FALSE(cache.find(key_of(1)));
}

TEST_CASE("setup cache: a fingerprint tells spans, their ends and their order apart") {
  const auto of = [](std::vector<int> a, std::vector<int> b) {
    Fingerprint fingerprint;
    fingerprint.add(std::span<const int>(a));
    fingerprint.add(std::span<const int>(b));
    return fingerprint.digest();
  };
  CHECK(of({1, 2}, {3}) == of({1, 2}, {3}));
  CHECK(of({1, 2}, {3}) != of({1}, {2, 3}));
  CHECK(of({1, 2}, {3}) != of({3}, {1, 2}));
  CHECK(of({1, 2}, {3}) != of({1, 2}, {4}));
}

TEST_CASE(
    "setup cache: a simulation from the cache is the same, bit by bit, and another tissue or reach is not "
    "found") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path());
  const std::string scenes = test::source_dir() + "/configs/scenes/";
  const std::vector<const char*> names{"liver_paper", "liver_reduced", "liver_tensor_mass", "liver_implicit"};
  for (const char* name : names) {
    DYNAMIC_SECTION(name) {
      const Scene scene = read_scene(scenes + name + ".toml");
      const auto pressed = [&](Simulation& simulation) {
        const Vec3 top = simulation.rest()[static_cast<std::size_t>(simulation.surface().triangles[0][0])];
        for (int k = 0; k < 10; ++k) simulation.step(Vec3(top + Vec3(0, 0.006 - 0.001 * k, 0)), 1.0 / 30);
        return simulation.state_hash();
      };
      Simulation plain(scene), first(scene, kSilent, &cache);
      const std::ptrdiff_t entries = files_in(folder.path());
      Simulation second(scene, kSilent, &cache);
      CHECK(files_in(folder.path()) == entries);
      const auto parts = second.memory();
      CHECK(std::ranges::any_of(parts, [](const MemoryPart& part) {
        return part.detail.find("from the set-up cache") != std::string::npos;
      }));
      const std::uint64_t hash = pressed(plain);
      CHECK(pressed(first) == hash);
      CHECK(pressed(second) == hash);
      Scene softer = scene;
      softer.material->young_modulus *= 0.999;
      Simulation third(softer, kSilent, &cache);
      CHECK(files_in(folder.path()) == 2 * entries);
    }
  }
}
