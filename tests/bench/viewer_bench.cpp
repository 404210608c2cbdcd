// What the live page costs the simulation thread: a step of the liver in contact, with all that is done for
// pages in that thread, thirty times a second, as caches are when it is live. Side by side: without the page,
// and with none, one and five looking on, one of them stalled. And what the page's own thread does.
#include <atomic>
#include <list>
#include <numbers>
#include <optional>
#include <thread>

#include "common/clock.h"
#include "protocol/auth.h"
#include "sim_server/commands/live_view.h"
#include "sim_server/commands/pictures.h"
#include "tests/bench/bench.h"
#include "tests/bench/liver.h"
#include "tests/support/web_page.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr Time kPeriod = std::chrono::microseconds(33'333);

/// Some pages in threads of their own; a stalled one says hello and then reads nothing.
class Pages {
 public:
  Pages(std::uint16_t port, int reading, int stalled) {
    for (int k = 0; k < reading + stalled; ++k) {
      pages_.emplace_back(test::PageAddress{port, ""});
      if (!pages_.back().open()) fail_at_run_time("a page was turned away");
      pages_.back().hello();
      if (k < reading) {
        threads_.emplace_back([&page = pages_.back()](const std::stop_token& stop) {
          while (!stop.stop_requested()) page.next(0.1);
        });
      }
    }
  }

 private:
  std::list<test::WebPage> pages_;
  std::list<std::jthread> threads_;  // end before the pages do
};

/// The liver under a tool that slides on it, as a client moves it.
struct Slide {
  Scene scene = test::liver_scene();
  Simulation simulation{scene};
  ServedTools served{simulation};
  Press press = find_press(scene, simulation);
  std::vector<SessionInput> inputs{1};
  int steps = 0;

  LoopTurn step() {
    const double phi = 2 * std::numbers::pi * steps++ / 40;
    inputs[0].session = 1;
    inputs[0].fresh = true;
    inputs[0].state.p_W = press.place + 0.1 * scene.tools[0].shape.radius * std::sin(phi) * Vec3::UnitX();
    const Time start = now();
    const auto outcomes = served.step(inputs, to_seconds(kPeriod));
    return {inputs, outcomes, start, now() - start, to_seconds(kPeriod), 0};
  }
};

/// Pages that read, and that do not; none: without a page's thread.
void run_step(benchmark::State& state, std::optional<std::pair<int, int>> looking_on) {
  Slide slide;
  std::optional<LiveView> view;
  std::jthread serving;
  std::optional<Pages> pages;
  if (looking_on) {
    view.emplace(*read_viewer_address("0"), "", facts_of(slide.scene, slide.simulation), slide.simulation,
                 now());
    serving = std::jthread([&] { view->viewer().run(); });
    pages.emplace(view->viewer().endpoint().port, looking_on->first, looking_on->second);
  }
  Time deadline = now();
  for (auto _ : state) {
    sleep_until(deadline += kPeriod);
    const Time begin = now();
    const LoopTurn turn = slide.step();
    if (view) view->turned(turn);
    state.SetIterationTime(to_seconds(now() - begin));
  }
  if (view) view->viewer().stop();
  show(state, slide.simulation.state_hash());
}

/// A frame of a surface of so many vertices, of which a tenth moved: as 16 bits, and what one page gets of
/// it.
void run_encoding(benchmark::State& state, std::size_t n) {
  std::vector<Vec3> rest(n);
  for (std::size_t v = 0; v < n; ++v) rest[v] = Vec3::Constant(1e-3 * static_cast<double>(v % 100));
  const ViewBox box = view_box(rest);
  std::vector<float> positions(3 * n);
  std::vector<std::uint16_t> now_q(3 * n), had(3 * n);
  Bytes message;
  float shift = 0;
  for (auto _ : state) {
    shift += 1e-4F;
    for (std::size_t v = 0; v < n; v += 10) positions[3 * v] = shift;
    quantise(box, positions, now_q);
    write_surface({}, now_q, had, false, message);
    benchmark::DoNotOptimize(message.data());
    if (shift > 0.05F) shift = 0;
  }
  Fnv1a hash;
  write_surface({}, now_q, had, true, message);
  hash.add(message.data(), message.size());
  state.SetLabel(fmt::format("{} bytes whole", message.size()));
}

}  // namespace

void add_viewer_rows() {
  const auto add_step = [](const std::string& name, std::optional<std::pair<int, int>> looking_on) {
    add("viewer_step/" + name, [=](benchmark::State& state) { run_step(state, looking_on); })
        ->UseManualTime()
        ->Iterations(60)
        ->Unit(benchmark::kMicrosecond);
  };
  add_step("without", {});
  add_step("0_pages", std::pair(0, 0));
  add_step("1_page", std::pair(1, 0));
  add_step("5_pages", std::pair(5, 0));
  add_step("5_pages_1_stalled", std::pair(4, 1));
  for (const std::size_t n : {621U, 20000U})
    add(fmt::format("viewer_frame/{}", n), [=](benchmark::State& state) {
      run_encoding(state, n);
    })->Unit(benchmark::kMicrosecond);
}

}  // namespace palpate::bench
