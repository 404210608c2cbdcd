// Histories and formulas of backward Euler and BDF2, against polynomials that they differentiate exactly and
// against the amplification of an oscillator.
#include "sim_server/solvers/time_stepping.h"

#include <complex>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

const Vec3 kX(0.3, -0.2, 1), kV(0.5, 0.1, -0.4), kA(-2, 3, 0.7);

/// Ends steps of `h` at the places of `x`, and gives the velocity at the end of the last but the first.
template <class Place>
TimeStepping stepped(bool second, double h, int steps, const Place& x) {
  TimeStepping time(std::vector<Vec3>{x(0.0)}, second);
  std::vector<Vec3> internal(1);
  for (int i = 1; i <= steps; ++i) {
    time.begin(h);
    internal[0] = x(i * h);
    time.end(std::vector<Vec3>{x(i * h)}, internal, false);
  }
  return time;
}

/// Growth per step of q'' = -w^2 q in the long run, by the norm of (w q, v).
double growth(bool second, double w, double h) {
  TimeStepping time(std::vector<Vec3>{Vec3(1, 0, 0)}, second);
  std::vector<Vec3> internal(1, Vec3::Zero());
  const auto norm = [&] { return std::hypot(w * time.position()[0][0], time.velocity()[0][0]); };
  double before = 0;
  for (int i = 0; i < 200; ++i) {
    if (i == 100) before = norm();
    time.begin(h);
    // x of c (c (x - x~) - v~) = -w^2 x, by its value and its slope at 0.
    const double at_zero = time.acceleration_at(0, time.velocity_at(0, Vec3::Zero()))[0],
                 at_one = time.acceleration_at(0, time.velocity_at(0, Vec3::UnitX()))[0];
    time.end(std::vector<Vec3>{Vec3(-at_zero / (at_one - at_zero + w * w), 0, 0)}, internal, false);
  }
  return std::pow(norm() / before, 0.01);
}

}  // namespace

TEST_CASE("time stepping: c is 1 / h of backward Euler and of the first step, then 3 / 2h of BDF2") {
  for (const bool second : {false, true}) {
    TimeStepping time(std::vector<Vec3>{kX}, second);
    std::vector<Vec3> internal(1, Vec3::Zero());
    CHECK(time.c() == 0);
    for (int i = 0; i < 3; ++i) {
      time.begin(0.25);
      time.begin(0.02);  // begun anew, with another length
      CHECK(time.c() == Approx((second && i > 0 ? 1.5 : 1) / 0.02));
      CHECK(time.step_length() == 0.02);
      CHECK(time.steps() == i);
      time.end(std::vector<Vec3>{kX}, internal, false);
    }
  }
}

TEST_CASE("time stepping: backward Euler is exact for lines, BDF2 for parabolas") {
  const double h = 0.01;
  const auto line = [](double t) -> Vec3 { return kX + t * kV; };
  const auto parabola = [](double t) -> Vec3 { return kX + t * kV + 0.5 * t * t * kA; };
  TimeStepping euler = stepped(false, h, 5, line), bdf2 = stepped(true, h, 5, parabola);
  CHECK((euler.velocity()[0] - kV).norm() < 1e-12);
  CHECK((bdf2.velocity()[0] - (kV + 5 * h * kA)).norm() < 1e-12);
  euler.begin(h);
  bdf2.begin(h);
  CHECK((euler.velocity_at(0, line(6 * h)) - kV).norm() < 1e-12);
  CHECK((bdf2.velocity_at(0, parabola(6 * h)) - (kV + 6 * h * kA)).norm() < 1e-12);
  // Of internal forces, which went the same way here.
  CHECK((euler.c() * euler.change_of_force(0, line(6 * h)) - kV).norm() < 1e-12);
  CHECK((bdf2.c() * bdf2.change_of_force(0, parabola(6 * h)) - (kV + 6 * h * kA)).norm() < 1e-12);
  // Accelerations from velocities that are exact, once the first step is three steps away.
  const Vec3 v = bdf2.velocity_at(0, parabola(6 * h));
  CHECK((bdf2.acceleration_at(0, v) - kA).norm() < 1e-9);
  CHECK(euler.acceleration_at(0, euler.velocity_at(0, line(6 * h))).norm() < 1e-9);
}

TEST_CASE(
    "time stepping: a node that slid goes on along the way of what was there, a copy along the same way") {
  const double h = 0.01;
  const auto place = [](int node, double t) -> Vec3 {  // two that go along parabolas, and one that rests
    return node == 0 ? Vec3(kX + t * kV + 0.5 * t * t * kA) : node == 1 ? Vec3(t * kX + t * t * kV) : kX;
  };
  const auto at = [&](double t) { return std::vector<Vec3>{place(0, t), place(1, t), place(2, t)}; };
  TimeStepping time(at(0), true);
  std::vector<Vec3> internal(3, Vec3::Zero());
  for (int i = 1; i <= 5; ++i) {
    time.begin(h);
    time.end(at(i * h), internal, false);
  }
  time.slide(0, 1, 0.25);
  time.slide(2, 1, 1);
  const auto slid = [&](double t) -> Vec3 { return 0.75 * place(0, t) + 0.25 * place(1, t); };
  CHECK((time.position()[0] - slid(5 * h)).norm() < 1e-15);
  CHECK(time.position()[2] == time.position()[1]);
  CHECK(time.velocity()[2] == time.velocity()[1]);
  time.begin(h);
  // BDF2 is exact for parabolas, so it finds their velocity at the end of the next step.
  const Vec3 v = 0.75 * (kV + 6 * h * kA) + 0.25 * (kX + 2 * 6 * h * kV);
  CHECK((time.velocity_at(0, slid(6 * h)) - v).norm() < 1e-12);
  CHECK((time.velocity_at(2, place(1, 6 * h)) - (kX + 2 * 6 * h * kV)).norm() < 1e-12);
  CHECK((time.acceleration_at(2, kX + 2 * 6 * h * kV) - 2 * kV).norm() < 1e-9);
}

TEST_CASE("time stepping: an oscillator loses what the formula says it does") {
  // With q = exp(i w t) ~ z^n, backward Euler has z = 1 / (1 - i w h), and BDF2 the larger root of
  // (3 z^2 - 4 z + 1) / 2 = i w h z^2.
  using namespace std::complex_literals;
  for (const double wh : {0.1, 0.5, 2.0}) {
    CAPTURE(wh);
    CHECK(growth(false, 10, wh / 10) == Approx(1 / std::abs(1.0 - 1i * wh)).epsilon(1e-6));
    const std::complex<double> root = (2.0 + std::sqrt(1.0 + 2i * wh)) / (3.0 - 2i * wh);
    CHECK(growth(true, 10, wh / 10) == Approx(std::abs(root)).epsilon(1e-3));
  }
}

TEST_CASE("time stepping: a step that ends at rest forgets the velocities, a restart the history") {
  TimeStepping time = stepped(true, 0.01, 4, [](double t) -> Vec3 { return kX + t * kV; });
  std::vector<Vec3> internal(1, kA);
  time.begin(0.01);
  time.end(std::vector<Vec3>{kX}, internal, true);
  CHECK(time.velocity()[0] == Vec3(0, 0, 0));
  CHECK(time.internal_force()[0] == kA);
  time.begin(0.01);
  CHECK(time.velocity_at(0, kX).norm() < 1e-12);
  CHECK(time.acceleration_at(0, Vec3::Zero()) == Vec3(0, 0, 0));
  CHECK(time.change_of_force(0, kA).norm() < 1e-12);  // as if it had been there before

  time = stepped(true, 0.01, 4, [](double t) -> Vec3 { return kX + t * kV; });
  time.restart(std::vector<Vec3>{kA}, std::vector<Vec3>{kV}, std::vector<Vec3>{kX});
  CHECK(time.velocity()[0] == kV);
  time.begin(0.01);
  CHECK(time.velocity_at(0, kA).norm() < 1e-10);
  CHECK(time.change_of_force(0, kX).norm() < 1e-15);

  time = stepped(true, 0.01, 4, [](double t) -> Vec3 { return kX + t * kV; });
  time.restart(std::vector<Vec3>{kA}, std::vector<Vec3>{-kV}, std::vector<Vec3>{kX});
  time.begin(0.01);
  CHECK(time.acceleration_at(0, -kV).norm() < 1e-9);  // it goes on as it is, whatever it was before
}
