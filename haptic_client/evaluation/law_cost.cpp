#include "haptic_client/evaluation/law_cost.h"

#include <algorithm>
#include <array>

#include "common/clock.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {

namespace {

using namespace std::chrono_literals;

/// A sample with everything a law may ask for, of a bent wall.
Sample full_sample(std::uint64_t number, Time t) {
  const double depth = 1e-3 + 1e-4 * static_cast<double>(number % 7);
  Sample sample{.number = number, .t = t, .p = {depth, 0, 0}, .f = {0, 1e3 * depth, 0.1}};
  Linearised linear{.p = sample.p, .f = sample.f, .normal = {0, 1, 0}};
  linear.k << -100, 20, 0, 20, -800, 30, 0, 30, -90;
  sample.here = linear;
  linear.p += Vec3(1e-3, 0, 0);
  sample.ahead = linear;
  return sample;
}

/// Median of `rounds` of the time (ns) of one of `calls` calls.
template <class Call>
double median_ns(int calls, Call call) {
  std::array<double, 9> rounds{};
  for (double& round : rounds) {
    const Time start = now();
    for (int i = 0; i < calls; ++i) call();
    round = static_cast<double>((now() - start).count()) / calls;
  }
  std::nth_element(rounds.begin(), rounds.begin() + rounds.size() / 2, rounds.end());
  return rounds[rounds.size() / 2];
}

}  // namespace

LawCost cost_of(const std::string& law) {
  ForceEstimate estimate(find_row(extrapolators(), law, "method", "cost").make());
  std::uint64_t number = 0;
  Time t = 1ms;
  Vec3 p(0.0015, 0, 0), sum = Vec3::Zero();
  LawCost cost;
  cost.arrival_ns = median_ns(500, [&] { estimate.take(full_sample(++number, t += 33ms), p, t); });
  cost.tick_ns = median_ns(20000, [&] {
    p[0] += 1e-8;
    sum += estimate.force(p, t += Time{1});
  });
  volatile double used = sum.norm();  // or the compiler would leave the loop out
  (void)used;
  return cost;
}

}  // namespace palpate::client
