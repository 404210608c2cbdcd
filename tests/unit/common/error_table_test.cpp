#include "common/error_table.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;

namespace {

/// Of 500 Hz.
Time tick(int i) {
  return i * std::chrono::milliseconds(2);
}

}  // namespace

TEST_CASE("no contact, no errors: what was not measured is no number") {
  ErrorTable table(500);
  for (int i = 0; i < 10; ++i) table.add(Vec3::Zero(), ReferenceForce(Vec3::Zero(), tick(i)));
  const ErrorMetrics m = table.metrics();
  CHECK(std::isnan(m.mean_percent));
  CHECK(std::isnan(m.max_percent));
  CHECK(std::isnan(m.paper_max_force_percent));
  CHECK(to_json(m).dump().find(R"("overshoot_percent":null)") != std::string::npos);
}

TEST_CASE("errors of one tick in ten, by hand") {
  // The reference is 2 N along y, always. One tick in ten is 0.5 N too much: 25 % of the peak, of the RMS and
  // of the reference itself.
  ErrorTable table(500);
  for (int i = 0; i < 1000; ++i)
    table.add({0, i % 10 == 0 ? 2.5 : 2.0, 0}, ReferenceForce({0, 2, 0}, tick(i)));
  const ErrorMetrics m = table.metrics();
  CHECK(m.mean_percent == Approx(2.5));
  CHECK(m.p99_percent == Approx(25).epsilon(0.004));
  CHECK(m.max_percent == Approx(25));
  CHECK(m.overshoot_percent == Approx(25));
  CHECK(m.exceed_percent == Approx(10));
  CHECK(m.paper_mean_percent == Approx(2.5));
  CHECK(m.paper_max_percent == Approx(25));
  CHECK(m.paper_max_force_percent == Approx(125));
  CHECK(m.jump_percent == 0);
  table.add_jump(0.1);
  table.add_jump(0.05);
  CHECK(table.metrics().jump_percent == Approx(5));
}

TEST_CASE("an error across the force counts like one along it") {
  ErrorTable table(500);
  table.add({0.3, 2, 0.4}, ReferenceForce({0, 2, 0}, tick(0)));
  CHECK(table.metrics().paper_max_percent == Approx(25));
  CHECK(table.metrics().paper_max_force_percent == Approx(100 * std::sqrt(4.25) / 2));
}

TEST_CASE("a force where there should be none counts, but is no part of the paper's quotient") {
  ErrorTable table(500);
  for (int i = 0; i < 3; ++i) table.add({0, 1, 0}, ReferenceForce({0, 1, 0}, tick(i)));
  table.add({0, 0.5, 0}, ReferenceForce(Vec3::Zero(), tick(3)));
  const ErrorMetrics m = table.metrics();
  CHECK(m.max_percent == Approx(50));
  CHECK(m.overshoot_percent == 0);
  CHECK(m.mean_percent == Approx(100 * 0.5 / 4));
  CHECK(m.paper_max_percent == 0);
}

TEST_CASE("in one pass the same as all at once, whatever the order of small and large forces") {
  test::Random random(31);
  std::vector<double> reference, force;
  ErrorTable table(500);
  for (int i = 0; i < 20000; ++i) {
    const double r = std::exp(random.between(-9, 1)), f = r * random.between(0.2, 2.5);
    reference.push_back(r);
    force.push_back(f);
    table.add({0, 0, f}, ReferenceForce({0, 0, r}, tick(i)));
  }
  const double peak = *std::ranges::max_element(reference), floor = 0.1 * peak;
  double sum = 0, squares = 0, paper = 0, paper_max = 0, paper_force = 0;
  std::vector<double> errors;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double e = std::abs(force[i] - reference[i]), quotient = std::max(reference[i], floor);
    errors.push_back(e);
    sum += e, squares += reference[i] * reference[i], paper += e / quotient;
    paper_max = std::max(paper_max, e / quotient);
    paper_force = std::max(paper_force, force[i] / quotient);
  }
  std::ranges::sort(errors);
  const auto n = static_cast<double>(reference.size());
  const ErrorMetrics m = table.metrics();
  CHECK(m.mean_percent == Approx(100 * (sum / n) / std::sqrt(squares / n)));
  CHECK(m.p99_percent == Approx(100 * errors[static_cast<std::size_t>(0.99 * n) - 1] / peak).epsilon(0.008));
  CHECK(m.max_percent == Approx(100 * errors.back() / peak));
  CHECK(m.paper_mean_percent == Approx(100 * paper / n).epsilon(0.01));  // one bin of 9 % straddles the floor
  CHECK(m.paper_max_percent == Approx(100 * paper_max).epsilon(0.1));
  CHECK(m.paper_max_force_percent == Approx(100 * paper_force).epsilon(0.1));
}

TEST_CASE("roughness is what lies above 30 Hz") {
  const auto rough_at = [](double hz) {
    ErrorTable table(500);
    constexpr int kTicks = 50000;
    for (int i = 0; i < kTicks; ++i) {
      const double e = 0.1 * std::sin(2 * std::numbers::pi * hz * i / 500);
      table.add({0, 2 + e, 0}, ReferenceForce({0, 2, 0}, tick(i)));
    }
    return table.metrics().rough_percent;
  };
  const double rms = 100 * 0.1 / std::numbers::sqrt2 / 2;
  CHECK(rough_at(120) == Approx(rms).epsilon(0.01));
  CHECK(rough_at(30) == Approx(rms / std::numbers::sqrt2).epsilon(0.01));  // the corner: 3 dB down
  // Second order: at 3 Hz the analogue filter passes (3/30)^2 = 1 %.
  CHECK(rough_at(3) == Approx(0.01 * rms).epsilon(0.05));
}

TEST_CASE("means over 10 ms of an error that turns about at every tick are none") {
  ErrorTable turning(2000), constant(2000), slow(150);
  for (int i = 0; i <= 2000; ++i) {
    const ReferenceForce reference({0, 2, 0}, i * std::chrono::microseconds(500));
    turning.add({i % 2 == 0 ? 0.1 : -0.1, 2, 0}, reference);
    // In one window in ten, 0.1 N.
    constant.add({i / 20 % 10 == 3 ? 0.1 : 0.0, 2, 0}, reference);
    slow.add({0, 2.1, 0}, reference);
  }
  CHECK(turning.metrics().mean_percent == Approx(5));
  CHECK(turning.metrics().max_percent == Approx(5));
  CHECK(turning.metrics().mean_10ms.mean_percent == Approx(0).margin(1e-9));
  CHECK(turning.metrics().mean_10ms.max_percent == Approx(0).margin(1e-9));
  CHECK(constant.metrics().mean_10ms.mean_percent == Approx(0.5));
  CHECK(constant.metrics().mean_10ms.p99_percent == Approx(5).epsilon(0.004));
  CHECK(constant.metrics().mean_10ms.max_percent == Approx(5));
  CHECK(to_json(constant.metrics())["max_10ms_of_rms_percent"].get<double>() == Approx(5));
  CHECK(std::isnan(slow.metrics().mean_10ms.mean_percent));
}

TEST_CASE("10 ms in which contact begins count once, and those without contact not at all") {
  ErrorTable table(1000);
  for (int i = 0; i <= 40; ++i) {  // contact from the 15th tick to the 24th
    const double f = i >= 15 && i < 25 ? 1 : 0;
    table.add({0, 1.5 * f, 0}, ReferenceForce({0, f, 0}, i * std::chrono::milliseconds(1)));
  }
  CHECK(table.metrics().mean_10ms.mean_percent == Approx(25));  // half of each of two windows is 0.5 N off
  CHECK(table.metrics().mean_10ms.max_percent == Approx(25));
}

TEST_CASE("of a sine the root mean square is the peak by the root of 2, and errors are scaled by either") {
  ErrorTable table(1000);
  for (int i = 0; i < 10000; ++i) {
    const double f = 3 * std::sin(2 * std::numbers::pi * (i + 0.5) / 1000);
    table.add({0, f, i % 50 == 0 ? 0.3 : 0}, ReferenceForce({0, f, 0}, i * std::chrono::milliseconds(1)));
  }
  const ErrorMetrics m = table.metrics();
  CHECK(m.max_percent == Approx(10).epsilon(1e-4));
  CHECK(m.max_of_rms_percent == Approx(10 * std::numbers::sqrt2));
  CHECK(m.p99_of_rms_percent == Approx(std::numbers::sqrt2 * m.p99_percent).epsilon(1e-4));
  CHECK(m.mean_percent == Approx(10 * std::numbers::sqrt2 / 50));
}
