#include "sim_server/study/study_errors.h"

#include <cmath>
#include <csignal>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

namespace palpate::sim {
namespace {

constexpr double kSpeed = 0.02, kStiffness = 300;  // m/s, N/m

/// The tool goes down evenly for 2 s.
Trajectory even_way() {
  return {{0.0, 2.0}, {Vec3::Zero(), Vec3(0, -2 * kSpeed, 0)}};
}

/// A spring that the tool presses from the beginning; `fraction` of its true force, one site that goes along.
Trace spring(double dt, double fraction, const Mat3& tangent) {
  Trace trace;
  trace.dt = dt;
  trace.sites = 1;
  for (int k = 1; k * dt < 2 + 1e-9; ++k) {
    const Vec3 place = even_way().at(k * dt);
    trace.places.push_back(place);
    trace.forces.push_back(-fraction * kStiffness * place);
    trace.tangents.push_back(tangent);
    trace.moved.push_back(fraction * place);
  }
  return trace;
}

}  // namespace

TEST_CASE("a force that is a tenth too large is wrong by a tenth of its mean, of its root mean square") {
  const Trace truth = spring(0.001, 1, Mat3::Zero());
  const StudyErrors errors = errors_of(spring(0.01, 1.1, Mat3::Zero()), truth, even_way(), 0);
  // Mean and root mean square of a ramp of n steps: (n + 1) / 2 and sqrt((n + 1)(2n + 1) / 6).
  CHECK(errors.force == Approx(10 * (201. / 2) / std::sqrt(201. * 401 / 6)).epsilon(1e-9));
  CHECK(errors.surface == Approx(10).epsilon(1e-9));
  CHECK(errors.along.size() == 200);
  CHECK(errors.along.back() == Approx(10 * 200 / std::sqrt(201. * 401 / 6)).epsilon(1e-9));
  CHECK(errors.worst_force == errors.along.back());
}

TEST_CASE("what steps cost is told from what the mesh costs, whatever is left of it in the shortest steps") {
  const Trace truth = spring(0.001, 1, Mat3::Zero());
  for (const auto& [order, shorter] : {std::pair(1, 0.01), std::pair(1, 0.02), std::pair(2, 0.01)}) {
    // 2 % by the mesh, and 8 % by steps of 40 ms: of 10 ms a quarter, or a sixteenth of that.
    const double left = 0.08 * std::pow(shorter / 0.04, order);
    const Trace own = spring(0.04, 1.1, Mat3::Zero()), finer = spring(shorter, 1.02 + left, Mat3::Zero());
    const SplitError split = split_error(own, finer, order, truth, even_way());
    CAPTURE(order, shorter);
    // Of a ramp, by its root mean square, at the ends of the steps looked at.
    const double mean = errors_of(spring(shorter, 1.1, Mat3::Zero()), truth, even_way(), 0).force / 10,
                 at_own = errors_of(own, truth, even_way(), 0).force / 10;
    CHECK(split.mesh == Approx(2 * mean).epsilon(1e-9));
    CHECK(split.time_step == Approx(8 * at_own / 1.02).epsilon(1e-9));
  }
}

TEST_CASE("what is right but late is felt late, by the step and the link, and held for a step") {
  constexpr double kDt = 0.04, kLatency = 0.01;
  const Trace truth = spring(0.001, 1, Mat3::Zero());
  const StudyErrors errors = errors_of(spring(kDt, 1, Mat3::Zero()), truth, even_way(), kLatency);
  CHECK(errors.force == Approx(0).margin(1e-9));
  // In the mean the place is old by dt + latency and half a step for which it is held.
  const double off = kStiffness * kSpeed * (kDt + kLatency + kDt / 2);
  const double size = kStiffness * kSpeed * 2 / std::sqrt(3.0);
  CHECK(errors.rendered.mean_percent == Approx(100 * off / size).epsilon(0.03));
}

TEST_CASE("the exact tangent takes what is late away, once the first force is there") {
  const Trace truth = spring(0.001, 1, Mat3::Zero());
  const Mat3 tangent = -kStiffness * Mat3::Identity();
  const double rendered = errors_of(spring(0.04, 1, tangent), truth, even_way(), 0.01).rendered.mean_percent;
  // Until 2 dt + latency = 0.09 s there is none: the mean of the force there, over all 2 s.
  const double before = kStiffness * kSpeed * 0.09 * 0.09 / 2 / 2;
  CHECK(rendered == Approx(100 * before / (kStiffness * kSpeed * 2 / std::sqrt(3.0))).epsilon(0.05));
}

TEST_CASE("errors of what is rendered are told by peak and by root mean square, and jumps of a trace") {
  const Mat3 tangent = -kStiffness * Mat3::Identity();
  Trace trace = spring(0.01, 1, tangent);
  CHECK(unexplained_jumps(trace)->count == 0);
  const ErrorMetrics rendered = errors_of(trace, spring(0.001, 1, tangent), even_way(), 0.01).rendered;
  // Without force until 0.03 s: wrong by all of it there, of a ramp with the peak at 2 s.
  CHECK(rendered.max_percent == Approx(100 * 0.029 / 2).epsilon(0.01));
  CHECK(rendered.max_of_rms_percent == Approx(std::sqrt(3) * rendered.max_percent).epsilon(0.01));
  CHECK(rendered.mean_10ms.max_percent == Approx(100 * 0.0245 / 2).epsilon(0.01));
  for (std::size_t k = 100; k < trace.forces.size(); ++k) trace.forces[k] += Vec3(3, 0, 0);
  CHECK(unexplained_jumps(trace)->count == 1);
  CHECK(unexplained_jumps(trace)->largest_percent == Approx(100 * 3 / std::hypot(3, 12)));
}

TEST_CASE("a trace reads back as it was, and half of one is none") {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "one.trace";
  Trace trace = spring(0.1, 1, Mat3::Identity());
  trace.state_hash = 77;
  trace.peak_bytes = 1.5;
  CHECK(!read_trace(file));
  write_trace(file, trace);
  const std::optional<Trace> back = read_trace(file);
  REQUIRE(back);
  CHECK(back->forces == trace.forces);
  CHECK(back->moved == trace.moved);
  CHECK(back->state_hash == 77);
  CHECK(back->peak_bytes == 1.5);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  CHECK(!read_trace(file));
}

TEST_CASE("what runs apart tells its errors and its crashes here") {
  const std::vector<char> own(128 << 20, 1);  // of this process, and not of those
  [[maybe_unused]] const double small = run_separately("small", [] {});
  const double big = run_separately("big", [] { std::vector<char> much(64 << 20, 1); });
  CHECK(big > 64e6);
#if !defined(PALPATE_SANITIZED)  // they keep more
  CHECK(small < 8e6);
  CHECK(big < 80e6);
#endif
  const auto said = [](const std::function<void()>& work) -> std::string {
    try {
      run_separately("case", work);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  CHECK(said([] { fail("{}: no such thing", "scene.toml"); }) == "scene.toml: no such thing");
  CHECK(said([] { std::raise(SIGKILL); }) == "case: ended by signal 9, as where memory runs out");
}

}  // namespace palpate::sim
