// A haptic tick: the hand alone (which is in all the others), each law alone, the whole tick with each law,
// and what is written down after it.
#include "haptic_client/evaluation/observation.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/client_config.h"
#include "tests/bench/bench.h"
#include "tests/bench/palpation.h"

namespace palpate::bench {
using namespace client;

namespace {

constexpr int kFixed = 8 * Palpation::kTurn;  // ticks: past the soft start

void run_hand(benchmark::State& state) {
  Palpation hand;
  time_calls(state, kFixed, [&] {
    hand.next();
    return hand.tool().p_W;
  });
}

void run_law(benchmark::State& state, const ExtrapolatorRow& row) {
  Palpation hand;
  ForceEstimate estimate(row.make());
  time_calls(state, kFixed, [&] {
    hand.next();
    const Time t{hand.tool().t_ns};
    if (const auto* s = hand.arrived()) estimate.take(sample_of(*s), hand.tool().p_W, t);
    return estimate.force(hand.tool().p_W, t);
  });
}

void run_tick(benchmark::State& state, const ExtrapolatorRow& row) {
  Palpation hand;
  Pipeline pipeline(row.make(), {}, {});
  time_calls(state, kFixed, [&] {
    hand.next();
    return pipeline.render(hand.tool(), hand.arrived()).f_D;
  });
  if (pipeline.limiter().fault() != Fault::kNone || pipeline.watchdog().ramped() > 0)
    state.SkipWithError("the hand left what the safety ladder allows");
}

/// A turn of ticks as the pipeline gave them, to be told again and again.
class PublishedTicks {
 public:
  PublishedTicks() {
    Palpation hand;
    Pipeline pipeline(extrapolators().front().make(), {}, {});
    for (std::size_t i = 0; i < 2 * Palpation::kTurn; ++i) {
      hand.next();
      const TickResult result = pipeline.render(hand.tool(), hand.arrived());
      if (i >= Palpation::kTurn) results_[i % Palpation::kTurn] = result;
    }
  }
  const TickResult& next() noexcept {
    TickResult& result = results_[next_++ % Palpation::kTurn];
    constexpr Time kTurn = from_seconds(Palpation::kTurn / Palpation::kRate);
    result.tool.t_ns += kTurn.count();
    result.sample.t += kTurn;
    result.sample.number += Palpation::kTurn / Palpation::kPerSample;
    return result;
  }

 private:
  std::array<TickResult, Palpation::kTurn> results_;
  std::size_t next_ = 0;
};

void run_observation(benchmark::State& state, std::size_t keep) {
  PublishedTicks ticks;
  const auto laws = ClientConfig{}.scored_laws();
  Observation observation(laws, Palpation::kRate, "bench", Workspace{}, keep);
  time_calls(state, kFixed, [&] {
    const TickResult& published = ticks.next();
    observation.tick(published, Time{1000}, 0);
    return observation.scoring().forces()[published.tool.tick % laws.size()];
  });
}

/// No surface is told of this wall, so that a law that solves contact on one leaves its ticks to a simpler
/// one.
std::string name_of(const ExtrapolatorRow& row) {
  return std::string(row.name) + (row.make()->request().surface ? "_without_surface" : "");
}

}  // namespace

void add_law_rows() {
  add("hand", run_hand);
  for (const ExtrapolatorRow& row : extrapolators()) {
    add("law/" + name_of(row), [&row](benchmark::State& state) { run_law(state, row); });
  }
  for (const ExtrapolatorRow& row : extrapolators()) {
    add("tick/" + name_of(row), [&row](benchmark::State& state) { run_tick(state, row); });
  }
  add("observe/scores", [](benchmark::State& state) { run_observation(state, 0); });
  add("observe/scores_and_trace", [](benchmark::State& state) { run_observation(state, 30'000); });
}

}  // namespace palpate::bench
