// Every law behind every fault that a link can have.
#include "haptic_client/device/simulated_operator.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/extrapolation/local_contact.h"
#include "tests/support/catch.h"
#include "tests/support/closed_loop.h"
#include "tests/support/served_block.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

constexpr double kMost = 4;  // N

protocol::LinkConditions bad_link(double corrupted) {
  return {.delay = 0.005,
          .jitter = 0.05,
          .loss = 0.05,
          .burst_start = 0.02,
          .burst_end = 0.2,
          .duplicates = 0.1,
          .reordered = 0.1,
          .reorder_delay = 0.1,
          .corrupted = corrupted,
          .bandwidth = 20'000,
          .delay_steps = {{3s, 0.2}, {5s, 0.005}},
          .partitions = {{6s, 6500ms}}};
}

/// A hand touches a wall, slides over it and leaves it. The largest force, N; NaN if one was not finite.
double largest_force(const ExtrapolatorRow& row, double corrupted, protocol::LinkCounts& counts) {
  SimulatedOperator hand({},
                         Trajectory({0, 1, 2, 7, 8}, {Vec3(0, 0.01, 0), Vec3(0, 0.01, 0), Vec3(0, -0.01, 0),
                                                      Vec3(0.02, -0.01, 0), Vec3(0, 0.01, 0)}));
  Pipeline pipeline(row.make(), {}, {.max_force = kMost, .max_slew = 100});
  test::ClosedLoop loop(hand, pipeline, test::served(test::wall(300)),
                        {.link = bad_link(corrupted), .seed = 7});
  double largest = 0;
  while (loop.seconds() < 8) {
    const Vec3 f = loop.tick().f_D;
    if (!f.allFinite()) return std::nan("");
    largest = std::max(largest, f.norm());
  }
  counts = loop.link();
  return largest;
}

/// The block with its pages.
test::Server served(sim::Simulation& block) {
  auto tools = std::make_shared<sim::ServedTools>(block);
  auto pager = std::make_shared<sim::SurfacePager>(block, 0);
  const auto step = [tools](const protocol::ToolState& state) {
    const std::vector<sim::SessionInput> inputs{{1, state, true}};
    return tools->step(inputs, 0.03).front().answer;
  };
  const auto pages = [pager](const protocol::ToolState& state) {
    std::vector<protocol::SurfacePage> found;
    if ((state.flags & protocol::ToolState::kAsksPages) == 0) return found;
    if (state.surface_version != pager->state().version) return found;
    for (const std::uint32_t number : state.pages) {
      if (protocol::SurfacePage page; pager->page(number, page)) found.push_back(page);
    }
    return found;
  };
  return {.step = step, .pages = pages};
}

/// What a hand felt that presses the block and slides over it, against the force of the block where it was,
/// N.
struct Rendered {
  double largest = 0, largest_true = 0;
  double off_at_end = 0;      // largest error in the last second, N: the link has long been good again
  bool entire_at_end = true;  // the model served then
  protocol::LinkCounts counts = {};
};

constexpr double kFaultsEnd = 4, kLastSecond = 6.5, kEnd = 7.5;  // s

SimulatedOperator presser() {
  return {{},
          Trajectory({0, 0.5, 1, 2, 3, 4, 5, 6, 7, 8},
                     {Vec3(0, 0.008, 0), Vec3(0, 0.008, 0), Vec3(0, 0.001, 0), Vec3(0.006, 0.001, 0),
                      Vec3(0, 0.007, 0.002), Vec3(-0.006, 0.001, 0), Vec3(0, 0.001, 0.004),
                      Vec3(0, 0.007, 0.004), Vec3(0.004, 0.001, 0), Vec3(-0.004, 0.001, 0)})};
}

Rendered press_block(const protocol::LinkConditions& link) {
  SimulatedOperator hand = presser();
  Pipeline pipeline(std::make_unique<LocalContact>(), {}, {.max_force = kMost, .max_slew = 100});
  sim::Simulation block(test::block_scene(), test::block_mesh()),
      truth(test::block_scene(), test::block_mesh());
  test::ClosedLoop loop(hand, pipeline, served(block), {.link = link, .seed = 7, .faults_end = kFaultsEnd});
  Rendered rendered;
  while (loop.seconds() < kEnd) {
    const bool last = loop.seconds() >= kLastSecond;
    const auto simpler = pipeline.stats().stepped_down;
    const TickResult tick = loop.tick();
    if (!tick.f_D.allFinite()) return {.largest = std::nan("")};
    const Vec3 right = truth.step(tick.tool.p_W, 0.001).force;
    rendered.largest = std::max(rendered.largest, tick.f_D.norm());
    rendered.largest_true = std::max(rendered.largest_true, right.norm());
    if (last) rendered.off_at_end = std::max(rendered.off_at_end, (tick.f_D - right).norm());
    if (last && pipeline.stats().stepped_down > simpler) rendered.entire_at_end = false;
  }
  rendered.counts = loop.link();
  return rendered;
}

}  // namespace

TEST_CASE("bad link: whatever it does to the samples, the force is finite and within its limits") {
  for (const ExtrapolatorRow& row : extrapolators()) {
    CAPTURE(row.name);
    protocol::LinkCounts counts = {};
    const double rendered = largest_force(row, 0, counts);
    CHECK(rendered <= kMost * (1 + 1e-9));
    CHECK(rendered > 0.5);
    for (const std::uint64_t count :
         {counts.lost, counts.lost_in_bursts, counts.partitioned, counts.duplicated, counts.reordered})
      CHECK(count > 0);
    // A wrong byte that is still a message may be any force, or end the session; it stays bounded.
    CHECK(largest_force(row, 0.2, counts) <= kMost * (1 + 1e-9));
    CHECK(counts.corrupted > 0);
  }
}

TEST_CASE("bad link: a law that has its model feels no more than the truth, and the truth when it is over") {
  using protocol::LinkConditions, protocol::LinkCounts;
  struct Fault {
    const char* name;
    LinkConditions link;
    std::uint64_t LinkCounts::*counted;
  };
  const Fault faults[] = {
      {"late", {.delay = 0.2}, &LinkCounts::delivered},
      {"later for a time",
       {.delay = 0.005, .delay_steps = {{2s, 0.2}, {3500ms, 0.005}}},
       &LinkCounts::delivered},
      {"jitter", {.delay = 0.005, .jitter = 0.1}, &LinkCounts::delivered},
      {"lost", {.delay = 0.005, .loss = 0.3}, &LinkCounts::lost},
      {"bursts", {.delay = 0.005, .burst_start = 0.05, .burst_end = 0.2}, &LinkCounts::lost_in_bursts},
      {"twice", {.delay = 0.005, .jitter = 0.02, .duplicates = 0.3}, &LinkCounts::duplicated},
      {"reordered", {.delay = 0.005, .reordered = 0.3, .reorder_delay = 0.1}, &LinkCounts::reordered},
      {"a thin line", {.delay = 0.005, .bandwidth = 20'000}, &LinkCounts::dropped_by_queue},
      {"cut", {.delay = 0.005, .partitions = {{2600ms, 3100ms}}}, &LinkCounts::partitioned},
      {"all at once", bad_link(0), &LinkCounts::dropped_by_queue}};
  for (const Fault& fault : faults) {
    CAPTURE(fault.name);
    const Rendered rendered = press_block(fault.link);
    CHECK(rendered.largest <= 1.01 * rendered.largest_true);
    CHECK(rendered.largest > 0.5);
    CHECK(rendered.off_at_end < 0.01 * rendered.largest_true);
    CHECK(rendered.entire_at_end);
    CHECK(rendered.counts.*fault.counted > 0);
  }
  // A wrong byte may be any force or end the session, as above.
  const Rendered rendered = press_block(bad_link(0.2));
  CHECK(rendered.largest <= kMost * (1 + 1e-9));
  CHECK(rendered.counts.corrupted > 0);
}

TEST_CASE("bad link: no more pages are requested than the link has room for, and all that lack come after") {
  SimulatedOperator hand = presser();
  Pipeline pipeline(std::make_unique<LocalContact>(), {}, {.max_force = kMost, .max_slew = 100});
  sim::Simulation block(test::block_scene(), test::block_mesh());
  test::ClosedLoop loop(hand, pipeline, served(block), {.link = {.delay = 0.005}});
  const auto requested = [&](double pages_hz, double until) {
    pipeline.bound_pages(pages_hz);
    int pages = 0;
    while (loop.seconds() < until) {
      const protocol::ToolState& tool = loop.tick().tool;
      if ((tool.flags & protocol::ToolState::kAsksPages) == 0) continue;
      pages += static_cast<int>(std::ranges::count_if(
          tool.pages, [](std::uint32_t page) { return page != protocol::ToolState::kNoPage; }));
    }
    return pages;
  };
  const int first = requested(0, 1);
  CHECK(first <= 2);  // allowed before anything is known
  const int few = requested(4, 3);
  CHECK(few > 0);
  CHECK(few <= 9);
  const int rest = requested(-1, kEnd);
  CHECK(rest > 9);
  CHECK(pipeline.stats().pages == static_cast<std::uint64_t>(first + few + rest));
}
