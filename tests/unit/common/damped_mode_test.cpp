// One mode of a damped motion, against its closed forms.
#include "common/damped_mode.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace palpate;

namespace {
constexpr double kTime = 0.037, kQ = 0.3, kV = -2, kP = 5;

struct State {
  double q = kQ, v = kV;
};
State after(double time, double w, double damping, double p, State state = {}) {
  ModeStep::over(time, w, damping).advance(state.q, state.v, p);
  return state;
}
}  // namespace

TEST_CASE("damped mode: without damping it is a cosine about where the force holds it") {
  const double w = 40, held = kP / (w * w);
  const auto [q, v] = after(kTime, w, 0, kP);
  CHECK(q == Approx(held + (kQ - held) * std::cos(w * kTime) + kV / w * std::sin(w * kTime)).epsilon(1e-12));
  CHECK(v == Approx(-(kQ - held) * w * std::sin(w * kTime) + kV * std::cos(w * kTime)).epsilon(1e-12));
}

TEST_CASE("damped mode: critically damped, and overdamped, as in a textbook (Bathe 1996, section 9.3)") {
  const double w = 40;
  const State critical = after(kTime, w, 2 * w, 0);
  CHECK(critical.q == Approx((kQ + (kV + w * kQ) * kTime) * std::exp(-w * kTime)).epsilon(1e-9));
  const double g = 100, r = std::sqrt(g * g - w * w), quick = -g - r, slow = -g + r;
  const double a = (kV - quick * kQ) / (slow - quick);
  const State over = after(kTime, w, 2 * g, 0);
  CHECK(over.q == Approx(a * std::exp(slow * kTime) + (kQ - a) * std::exp(quick * kTime)).epsilon(1e-9));
}

TEST_CASE(
    "damped mode: two steps are one of twice the time, and in the end it rests where the force holds it") {
  for (const double damping : {0.0, 3.0, 80.0, 1000.0}) {
    CAPTURE(damping);
    const State once = after(2 * kTime, 40, damping, kP),
                twice = after(kTime, 40, damping, kP, after(kTime, 40, damping, kP));
    CHECK(twice.q == Approx(once.q).epsilon(1e-10));
    CHECK(twice.v == Approx(once.v).epsilon(1e-10).margin(1e-12));
    if (damping > 0) CHECK(after(100, 40, damping, kP).q == Approx(kP / 1600).epsilon(1e-6));
  }
}
