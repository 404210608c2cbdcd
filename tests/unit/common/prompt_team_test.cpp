#include "common/prompt_team.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>

#include "tests/support/catch.h"

using namespace palpate;

namespace {

/// Rounds of a sum in parts that each depend on all parts of the round before.
std::vector<std::uint64_t> rounds_by(int helpers, std::uint32_t parts, int rounds) {
  PromptTeam team(helpers);
  std::vector<std::uint64_t> before(parts), after(parts);
  std::iota(before.begin(), before.end(), 1);
  for (int round = 0; round < rounds; ++round) {
    team.run(parts, [&](std::uint32_t part) {
      after[part] = std::accumulate(before.begin(), before.end(), std::uint64_t{part} * 0x9e3779b97f4a7c15);
    });
    std::swap(before, after);
  }
  return before;
}

}  // namespace

TEST_CASE("PromptTeam: each part is done once, whatever the number of helpers, and seen by the next round",
          "[threads]") {
  for (const std::uint32_t parts : {1U, 2U, 3U, 16U}) {
    const std::vector<std::uint64_t> expected = rounds_by(0, parts, 5000);
    for (const int helpers : {1, 2, 4}) {
      CAPTURE(parts, helpers);
      CHECK(rounds_by(helpers, parts, 5000) == expected);
    }
  }
}

TEST_CASE("PromptTeam: of many parts none is left out, and none is done twice", "[threads]") {
  PromptTeam team(3);
  std::vector<int> times(PromptTeam::kMostParts, 0);
  for (int round = 1; round <= 20; ++round) {
    team.run(PromptTeam::kMostParts, [&](std::uint32_t part) { ++times[part]; });
    CHECK(std::ranges::all_of(times, [round](int done) { return done == round; }));
  }
  team.run(0, [&](std::uint32_t part) { ++times[part]; });
  CHECK(times.front() == 20);
}

TEST_CASE("PromptTeam: helpers that fell asleep meanwhile help again, and a team ends awake or asleep",
          "[threads]") {
  std::array<std::uint64_t, 8> sums{};
  const auto work = [&](std::uint32_t part) { sums[part] += part; };
  for (const bool sleeps : {false, true}) {
    PromptTeam team(2);
    for (int round = 0; round < 20; ++round) {
      team.run(8, work);
      if (sleeps) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  for (std::size_t part = 0; part < 8; ++part) CHECK(sums[part] == 40 * part);
  for (int teams = 0; teams < 1000; ++teams) PromptTeam(2).run(8, work);
  for (std::size_t part = 0; part < 8; ++part) CHECK(sums[part] == 1040 * part);
}

TEST_CASE("PromptTeam: a helper does a part while another is held up", "[threads]") {
  // Who begins with the first part waits until another has done the last one.
  PromptTeam team(1);
  std::atomic<bool> done{false};
  team.run(2, [&](std::uint32_t part) {
    if (part == 1) done = true;
    while (part == 0 && !done) std::this_thread::yield();
  });
  CHECK(done);
}
