// What follows late, and what creeps under a load, against closed forms.
#include "common/relaxation.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace palpate;

TEST_CASE(
    "relaxation: what follows something that goes evenly is behind it by the closed form, at any step") {
  constexpr double kTime = 0.3, kSpeed = 2;
  for (const double h : {0.9, 0.01, 1e-7}) {
    const RelaxationStep step = RelaxationStep::over(h, kTime);
    double x = 0, follower = 0;
    for (int i = 0; i < 5; ++i) {
      follower = step.followed(follower, x, x + kSpeed * h);
      x += kSpeed * h;
    }
    const double t = 5 * h, right = kSpeed * (t + kTime * std::expm1(-t / kTime));
    CHECK(follower == Approx(right).epsilon(1e-6));
  }
  CHECK(RelaxationStep::over(0, kTime).followed(0.5, 1.0, 1.0) == 0.5);
}

TEST_CASE("relaxation: under a force held, one term creeps as a standard linear solid, to 1 / (1 - share)") {
  constexpr double kFraction = 0.6, kTime = 0.2;
  const std::array series{Relaxation{kFraction, kTime}};
  const Vec3 f(1, -2, 0.5);
  for (const double h : {0.002, 0.015}) {
    std::array<Vec3, kMostRelaxations> psi;
    psi.fill(Vec3::Zero());
    double worst = 0;
    for (int i = 1; i <= 400; ++i) {
      SeriesStep::over(h, series).creep(psi, f, f);
      const double crept = -std::expm1(-(1 - kFraction) * i * h / kTime) / (1 - kFraction);  // psi / f
      worst = std::max(worst, (psi[0] - crept * f).norm() / f.norm());
    }
    CHECK(worst < (h < 0.01 ? 1e-5 : 5e-4));  // of the second order in h
  }
}

TEST_CASE(
    "relaxation: a series of equal times is one term of all its shares, and in the end all has relaxed") {
  const std::array two{Relaxation{0.3, 0.5}, Relaxation{0.2, 0.5}},
      other{Relaxation{0.3, 0.02}, Relaxation{0.2, 4}};
  const std::array one{Relaxation{0.5, 0.5}};
  const Vec3 f(0, 3, 0);
  std::array<Vec3, kMostRelaxations> a, b, c;
  for (auto* const psi : {&a, &b, &c}) psi->fill(Vec3::Zero());
  for (int i = 0; i < 30; ++i) {
    SeriesStep::over(0.01, two).creep(a, i * f, (i + 1) * f);
    SeriesStep::over(0.01, one).creep(b, i * f, (i + 1) * f);
  }
  CHECK((0.3 * a[0] + 0.2 * a[1] - 0.5 * b[0]).norm() < 1e-12 * b[0].norm());
  for (int i = 0; i < 200; ++i) SeriesStep::over(1, other).creep(c, f, f);
  for (const std::size_t j : {0, 1}) CHECK((c[j] - 2 * f).norm() < 1e-6 * f.norm());  // 1 / (1 - 0.5)
}
