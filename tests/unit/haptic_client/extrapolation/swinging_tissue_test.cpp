// A tool on tissue that swings, felt between samples, against the same simulation with contact solved at
// every tick: both programs without sockets.
#include "haptic_client/extrapolation/extrapolators.h"
#include "sim_server/client_model/slow_modes.h"
#include "sim_server/models/implicit.h"
#include "sim_server/models/reduced.h"
#include "sim_server/tissue/contact_instants.h"
#include "tests/support/catch.h"
#include "tests/support/listener.h"

using namespace palpate;
using namespace palpate::test;
using namespace std::chrono_literals;

namespace {

constexpr std::array kRelaxing{Relaxation{0.4, 0.15}, Relaxation{0.2, 1.2}};

/// So soft that it swings at 3 to 20 Hz, with little damping.
sim::Scene swinging(std::string_view model, double rate_hz, std::span<const Relaxation> relaxations = {}) {
  sim::Scene scene = block_scene();
  scene.material->young_modulus = 4e3;
  scene.material->density = 2000;
  scene.rate_hz = rate_hz;
  scene.deformation.model = model;
  scene.deformation.of<sim::ReducedSettings>().modes = 24;
  scene.deformation.of<sim::ClientModes>().modes = 60;
  scene.deformation.of<sim::ContactInstants>();
  scene.deformation.of<sim::ImplicitSettings>().second_order = true;
  scene.material->relaxations.assign(relaxations.begin(), relaxations.end());
  if (model == "implicit" && relaxations.empty()) scene.material->law = sim::ElasticLaw::kCorotational;
  return scene;
}

/// Presses of 2.5 Hz that leave the surface, on a slide.
Vec3 presses(Time t) {
  const double s = to_seconds(t - 1s);
  return {0.004 * std::sin(3 * s), 0.0043 + 0.0025 * std::cos(2 * std::numbers::pi * 2.5 * s), 0.0005};
}

/// Another tool, 20 mm aside, which presses 1.7 times a second.
Vec3 beside(Time t) {
  return {-0.016, 0.004 + 0.002 * std::sin(2 * std::numbers::pi * 1.7 * to_seconds(t)), -0.012};
}

struct Served {
  Errors of_law, of_constant;
};
Served serve(std::string_view model, Time delay, std::span<const Relaxation> relaxations = {},
             std::size_t tools = 1) {
  const double rate = 1 / to_seconds(ServedBlock::kPeriod);
  const auto scene = [&](double hz) {
    sim::Scene made = swinging(model, hz, relaxations);
    made.tools.resize(tools, made.tools.front());
    return made;
  };
  Listener listener(scene(rate), block_mesh());
  listener.block.set_delay(delay);
  listener.learn(kEntireModel);
  sim::Simulation truth(scene(500), block_mesh());
  std::vector<sim::ToolInput> inputs(tools);
  const auto force_at = [&](Time t) {
    inputs.front().pose = Vec3(presses(t));
    if (tools > 1) inputs[1].pose = Vec3(beside(t));
    return truth.step(inputs, to_seconds(kTick)).front().force;
  };
  force_at(listener.t);
  client::ForceEstimate constant{client::extrapolators().front().make()};
  Served sums;
  double peak = 0;
  int ticks = 0;
  listener.published = [&](protocol::ForceSample& sample) {
    constant.take(client::sample_of(sample), listener.place, listener.t);
  };
  for (; listener.t < 4s; ++ticks) {
    const Time now = listener.t + kTick;
    if (tools > 1) listener.block.hold_second_tool(beside(now));
    const Vec3 right = force_at(now), given = listener.tick(presses(now));
    peak = std::max(peak, right.norm());
    if (listener.newest.number < 3) continue;
    const auto add = [&](Errors& errors, const Vec3& f) {
      errors.mean += (f - right).norm();
      errors.largest = std::max(errors.largest, (f - right).norm());
    };
    add(sums.of_law, given);
    add(sums.of_constant, constant.force(listener.place, listener.t));
  }
  for (Errors* const errors : {&sums.of_law, &sums.of_constant}) {
    errors->mean /= ticks * peak;
    errors->largest /= peak;
  }
  return sums;
}

}  // namespace

TEST_CASE(
    "swinging tissue: with its slow modes stepped in the client it is felt as it swings, at any delay") {
  for (const std::string_view model : {"reduced", "tensor_mass"}) {
    for (const Time delay : {35ms, 80ms}) {
      const Served errors = serve(model, delay);
      CAPTURE(model, delay.count(), errors.of_law.mean, errors.of_law.largest, errors.of_constant.mean);
      CHECK(errors.of_constant.mean > 0.1);
      CHECK(errors.of_law.mean < 0.01);
      CHECK(errors.of_law.largest < 0.15);
    }
  }
}

TEST_CASE("swinging tissue: what another tool does to the slow modes is felt between samples") {
  for (const std::string_view model : {"reduced", "tensor_mass"}) {
    for (const Time delay : {35ms, 80ms}) {
      const Served errors = serve(model, delay, {}, 2);
      CAPTURE(model, delay.count(), errors.of_law.mean, errors.of_law.largest, errors.of_constant.mean);
      CHECK(errors.of_constant.mean > 0.1);
      CHECK(errors.of_law.mean < 0.02);
    }
  }
}

TEST_CASE("swinging tissue: implicit tissue that bends is felt by the modes of its rest and a factor") {
  const Served errors = serve("implicit", 35ms);
  CAPTURE(errors.of_law.mean, errors.of_law.largest, errors.of_constant.mean);
  CHECK(errors.of_constant.mean > 0.1);
  CHECK(errors.of_law.mean < 0.04);
}

TEST_CASE("swinging tissue: what has relaxed is felt, by one term or two, at any delay") {
  for (const std::size_t terms : {1, 2}) {
    for (const Time delay : {35ms, 80ms}) {
      const Served errors = serve("implicit", delay, std::span(kRelaxing).first(terms));
      CAPTURE(terms, delay.count(), errors.of_law.mean, errors.of_law.largest, errors.of_constant.mean);
      CHECK(errors.of_constant.mean > 0.1);
      CHECK(errors.of_law.mean < 0.01);
      CHECK(errors.of_law.largest < 0.15);
    }
  }
}

TEST_CASE("swinging tissue: who joins where the tissue has relaxed feels what others feel 0.3 s later") {
  const sim::Scene scene = swinging("implicit", 33.3, kRelaxing);
  Listener there(scene, block_mesh()), joins(scene, block_mesh());
  for (Listener* const listener : {&there, &joins}) listener->learn(kEntireModel);
  const auto touching = [](Time t) -> Vec3 {
    const double s = to_seconds(t - 1s);
    return {0.004 * std::sin(3 * s), 0.003 + 0.001 * std::cos(2 * std::numbers::pi * 2.5 * s), 0.0005};
  };
  double peak = 0, sum = 0;
  int ticks = 0;
  for (; there.t < 4s;) {
    const Vec3 p = touching(there.t + kTick), rendered = there.tick(p), other = joins.tick(p);
    if (there.t == 3s) joins.law = client::ForceEstimate{std::make_unique<client::LocalContact>()};
    peak = std::max(peak, rendered.norm());
    if (there.t < 3300ms) continue;
    sum += (rendered - other).norm();
    ++ticks;
  }
  CHECK(peak > 0.05);
  CHECK(sum / ticks < 0.008 * peak);  // 0.03 where it is not told what has relaxed
}

TEST_CASE("swinging tissue: a memory that no organ has is never felt") {
  Listener listener(swinging("implicit", 33.3, kRelaxing), block_mesh());
  listener.learn(kEntireModel);
  int samples = 0;
  listener.published = [&](protocol::ForceSample& sample) {
    if (++samples < 30 || samples > 60) return;
    sample.relaxed.z.fill(samples % 2 == 0 ? 1e5F : -3);
    for (auto& vertex : sample.relaxed.vertex) vertex.psi.fill(samples % 3 == 0 ? 1e6F : 20);
  };
  double largest = 0, wildest = 0;
  for (; listener.t < 4s;) {
    const bool implausible = samples >= 30 && samples < 75;
    const double newton = listener.tick(presses(listener.t + kTick)).norm();
    (implausible ? wildest : largest) = std::max(implausible ? wildest : largest, newton);
  }
  CHECK(largest > 0.05);
  CHECK(wildest < 3 * largest);
}

TEST_CASE("swinging tissue: amplitudes, and loads of other tools, that no organ has are never felt") {
  const bool of_others = GENERATE(false, true);
  Listener listener(swinging("reduced", 33.3), block_mesh());
  listener.learn(kEntireModel);
  bool implausible = false;
  listener.published = [&](protocol::ForceSample& sample) {
    if (implausible && !of_others) sample.modes.q.fill(1e5F);
    if (!implausible || !of_others) return;
    sample.flags |= protocol::ForceSample::kHasModalLoads;
    sample.modal_loads.count = sample.modes.count;
    sample.modal_loads.load.fill(1e6F);
  };
  double largest = 0, wildest = 0;
  for (; listener.t < 4s;) {
    implausible = listener.t > 2s && listener.t < 3s;
    const double newton = listener.tick(presses(listener.t + kTick)).norm();
    (implausible ? wildest : largest) = std::max(implausible ? wildest : largest, newton);
  }
  CHECK(largest > 0.05);
  CHECK(wildest < 2 * largest);
}

TEST_CASE("swinging tissue: modes that come and go with each sample do no harm") {
  Listener listener(swinging("reduced", 33.3), block_mesh());
  listener.learn(kEntireModel);
  int samples = 0;
  listener.published = [&](protocol::ForceSample& sample) {
    if (++samples > 30 && samples % 3 == 0) sample.flags &= ~protocol::ForceSample::kHasModes;
  };
  double largest = 0;
  for (; listener.t < 4s;) largest = std::max(largest, listener.tick(presses(listener.t + kTick)).norm());
  CHECK(largest > 0.05);
  CHECK(largest < 2);
}

TEST_CASE("swinging tissue: after a silence of the server nothing of the old motion is left") {
  Listener listener(swinging("reduced", 33.3), block_mesh());
  listener.learn(kEntireModel);
  double largest = 0;
  for (; listener.t < 2s;) largest = std::max(largest, listener.tick(presses(listener.t + kTick)).norm());
  for (int i = 0; i < 250; ++i) {  // 0.5 s without a sample, the tool held
    listener.t += kTick;
    CHECK(listener.law.force(listener.place, listener.t).norm() < 2 * largest);
  }
  for (; listener.t < 5s;) CHECK(listener.tick(presses(listener.t + kTick)).norm() < 2 * largest);
}
