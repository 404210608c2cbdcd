#include "tests/studies/press_and_slide.h"

#include <numbers>

#include "haptic_client/evaluation/scaled_compliance.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/studies/studies.h"
#include "tests/support/random.h"
#include "tests/support/tool_inputs.h"

namespace palpate::studies {
using client::DeviceReading;

namespace {

constexpr double kRadius = 0.006, kHalfLength = 0.030, kHeight = 0.024, kHalfWidth = 0.020;   // m
constexpr double kFine = 0.002, kFineLength = 0.014, kFineWidth = 0.008, kFineDepth = 0.006;  // m, edges
constexpr double kSoft = 50e3;                       // Pa, that of the first block built
constexpr double kHeavy = 30 * 1060, kDamping = 10;  // kg/m3, 1/s: of tissue that swings
constexpr double kServedHz = 30;                     // of tissue that swings
constexpr double kSlide = 0.006, kSlideHz = 0.4;     // m, Hz
constexpr double kFree = 0.5, kApproach = 0.5, kInitialize = 1.2, kWatch = 2.0, kEnd = 5.0;  // s
constexpr double kWindow = 0.1;              // s to either side: what moves slower than that is meant
constexpr double kTimes = 3, kMore = 30e-6;  // of the direct motion; m
constexpr double kSettled = 1.5,
                 kThrown = 1e-3;  // s; m: who is off the surface then, or as far too deep, is thrown
constexpr int kCompared = 10;     // ticks between two looks at the true force

std::vector<double> depths() {
  auto depths = sim::graded_axis(kHeight, kFineDepth, kFine, 1.5);
  std::erase_if(depths, [](double y) { return y > 1e-9; });
  return depths;
}

sim::Scene scene_of(double young_modulus, bool swings, double rate_hz) {
  sim::Scene scene;
  scene.source = "study";
  scene.material = sim::Material{.young_modulus = young_modulus, .poisson_ratio = 0.45};
  scene.deformation.model = swings ? "reduced" : "quasi_static";
  if (swings) {
    scene.rate_hz = rate_hz;
    scene.material->density = kHeavy;
    scene.deformation.of<sim::ContactInstants>();  // as many as the model thinks good
    scene.deformation.of<sim::RayleighDamping>() = {.mass = kDamping, .stiffness = 0};
  }
  scene.fixed.push_back({{sim::Box{Vec3(-1, -1, -1), Vec3(1, -kHeight + 1e-6, 1)}, "", "study"}});
  scene.tools[0].shape.radius = kRadius;
  scene.tools[0].reach =
      sim::Box{Vec3(-kFineLength, -1e-3, -kFineWidth), Vec3(kFineLength, 1e-3, kFineWidth)};
  return scene;
}

sim::TetMesh mesh() {
  return sim::grid_block(sim::graded_axis(kHalfLength, kFineLength, kFine, 1.5), depths(),
                         sim::graded_axis(kHalfWidth, kFineWidth, kFine, 1.5));
}

Vec3 pressed(double depth) {
  return {0.0003, kRadius - depth, 0.0002};
}

/// Depth (m) at which slope / force is `ratio` (1/m), on any of these blocks: their tissue is linear. By
/// bisection, as the ratio falls with depth.
double depth_of(sim::Simulation& block, double ratio) {
  double low = 1e-4, high = 0.9 * kRadius;
  while (high - low > 1e-7) {
    const double middle = 0.5 * (low + high);
    const sim::ToolForce rendered = block.step(pressed(middle), 1e-3);
    (-rendered.tangent(1, 1) > ratio * rendered.force[1] ? low : high) = middle;
  }
  return low;
}

/// Where the hand wants to be so that it presses with `kPress`: down, then to and fro.
Trajectory motion(const client::OperatorSettings& hand, double depth, double start) {
  const double y = kRadius - depth - kPress / hand.hand_stiffness;
  std::vector<double> t{0, start, start + kApproach};
  std::vector<Vec3> p{pressed(-0.005), pressed(-0.005), pressed(0)};
  p.back()[1] = y;
  for (double s = 0; start + kInitialize + s < kEnd + 0.1; s += 0.01) {
    t.push_back(start + kInitialize + s);
    p.emplace_back(p[1][0] + kSlide * std::sin(2 * std::numbers::pi * kSlideHz * s), y, p[1][2]);
  }
  return Trajectory(std::move(t), std::move(p));
}

/// RMS of a path without its mean over a window around each point, from `kWatch` on, m.
double quick_motion(const std::vector<Vec3>& path) {
  const auto half = static_cast<std::size_t>(kWindow * kHapticHz),
             from = static_cast<std::size_t>(kWatch * kHapticHz);
  std::vector<Vec3> sums{Vec3::Zero()};
  for (const Vec3& p : path) sums.push_back(sums.back() + p);
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = from; i + half < path.size(); ++i, ++count) {
    const Vec3 mean = (sums[i + half + 1] - sums[i - half]) / static_cast<double>(2 * half + 1);
    squares += (path[i] - mean).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(count));
}

/// Whether the tool has left its press so far that there is no need to go on.
bool thrown(double y, double depth) {
  return std::abs(y - (kRadius - depth)) > depth + kThrown;
}

/// A hand with its draws of one run.
struct Hand {
  test::Random random;
  double start;
  client::SimulatedOperator person;
  Encoder encoder;
  Hand(const Person& who, double depth, int seed)
      : random(static_cast<std::uint64_t>(seed) + 17),
        start(kFree + random.between(0, 0.03)),
        person(who.hand, motion(who.hand, depth, start)),
        encoder(person, random.between(0, kEncoder)) {}
};

}  // namespace

/// One stiffness: the block, and how deep 1.5 N presses into it.
struct PressAndSlide::Block {
  Block(double stiffness, sim::Simulation& soft, bool of_swinging_tissue)
      : swings(of_swinging_tissue),
        depth(depth_of(soft, stiffness / kPress)),
        young_modulus(kSoft * kPress / soft.step(pressed(depth), 1e-3).force[1]) {}
  /// At rest, without the tool. Tissue that swings is built anew: it remembers.
  sim::Simulation& begin(double rate_hz) {
    if (swings || !simulation) simulation.emplace(scene_of(young_modulus, swings, rate_hz), mesh());
    test::lift_tools(*simulation);
    return *simulation;
  }
  /// A server that begins afresh, and tells that `compliance`.
  test::Server server(double compliance) {
    sim::Simulation& served = begin(kServedHz);
    auto tools = std::make_shared<sim::ServedTools>(served);
    auto path = std::make_shared<sim::ToolPath>();
    auto pager = std::make_shared<sim::SurfacePager>(served, 0);
    const auto step = [tools, path](const protocol::ToolState& state) {
      path->add(state);
      std::vector<sim::SessionInput> inputs{{1, state, true}};
      inputs[0].path = *path;
      return tools->step(inputs, 1 / kServedHz)
          .front()
          .answer;  // tissue at rest has no memory: any time step does
    };
    const protocol::SurfacePages entire = pager->pages();
    const auto pages = [pager, path, entire, compliance](const protocol::ToolState& state) {
      path->add(state);
      std::vector<protocol::SurfacePage> found;
      if ((state.flags & protocol::ToolState::kAsksPages) == 0) return found;
      for (const std::uint32_t number : state.pages) {
        if (protocol::SurfacePage page; pager->page(number, page))
          found.push_back(client::with_scaled_compliance(page, entire, compliance));
      }
      return found;
    };
    return {.step = step, .pages = pages};
  }

  bool swings;
  double depth, young_modulus;  // m, Pa
  std::optional<sim::Simulation> simulation;
};

bool PressAndSlide::has(const std::string& world) {
  return world != kSwings ||
         std::ranges::any_of(sim::deformation_models(),
                             [](const sim::DeformationModelRow& row) { return row.name == "reduced"; });
}

const std::vector<double>& PressAndSlide::stiffnesses() {
  static const std::vector<double> all{835, 1431, 2428, 3651, 6413};
  return all;
}

PressAndSlide::Block& PressAndSlide::block_of(const Which& which) {
  const auto& [world, stiffness] = which;
  if (!blocks_.contains(which)) {
    sim::Simulation soft(scene_of(kSoft, false, kServedHz), mesh());
    for (const double each : stiffnesses())
      blocks_[{world, each}] = std::make_shared<Block>(each, soft, world == kSwings);
  }
  return *blocks_.at(which);
}

double PressAndSlide::direct_motion(const Person& person, const Which& which) {
  const auto [found, missing] = direct_.try_emplace({&person, which}, 0.0);
  if (!missing) return found->second;
  Block& block = block_of(which);
  Hand hand(person, block.depth, 1);
  sim::Simulation& simulation = block.begin(kHapticHz);
  std::vector<Vec3> path;
  for (int tick = 0; tick < kEnd * kHapticHz; ++tick) {
    const Vec3 p = hand.encoder.read(from_seconds(1 + tick / kHapticHz)).p_D;
    hand.encoder.write(clamped(simulation.step(p, 1e-3).force));
    path.push_back(hand.encoder.place());
  }
  return found->second = quick_motion(path);
}

Outcome PressAndSlide::run(const Cell& cell, double stiffness, int seed, bool compare) {
  const Which which{cell.world, stiffness};
  const double direct = direct_motion(*cell.person, which);
  Block& block = block_of(which);
  Hand hand(*cell.person, block.depth, seed);
  client::Pipeline pipeline = pipeline_of(cell);
  test::ClosedLoop loop(hand.encoder, pipeline, block.server(cell.compliance), loop_of(cell.link, seed));
  std::vector<Vec3> path;
  ForceErrors errors;
  while (loop.seconds() < kEnd) {
    const Vec3 rendered = loop.tick().f_D;
    path.push_back(hand.encoder.place());
    if (loop.seconds() > kSettled && thrown(path.back()[1], block.depth)) return {};
    if (!compare || block.swings || path.size() % kCompared != 0 || loop.seconds() < kWatch) continue;
    errors.add(rendered, block.simulation->linearise(0, path.back(), nullptr).f_W);
  }
  const bool quiet = quick_motion(path) <= kTimes * direct + kMore;
  return {quiet && pipeline.limiter().fault() == client::Fault::kNone, errors.rms()};
}

double PressAndSlide::threshold(const Cell& cell) {
  double good = 0;
  for (const double stiffness : stiffnesses()) {
    for (int seed = 1; seed <= kSeeds; ++seed) {
      if (!run(cell, stiffness, seed, false).stable) return good;
    }
    good = stiffness;
  }
  return good;
}

}  // namespace palpate::studies
