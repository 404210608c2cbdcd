#include "haptic_client/evaluation/law_cost.h"

#include <algorithm>
#include <array>
#include <vector>

#include "common/clock.h"
#include "common/text.h"
#include "haptic_client/evaluation/captured_session.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/extrapolation/force_estimate.h"
#include "haptic_client/pipeline/pipeline.h"

namespace palpate::client {

namespace {

using namespace std::chrono_literals;

/// A sample with everything a law may ask for, of a bent wall.
Sample full_sample(std::uint64_t number, Time t) {
  const double depth = 1e-3 + 1e-4 * static_cast<double>(number % 7);
  Sample sample{.number = number, .t = t, .p = {depth, 0, 0}, .f = {0, 1e3 * depth, 0.1}};
  Linearisation linear{.p_W = sample.p, .f_W = sample.f, .normal_W = {0, 1, 0}};
  linear.tangent << -100, 20, 0, 20, -800, 30, 0, 30, -90;
  sample.at_tool = linear;
  linear.p_W += Vec3(1e-3, 0, 0);
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

double thread_ns() {
  return static_cast<double>(thread_time().count());
}

double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

LawCost cost_on(const std::string& law, const std::filesystem::path& capture, std::size_t run) {
  ForceEstimate estimate(find_row(extrapolators(), law, "method", "cost").make());
  SurfaceModel model;
  CapturedSession session(capture, run);
  std::vector<double> ticks, arrivals, clocks;
  for (CapturedTick tick; session.next(tick);) {
    const Vec3& p = tick.state.p_W;
    const Time t{tick.state.t_ns};
    for (const protocol::SurfacePage& page : tick.pages) model.take(page);
    const double before = thread_ns();
    const double start = thread_ns();
    clocks.push_back(start - before);
    if (tick.arrived) estimate.take(sample_of(*tick.arrived, &model), p, t);
    const double arrived = thread_ns();
    const Vec3 force = estimate.force(p, t);
    const double end = thread_ns();
    if (tick.arrived) arrivals.push_back(arrived - start);
    if (!tick.arrived && !force.isZero(0)) ticks.push_back(end - arrived);
  }
  const double clock = quantile(clocks, 0.5);
  const auto cost = [&](std::vector<double>& times, double fraction) {
    return std::max(0.0, quantile(times, fraction) - clock);
  };
  return {.tick_ns = cost(ticks, 0.5), .tick_p99_ns = cost(ticks, 0.99), .arrival_ns = cost(arrivals, 0.5)};
}

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
