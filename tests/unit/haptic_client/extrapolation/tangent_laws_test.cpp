#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/extrapolation/force_estimate.h"
#include "haptic_client/extrapolation/tangent.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

std::unique_ptr<Extrapolator> law(const char* name) {
  return find_row(extrapolators(), name, "method", "test").make();
}

Sample triplet(std::uint64_t number, const Vec3& p, const Vec3& f) {
  return {.number = number, .t = Time{static_cast<std::int64_t>(number) * 33'000'000}, .p = p, .f = f};
}

/// A wall at y = 0 of 1000 N/m, as a server tells it from `p`.
Linearisation wall(const Vec3& p) {
  Linearisation l{.p_W = p, .normal_W = {0, 1, 0}, .gap = std::max(p[1], 0.0)};
  l.f_W = {0, 1000 * std::max(-p[1], 0.0), 0};
  l.tangent.setZero();
  l.tangent(1, 1) = -1000;
  return l;
}

Sample at_the_wall(std::uint64_t number, const Vec3& p) {
  Sample sample = triplet(number, p, wall(p).f_W);
  sample.at_tool = wall(p);
  return sample;
}

}  // namespace

TEST_CASE("learned stiffness: one step along a spring teaches it along the step, and nothing across") {
  const auto learned = law("learned_stiffness");
  const Vec3 p0(0, 0.01, 0), p1(0, 0.009, 0), spring(0, 800, 0);
  const auto f = [&](const Vec3& p) { return Vec3(0, 10 - 800 * p[1], 3); };
  learned->update(triplet(1, p0, f(p0)));
  learned->update(triplet(2, p1, f(p1)));
  // With r = -k s the update is -k s s^T / sigma (2 - |s|^2 / sigma): almost -k along the step.
  const double sigma = 1e-6 + 1e-10, fraction = 1e-6 / sigma, k = 800 * fraction * (2 - fraction);
  const Vec3 p(0.002, 0.0085, -0.001);
  CHECK((learned->force(p, 70ms) - (f(p1) + Vec3(0, k * 0.0005, 0))).norm() < 1e-12);
}

TEST_CASE("learned stiffness: three steps teach a symmetric spring, a tool at rest does not unlearn it") {
  const auto learned = law("learned_stiffness");
  Mat3 k;
  k << -300, 40, -20, 40, -500, 60, -20, 60, -200;
  const auto f = [&](const Vec3& p) { return Vec3(Vec3(1, 2, 3) + k * p); };
  Vec3 p = Vec3::Zero();
  std::uint64_t number = 0;
  for (int round = 0; round < 40; ++round) {
    p[round % 3] += round % 2 == 0 ? 1e-3 : -1e-3;
    learned->update(triplet(++number, p, f(p)));
  }
  for (int rest = 0; rest < 10; ++rest) learned->update(triplet(++number, p, f(p)));
  const Vec3 q = p + Vec3(2e-4, -3e-4, 1e-4);
  CHECK((learned->force(q, 10s) - f(q)).norm() < 1e-3 * (f(q) - f(p)).norm());
}

TEST_CASE("learned stiffness: forgotten out of contact, and never pulls") {
  const auto learned = law("learned_stiffness");
  learned->update(triplet(1, {0, 0, 0}, {0, 1, 0}));
  learned->update(triplet(2, {0, 0.001, 0}, {0, 0.5, 0}));
  CHECK(learned->force({0, 0.003, 0}, 70ms) == Vec3::Zero());  // the line would pull
  learned->update(triplet(3, {0, 0.002, 0}, {0, 0, 0}));
  learned->update(triplet(4, {0, 0, 0}, {0, 1, 0}));
  CHECK(learned->force({0, -0.001, 0}, 140ms) == Vec3(0, 1, 0));
}

TEST_CASE("restoring part: symmetric, without what pushes away") {
  Mat3 k;
  k << -4, 2, 0, 0, 3, 0, 0, 0, -1;  // symmetric part in the plane: eigenvalues of ((-4, 1), (1, 3))
  const Mat3 part = restoring_part(k);
  CHECK((part - part.transpose()).norm() < 1e-12);
  CHECK(part(2, 2) == Approx(-1));
  const double low = -0.5 - std::sqrt(13.25), high = -0.5 + std::sqrt(13.25);
  CHECK(part.trace() == Approx(low - 1));  // the positive one is gone
  CHECK(high > 0);
}

TEST_CASE("tangent: exact at a wall, in contact, out of it, and at a first contact between two samples") {
  for (const char* name : {"tangent", "two_tangents"}) {
    ForceEstimate estimate(law(name));
    estimate.take(at_the_wall(1, {0, 0.001, 0}), {0, 0.001, 0}, 33ms);
    CHECK(estimate.force({0, 0.0005, 0}, 40ms) == Vec3::Zero());
    CHECK((estimate.force({0, -0.002, 0}, 50ms) - Vec3(0, 2, 0)).norm() < 1e-12);  // the sample was free
    estimate.take(at_the_wall(2, {0, -0.001, 0}), {0, -0.001, 0}, 66ms);
    CHECK((estimate.force({0.001, -0.003, 0}, 70ms) - Vec3(0, 3, 0)).norm() < 1e-12);
    CHECK(estimate.force({0, 0.0001, 0}, 80ms) == Vec3::Zero());
  }
}

TEST_CASE("tangent: an organ that moves takes its force along") {
  const auto tangent = law("tangent");
  Sample sample = at_the_wall(1, {0, -0.001, 0});
  sample.surface_v = {0, 0.1, 0};
  tangent->update(sample);
  // 10 ms later the wall has come up by 1 mm.
  CHECK((tangent->force({0, -0.001, 0}, sample.t + 10ms) - Vec3(0, 2, 0)).norm() < 1e-9);
}

TEST_CASE("two tangents: here at the sample, ahead at the expected place, smoothly in between") {
  const auto two = law("two_tangents");
  Sample sample = at_the_wall(1, {0, -0.001, 0});
  sample.ahead = wall({0, -0.003, 0});
  sample.ahead->f_W = {0, 5, 0};  // a wall that grows stiffer
  two->update(sample);
  CHECK((two->force({0, -0.001, 0}, 40ms) - Vec3(0, 1, 0)).norm() < 1e-12);
  CHECK((two->force({0, -0.003, 0}, 40ms) - Vec3(0, 5, 0)).norm() < 1e-3);
  // In the middle w = 1/2: half of 2 N here, half of 4 N as seen from ahead.
  CHECK((two->force({0, -0.002, 0}, 40ms) - Vec3(0, 3, 0)).norm() < 1e-3);
}

TEST_CASE("a sample without tangents: the stiffness that was learned") {
  const auto tangent = law("two_tangents"), learned = law("learned_stiffness");
  for (int n = 1; n <= 3; ++n) {
    const Vec3 p(0, -0.001 * n, 0);
    for (const auto* any : {&tangent, &learned})
      (*any)->update(triplet(static_cast<std::uint64_t>(n), p, -900 * p));
  }
  const Vec3 p(0, -0.0035, 0);
  CHECK(tangent->force(p, 110ms) == learned->force(p, 110ms));
  CHECK(learned->force(p, 110ms)[1] == Approx(3.15).epsilon(1e-3));
}

TEST_CASE("no force along a tangent ends at once, or pulls, as a tool lifts off sideways, with friction") {
  Linearisation l{.p_W = Vec3::Zero(), .f_W = {0, 1, 0}, .normal_W = {0, 1, 0}};
  l.tangent = -500 * Mat3::Identity();
  for (const double sideways : {0.0, 0.3, 1.0, 3.0}) {
    Vec3 before = l.f_W;
    for (int i = 1; i <= 1000; ++i) {
      const Vec3 f = force_at(l, 1e-5 * i * Vec3(sideways, 0.4, 0));
      CHECK(f[1] >= 0);
      CHECK((f - before).norm() < 0.12);
      before = f;
    }
    CHECK(before == Vec3::Zero());
  }
  // Far from there it is the tangent.
  CHECK(force_at(l, {1e-3, -1e-3, 0}) == Vec3(-0.5, 1.5, 0));
}
