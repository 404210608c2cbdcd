#include "haptic_client/evaluation/law_cost.h"

#include <algorithm>
#include <array>

#include "common/clock.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {

double ns_per_tick(const std::string& law) {
  using namespace std::chrono_literals;
  constexpr int kTicks = 20000;
  ForceEstimate estimate(find_row(extrapolators(), law, "method", "cost").make());
  estimate.take({1, 1ms, {0, 0, 0}, {0, 1, 0}}, 1s);
  estimate.take({2, 34ms, {0.001, 0, 0}, {0, 1.5, 0.1}}, 1s);
  std::array<double, 9> rounds{};
  Vec3 p(0.001, 0, 0), sum = Vec3::Zero();
  for (double& round : rounds) {
    const Time start = now();
    for (int i = 0; i < kTicks; ++i) {
      p[0] += 1e-8;
      sum += estimate.force(p, 34ms + Time{i});
    }
    round = static_cast<double>((now() - start).count()) / kTicks;
  }
  volatile double used = sum.norm();  // or the compiler would leave the loop out
  (void)used;
  std::nth_element(rounds.begin(), rounds.begin() + rounds.size() / 2, rounds.end());
  return rounds[rounds.size() / 2];
}

}  // namespace palpate::client
