// Every law behind every fault that a link can have.
#include "haptic_client/device/simulated_operator.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/catch.h"
#include "tests/support/closed_loop.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

constexpr double kMost = 4;  // N

protocol::LinkConditions bad_link(double corrupted) {
  return {.delay = 0.005,
          .jitter = 0.05,
          .loss = 0.05,
          .burst_begin = 0.02,
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

}  // namespace

TEST_CASE("bad link: whatever it does to the samples, the force is finite and within its limits") {
  for (const ExtrapolatorRow& row : extrapolators()) {
    CAPTURE(row.name);
    protocol::LinkCounts counts;
    const double felt = largest_force(row, 0, counts);
    CHECK(felt <= kMost * (1 + 1e-9));
    CHECK(felt > 0.5);
    for (const std::uint64_t count :
         {counts.lost, counts.lost_in_bursts, counts.partitioned, counts.duplicated, counts.reordered})
      CHECK(count > 0);
    // A wrong byte that is still a message may be any force, or end the session; it stays bounded.
    CHECK(largest_force(row, 0.2, counts) <= kMost * (1 + 1e-9));
    CHECK(counts.corrupted > 0);
  }
}
