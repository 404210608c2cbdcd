// A capture of a server that steps by the clock, stepped again.
#include "sim_server/serving/captured_rerun.h"

#include <cmath>
#include <optional>

#include "sim_server/tissue/contact_instants.h"
#include "tests/support/catch.h"
#include "tests/support/served_block.h"
#include "tests/support/session_capture.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;
using protocol::ToolState;

namespace {

constexpr double kRate = 30;  // Hz

Scene clocked_scene() {
  Scene scene = block_scene(2);
  scene.rate_hz = kRate;
  scene.material->density = 1000;
  scene.material->young_modulus = 5e3;
  scene.deformation.model = "tensor_mass";
  scene.deformation.of<ContactInstants>().instants = 60;
  return scene;
}

/// State of a tool at `t` (s) by the server's clock, sent 500 times a second: it presses, deeper and deeper.
ToolState state_of(std::uint8_t tool, std::uint64_t tick) {
  const double t = 0.002 * static_cast<double>(tick);
  const std::int64_t jitter = static_cast<std::int64_t>(tick * 7919 % 700) * 1000;  // ns
  return {.tool = tool,
          .tick = tick,
          .t_ns = static_cast<std::int64_t>(tick) * 2'000'000 + jitter,
          .p_W = Vec3(tool == 0 ? -0.008 : 0.008, 0.004 - 0.002 * t + 1e-3 * std::sin(20 * t), 0)};
}

/// A server that steps by its clock, as `SimLoop` with `NetLink`, into a capture. Tool 1 is silent from 1.0
/// to 1.15 s, both from 1.6 to 1.72 s; the step at 2.1 s takes 50 ms.
class ClockedServer {
 public:
  ClockedServer(Simulation& simulation, const std::filesystem::path& file)
      : served_(simulation), capture_(file) {}

  std::uint64_t steps = 0;
  void run(double seconds) {
    double due = 0.01;
    while (due < seconds) {
      receive(due);
      const double took =
          std::abs(due - 2.1) < 0.5 / kRate ? 0.05 : 0.004 + 1e-6 * static_cast<double>(steps);
      const auto outcomes = served_.step(inputs_, to_seconds(from_seconds(1 / kRate)));
      ++steps;
      receive(due + took, true);  // while it steps; captured before the answers
      for (std::size_t i = 0; i < outcomes.size(); ++i) {
        if (!outcomes[i].answer) continue;
        protocol::ForceSample sample = *outcomes[i].answer;
        sample.tool = static_cast<std::uint8_t>(i);
        sample.step_ns = from_seconds(took).count();
        capture_.sample(sample, ++sent_, 7 + i, static_cast<std::uint16_t>(5000 + i));
      }
      for (std::size_t i = 0; i < 2; ++i) {
        inputs_[i].fresh = next_[i].fresh;
        if (next_[i].fresh) inputs_[i] = next_[i];
        next_[i].fresh = false;
      }
      due += std::max(1 / kRate, took);
    }
    capture_.close();
  }

 private:
  static bool is_silent(std::size_t tool, double t) {
    return (tool == 1 && t > 1.0 && t < 1.15) || (t > 1.6 && t < 1.72);
  }
  /// Takes all states that arrive by `t`; `steps_now`: for the step after this one.
  void receive(double t, bool steps_now = false) {
    for (; 0.002 * static_cast<double>(tick_ + 1) <= t;) {
      ++tick_;
      for (std::size_t i = 0; i < 2; ++i) {
        if (is_silent(i, 0.002 * static_cast<double>(tick_))) continue;
        const ToolState state = state_of(static_cast<std::uint8_t>(i), tick_);
        capture_.state(state, tick_, 7 + i, static_cast<std::uint16_t>(5000 + i));
        SessionInput& input = steps_now ? next_[i] : inputs_[i];
        if (steps_now && !input.fresh) input = inputs_[i];
        input.session = 7 + i;
        input.state = state;
        input.follow(state);
        input.fresh = true;
      }
    }
  }

  ServedTools served_;
  CaptureOf capture_;
  std::vector<SessionInput> inputs_ = std::vector<SessionInput>(2), next_ = inputs_;
  std::uint64_t tick_ = 0, sent_ = 0;
};

}  // namespace

TEST_CASE("a capture of a server that steps by the clock is stepped again to the same bits") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  Simulation first(clocked_scene(), block_mesh()), second(clocked_scene(), block_mesh());
  ClockedServer server(first, file);
  server.run(3);
  CapturedRerun rerun(second, kRate);
  bool pending = false;
  read_captured_steps(
      file, [&](std::uint64_t session, const ToolState& state) { rerun.take(session, state); },
      [&](const CapturedAnswer& answer) {
        if (answer.begins_step && pending) rerun.step();
        rerun.take(answer);
        pending = true;
      });
  rerun.step();
  CHECK(rerun.steps() == server.steps);
  CHECK(rerun.largest() > 0.1);
  CHECK(rerun.off() == 0);
  CHECK(second.state_hash() == first.state_hash());
}
