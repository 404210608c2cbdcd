// What a tick finds in its mailboxes, whether a client's or that of a C session.
#include <algorithm>

#include "haptic_client/extrapolation/local_contact.h"
#include "haptic_client/session/haptic_loop.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

/// Ticks at 500 Hz, 30 samples a second that name a surface, and no page of it.
class Hand {
 public:
  /// Returns how many pages are requested in this time.
  int requested(double pages_hz, Time span) {
    mailboxes_.pages_hz = pages_hz;
    int pages = 0;
    for (const Time end = t_ + span; t_ < end; t_ += 2ms) {
      if (++tick_ % 16 == 0) mailboxes_.force.write(sample());
      arrivals_.take(mailboxes_, pipeline_);
      const ToolState tool =
          pipeline_.tick({.t = t_, .p_D = Vec3(0, 0.001, 0)}, arrivals_.sample(), arrivals_.pages()).tool;
      if ((tool.flags & ToolState::kAsksPages) == 0) continue;
      pages += static_cast<int>(
          std::ranges::count_if(tool.pages, [](std::uint32_t page) { return page != ToolState::kNoPage; }));
    }
    return pages;
  }

 private:
  ForceSample sample() {
    return {.number = ++samples_,
            .tool_tick = tick_ - 8,
            .tool_t_ns = (t_ - 16ms).count(),
            .flags = ForceSample::kHasSurface,
            .surface = {.version = 5, .vertices = 5000, .triangles = 9996, .tool_radius = 0.005}};
  }

  HapticMailboxes mailboxes_;
  Arrivals arrivals_;
  Pipeline pipeline_{std::make_unique<LocalContact>(), {}, {}};
  Time t_ = 10s;
  std::uint64_t tick_ = 0, samples_ = 0;
};

}  // namespace

TEST_CASE("arrivals: the pages that a link leaves room for are what a tick may request") {
  Hand hand;
  CHECK(hand.requested(0, 2s) <= 2);  // allowed before anything is known
  const int few = hand.requested(4, 5s);
  CHECK(few >= 18);
  CHECK(few <= 21);
  CHECK(hand.requested(-1, 5s) > 2 * few);
}
