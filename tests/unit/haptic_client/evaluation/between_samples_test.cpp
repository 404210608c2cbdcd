// The force on the path between two samples, against closed forms and against the simulation.
#include "haptic_client/evaluation/between_samples.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "haptic_client/evaluation/scoring.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/listener.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

constexpr Time kStep = 1ms;
constexpr int kSteps = 30;  // from one sample to the next

using Path = std::function<Vec3(double s)>;  // m; s in seconds
struct Law {
  std::function<Vec3(const Vec3& p, double s)> force;
  Vec3 organ_v = Vec3::Zero();
};

/// What a server says of the law at `s`: its force, and dF/dp by central differences; of a free tool the
/// plane y = 0.
Sample sampled(const Law& law, const Path& path, double s, std::uint64_t number) {
  const Vec3 p = path(s);
  Sample sample{number, from_seconds(s), p, law.force(p, s), law.organ_v};
  Linearisation at_tool{.p_W = p, .f_W = sample.f, .normal_W = {0, 1, 0}, .gap = std::max(p[1], 0.0)};
  constexpr double kH = 1e-7;
  for (int i = 0; i < 3; ++i) {
    const Vec3 h = kH * Vec3::Unit(i);
    at_tool.tangent.col(i) = (law.force(p + h, s) - law.force(p - h, s)) / (2 * kH);
  }
  sample.at_tool = at_tool;
  return sample;
}

struct Off {
  ReferenceKind kind;
  double curve = 0, line = 0;  // largest error, N
};
Off compare(
    const Law& law, const Path& path, double begin,
    const std::function<void(Sample&)>& change = [](Sample&) {}) {
  const double step = to_seconds(kStep);
  Sample before = sampled(law, path, begin, 1), after = sampled(law, path, begin + kSteps * step, 2);
  change(before);
  change(after);
  std::vector<PathTick> ticks;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = begin + i * step;
    ticks.push_back({from_seconds(s), path(s)});
  }
  BetweenSamples between(before, after);
  for (int i = 0; i < kSteps; ++i) between.add(ticks[i]);
  between.close(ticks.back());
  Off off{between.kind()};
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 right = law.force(ticks[i].p, to_seconds(ticks[i].t));
    off.curve = std::max(off.curve, (between.at(ticks[i]) - right).norm());
    off.line = std::max(off.line, (between.line(ticks[i].t) - right).norm());
  }
  return off;
}

/// A sphere on an elastic half space (Hertz): 1 N at 2.5 mm.
const Law kHertz{[](const Vec3& p, double) {
  const double depth = std::max(-p[1], 0.0) / 0.0025;
  return Vec3(0, std::pow(depth, 1.5), 0);
}};
/// A spring in all directions that hardens: F = -k (1 + |p|^2 / l^2) p.
const Law kHardening{[](const Vec3& p, double) { return Vec3(-200 * (1 + p.squaredNorm() / 1e-4) * p); }};

/// Down to 2 mm and up again in 0.6 s, going sideways.
Vec3 press(double s) {
  return {0.01 * s, -0.001 * (1 - std::cos(2 * std::numbers::pi * s / 0.6)), 0.004 * std::sin(9 * s)};
}

}  // namespace

TEST_CASE("between samples: on a sphere pressed into an elastic body the curve errs a tenth of the line") {
  for (const double begin : {0.12, 0.2, 0.29, 0.41}) {
    const Off off = compare(kHertz, press, begin);
    CAPTURE(begin, off.curve, off.line);
    CHECK(off.kind == ReferenceKind::kHermite);
    CHECK(off.curve < 0.1 * off.line);
  }
}

TEST_CASE("between samples: a spring that hardens, on a bent path with a turn, a tenth of the line") {
  const Path bent = [](double s) {
    return Vec3(0.006 * std::sin(8 * s), 0.003 * std::cos(11 * s), 0.004 * std::sin(5 * s + 1));
  };
  for (double begin = 0; begin < 1; begin += 0.1) {
    const Off off = compare(kHardening, bent, begin);
    CAPTURE(begin, off.curve, off.line);
    CHECK(off.kind == ReferenceKind::kHermite);
    CHECK(off.curve < 0.1 * off.line);
  }
}

TEST_CASE("between samples: a cubic along a straight path is met exactly, however its speed changes") {
  const Law cubic{[](const Vec3& p, double) {
    const double x = p[0] / 0.001;
    return Vec3(2 - x + 0.3 * x * x - 0.1 * x * x * x, 0.5 * x, 1);
  }};
  const Off off = compare(
      cubic, [](double s) { return Vec3(0.05 * s + 2 * s * s, 0, 0); }, 0.01);
  CHECK(off.kind == ReferenceKind::kHermite);
  CHECK(off.line > 0.05);
  CHECK(off.curve < 1e-6);  // the slopes are central differences
}

TEST_CASE(
    "between samples: the first touch, and the last, of a sphere on an elastic body are its own curve") {
  const Path down = [](double s) { return Vec3(0.01 * s, 0.0004 - 0.04 * s, 0); },
             up = [](double s) { return Vec3(0.01 * s, -0.0007 + 0.04 * s, 0); };
  for (const Path& path : {down, up}) {
    const Off off = compare(kHertz, path, 0);
    CHECK(off.kind == ReferenceKind::kHermite);
    CHECK(off.line > 0.05);
    CHECK(off.curve < 1e-6);
  }
}

TEST_CASE("between samples: the curve goes with the organ") {
  Law moving{[](const Vec3& p, double s) { return kHertz.force(p - Vec3(0, 0.03 * s, 0), s); }};
  moving.organ_v = {0, 0.03, 0};
  const Path follows = [](double s) -> Vec3 { return press(s) + Vec3(0, 0.03 * s, 0); };
  for (const double begin : {0.2, 0.29}) {
    const Off off = compare(moving, follows, begin), still = compare(kHertz, press, begin);
    CHECK(off.kind == ReferenceKind::kHermite);
    CHECK(off.curve == Approx(still.curve).epsilon(1e-3));
  }
}

TEST_CASE("between samples: without tangents, or with such as nothing agrees with, it is the line") {
  for (const auto& change : std::vector<std::function<void(Sample&)>>{
           [](Sample& s) { s.at_tool.reset(); }, [](Sample& s) { s.at_tool->tangent(1, 1) *= -20; },
           [](Sample& s) { s.at_tool->tangent(0, 1) = std::numeric_limits<double>::quiet_NaN(); },
           [](Sample& s) {
             if (s.number == 2) s.at_tool.reset();
           }}) {
    const Off off = compare(kHertz, press, 0.2, change);
    CHECK(off.kind == ReferenceKind::kLine);
    CHECK(off.curve == off.line);
  }
}

TEST_CASE("a score against the curve is that against the law itself, and the paper's stays with the line") {
  Scoring scoring({"linear_time"}, 1000, "test");
  ErrorTable truth(1000), line(1000);
  ErrorSums sums;
  Vec3 newest = Vec3::Zero();
  std::vector<Vec3> rights, givens;
  for (int k = 0; k <= 20 * kSteps; ++k) {
    const double s = 0.1 + k * to_seconds(kStep);
    const Sample sample = sampled(kHertz, press, s, 1 + k / kSteps);
    const bool arrived = k % kSteps == 0;
    if (arrived && k > 0) {
      for (std::size_t i = 0; i < rights.size(); ++i) {
        const double u = static_cast<double>(i) / kSteps;
        truth.add(givens[i], ReferenceForce(rights[i], {}));
        line.add(givens[i], ReferenceForce(newest + u * (sample.f - newest), {}));
      }
      rights.clear();
      givens.clear();
    }
    if (arrived) newest = sample.f;
    scoring.tick(press(s), from_seconds(s), arrived ? &sample : nullptr, sums);
    rights.push_back(sample.f);
    givens.push_back(scoring.forces()[0]);
  }
  const ErrorMetrics got = scoring.metrics(0), right = truth.metrics(), paper = line.metrics();
  CHECK(scoring.between(ReferenceKind::kHermite) == scoring.scored());
  CHECK(scoring.mostly_between() == ReferenceKind::kHermite);
  CHECK(got.mean_percent == Approx(right.mean_percent).epsilon(0.02));
  CHECK(got.max_percent == Approx(right.max_percent).epsilon(0.02));
  CHECK(got.paper_mean_percent == Approx(paper.paper_mean_percent).epsilon(1e-9));
  CHECK(got.paper_max_percent == Approx(paper.paper_max_percent).epsilon(1e-9));
  CHECK(std::abs(paper.mean_percent - right.mean_percent) > 0.05 * right.mean_percent);
}

TEST_CASE("a score on a model of the surface is that against the simulation, to a tenth of the best law") {
  const double rate = 1 / to_seconds(test::kTick);
  Scoring scoring({"two_tangents", "local_contact"}, rate, "test");
  test::ServedBlock block(35ms);
  SurfaceModel model;
  model.announce(sim::SurfacePager(block.simulation, 0).state());
  for (const protocol::SurfacePage& page : test::all_pages(block.simulation)) model.take(page);
  sim::Simulation truth(test::block_scene(), test::block_mesh());
  std::array<double, 2> direct{};
  ErrorSums sums;
  double peak = 0;
  std::size_t allocations = 0;
  Vec3 before = test::slide(1s);
  for (Time t = 1s; t < 4s; t += test::kTick) {
    const Vec3 p = test::slide(t), right = truth.step(p, to_seconds(test::kTick)).force;
    const auto arrived = block.exchange(t, p, (p - before) / to_seconds(test::kTick));
    before = p;
    std::optional<Sample> sample;
    if (arrived) sample = sample_of(*arrived, &model);
    const test::AllocationGuard guard;
    scoring.tick(p, t, sample ? &*sample : nullptr, sums);
    allocations += guard.count();
    peak = std::max(peak, right.norm());
    if (t > 1035ms && t < 3920ms) {  // about what is scored
      for (std::size_t i = 0; i < 2; ++i) direct[i] += (scoring.forces()[i] - right).norm();
    }
  }
  CHECK(allocations == 0);
  CHECK(static_cast<double>(scoring.between(ReferenceKind::kContact)) >
        0.95 * static_cast<double>(scoring.scored()));
  for (std::size_t i = 0; i < 2; ++i) {
    CAPTURE(i, direct[i], sums.error[i], peak);
    CHECK(sums.error[i] == Approx(direct[i]).epsilon(0.1));
  }
}
