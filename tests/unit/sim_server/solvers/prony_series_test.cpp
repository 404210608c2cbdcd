// A Prony series alone, against closed forms of strains that come evenly and are held.
#include "sim_server/solvers/prony_series.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

const std::vector<Relaxation> kTerms{{0.3, 0.2}, {0.25, 1.5}};
const Mat3 kStress = (Mat3() << 3, 1, 0, 1, -2, 0.5, 0, 0.5, 4).finished();

Mat3 stress_of(const PronySeries& series, const Mat3& elastic, std::size_t point = 0) {
  return series.viscosity().scale * elastic + series.viscosity().memory[point];
}

/// Integral from 0 to t of R(s) = 1 - sum g (1 - exp(-s / tau)): the stress at t of one that grows by 1 a
/// second.
double ramp(double t) {
  double sum = t;
  for (const auto& [fraction, time] : kTerms) sum -= fraction * (t + time * std::expm1(-t / time));
  return sum;
}

}  // namespace

TEST_CASE("prony series: a stress that grows evenly and is held follows the closed form, whatever the step") {
  const double until = 0.6;  // then held
  for (const double h : {0.02, 0.1, 0.6}) {
    PronySeries series(kTerms, 1);
    for (int step = 1; step * h < 3; ++step) {
      const double t = step * h, grown = std::min(t, until);
      const Mat3 elastic = grown / until * kStress;
      series.begin(h / 3);  // begun anew, with another length
      series.begin(h);
      const double closed = (ramp(t) - (t > until ? ramp(t - until) : 0)) / until;
      CAPTURE(h, t);
      REQUIRE((stress_of(series, elastic) - closed * kStress).norm() < 1e-12 * kStress.norm());
      series.end(std::vector<Mat3>{elastic});
    }
  }
}

TEST_CASE("prony series: after a long time what lasts is what no term takes, of each point apart") {
  PronySeries series(kTerms, 2);
  for (int step = 0; step < 200; ++step) {
    series.begin(0.2);
    series.end(std::vector<Mat3>{kStress, -2 * kStress});
  }
  series.begin(0.2);
  CHECK((stress_of(series, kStress) - 0.45 * kStress).norm() < 1e-9 * kStress.norm());
  CHECK((stress_of(series, -2 * kStress, 1) + 0.9 * kStress).norm() < 1e-9 * kStress.norm());
}

TEST_CASE("prony series: a point without a stress keeps what it had, and without terms nothing relaxes") {
  PronySeries series(kTerms, 2), other(kTerms, 1);
  for (PronySeries* each : {&series, &other}) each->begin(0.1);
  series.end(std::vector<Mat3>{kStress, kStress});
  other.end(std::vector<Mat3>{kStress});
  series.begin(0.1);
  const Mat3 none = Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Mat3 before = series.viscosity().memory[0];
  series.end(std::vector<Mat3>{none, kStress});
  series.begin(0.1);
  CHECK(series.viscosity().memory[0] == before);
  CHECK(series.viscosity().memory[1] != before);

  const PronySeries nothing({}, 5);
  CHECK(nothing.empty());
  CHECK(nothing.bytes() == 0);
  CHECK(nothing.viscosity().scale == 1);
  CHECK(nothing.viscosity().memory.empty());
}
