// Setting up the liver that ships: all of it, and its parts. The rows share a few set-ups, so that parts add
// up.
#include <algorithm>
#include <deque>

#include "sim_server/simulation/setup_times.h"
#include "tests/bench/bench.h"
#include "tests/bench/liver.h"

namespace palpate::bench {
using namespace sim;

namespace {

struct SetUp {
  SetUp() {
    const Scene scene = test::liver_scene();
    Simulation simulation(scene, std::ref(times));
    hash = contact_hash(scene, simulation, find_press(scene, simulation));
  }
  SetupTimes times;
  std::uint64_t hash = 0;  // of what was set up, after some steps
};

/// Set-up number `n`, done when it is first asked for.
const SetUp& set_up(std::size_t n) {
  static std::deque<SetUp> done;
  while (done.size() <= n) done.emplace_back();
  return done[n];
}

/// Repetition n of every row tells of set-up n.
template <class Part>
void add_part(const std::string& name, Part part) {
  add("setup/" + name,
      [part, n = std::size_t{0}](benchmark::State& state) mutable {
        const SetUp& one = set_up(n++);
        show(state, one.hash);
        for (auto _ : state) state.SetIterationTime(to_seconds(part(one.times)));
      })
      ->UseManualTime()
      ->Iterations(1);
}

}  // namespace

void add_setup_rows() {
  add_part("total", [](const SetupTimes& times) { return times.total(); });
  for (const SetupTimes::Stage& stage : set_up(0).times.stages()) {
    std::string name = stage.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    add_part(name, [what = stage.name](const SetupTimes& times) { return times.of(what); });
  }
}

}  // namespace palpate::bench
