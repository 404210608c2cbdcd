// A step of the liver that ships with every model, free and in contact; contact alone; a session in virtual
// time.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "sim_server/models/deformation_models.h"
#include "sim_server/serving/virtual_session.h"
#include "sim_server/statics/compliance_tolerance.h"
#include "tests/bench/bench.h"
#include "tests/bench/liver.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tool_inputs.h"

namespace palpate::bench {
using namespace sim;

namespace {

constexpr std::size_t kSlideSteps = 40;  // of one turn of the slide
constexpr double kPeriod = 1.0 / 30;     // s

/// To and fro, a tenth of the radius; `place` + `slide` along `along`.
std::array<Vec3, kSlideSteps> slide(const Vec3& place, const Vec3& along, double radius) {
  std::array<Vec3, kSlideSteps> places;
  for (std::size_t i = 0; i < kSlideSteps; ++i) {
    const double phi = 2 * std::numbers::pi * static_cast<double>(i + 1) / kSlideSteps;
    places[i] = place + 0.1 * radius * std::sin(phi) * along;
  }
  return places;
}

/// Not a model, but the scene of the liver under a tool that rubs on it: about 20 nodes are near.
constexpr std::string_view kFriction = "friction";

/// At rest with the compliance of all of the surface kept, densely, or in tiles of low rank.
constexpr std::string_view kDense = "dense", kTiles = "tiles";

Scene at_rest_and_all_in_reach(double compliance_tolerance) {
  Scene scene = liver_scene_with("quasi_static");
  for (ToolSettings& tool : scene.tools) tool.reach.reset();
  scene.deformation.of<ComplianceTolerance>().relative = compliance_tolerance;
  return scene;
}

Scene scene_called(std::string_view name) {
  if (name == kFriction) return test::example_scene("liver_friction");
  if (name == kDense) return at_rest_and_all_in_reach(0);
  if (name == kTiles) return at_rest_and_all_in_reach(1e-4);
  return liver_scene_with(name);
}

/// A liver with a place to press on, built when a row first needs it.
struct Liver {
  explicit Liver(std::string_view name) : scene(scene_called(name)), simulation(scene) {
    press = find_press(scene, simulation);
    hash = contact_hash(scene, simulation, press);
    test::lift_tools(simulation);
    above = press.place;
    for (const Vec3& x : simulation.positions()) above[1] = std::max(above[1], x[1] + 10 * radius());
    simulation.step(above, kPeriod);
    free_hash = simulation.state_hash();
  }
  double radius() const { return scene.tools[0].shape.radius; }

  Scene scene;
  Simulation simulation;
  Press press;
  Vec3 above;
  std::uint64_t hash = 0, free_hash = 0;
};

/// The liver with a model, or as one of these scenes; null, and the row says so, where the scene lacks what
/// the model needs.
Liver* liver(benchmark::State& state, std::string_view model) {
  static std::map<std::string_view, Liver> built;
  try {
    return &built.try_emplace(model, model).first->second;
  } catch (const Error& e) {
    state.SkipWithError(fmt::format("left out: {}", e.what()).c_str());
    return nullptr;
  }
}

void time_steps_at(benchmark::State& state, Simulation& simulation,
                   const std::array<Vec3, kSlideSteps>& places) {
  std::size_t i = 0;
  for (auto _ : state) {
    ToolForce force = simulation.step(places[i++ % kSlideSteps], kPeriod);
    benchmark::DoNotOptimize(force);
  }
}

void run_free(benchmark::State& state, std::string_view model) {
  Liver* const on = liver(state, model);
  if (on == nullptr) return;
  show(state, on->free_hash);
  test::lift_tools(on->simulation);
  time_steps_at(state, on->simulation, slide(on->above, Vec3::UnitX(), on->radius()));
}

void run_contact(benchmark::State& state, std::string_view model) {
  Liver* const on = liver(state, model);
  if (on == nullptr) return;
  show(state, on->hash);
  test::lift_tools(on->simulation);
  on->simulation.step(on->press.place + 2 * on->radius() * on->press.normal, kPeriod);
  const ToolForce first = on->simulation.step(on->press.place, kPeriod);
  if (first.contacts == 0 || first.flagged) return state.SkipWithError("no settled contact to time");
  state.counters["touching"] = first.contacts;
  time_steps_at(state, on->simulation,
                slide(on->press.place, on->press.normal.unitOrthogonal(), on->radius()));
}

/// A ball pressed by 4 mm into the block of 2 mm edges that ships, on an oval of 16 by 8 mm, 30 mm/s: a step
/// with friction against one without. Of a ball of 6, 12 and 20 mm some 18, 36 and 64 features touch.
void run_oval(benchmark::State& state, double radius, double friction) {
  constexpr double kDepth = 0.004;
  Scene scene = test::example_scene("block_friction");
  ToolSettings& tool = scene.tools.front();
  tool.shape.radius = radius;
  tool.shape.friction = friction;
  tool.reach.reset();
  Simulation simulation(scene);
  const auto at = [&](std::size_t i, double depth) {
    const double phi = 2 * std::numbers::pi * static_cast<double>(i) / kSlideSteps;
    return Vec3(-0.008 * std::cos(phi), radius - depth, 0.004 * std::sin(phi));
  };
  for (int i = -10; i <= 10; ++i) simulation.step(at(0, 0.1 * i * kDepth), kPeriod);
  std::array<Vec3, kSlideSteps> places;
  ToolForce force;
  for (std::size_t i = 0; i < kSlideSteps; ++i)
    force = simulation.step(places[i] = at(i + 1, kDepth), kPeriod);
  show(state, simulation.state_hash());
  state.counters["touching"] = force.contacts;
  time_steps_at(state, simulation, places);
}

/// One or two balls of 6 mm, 16 mm apart, pressed by 3 mm into the block of 2 mm edges that ships, and slid
/// to and fro: what a second tool on the same tissue costs.
void run_pair(benchmark::State& state, std::size_t tools) {
  constexpr double kDepth = 0.003, kApart = 0.016;
  Scene scene = test::example_scene("block");
  scene.tools.front().reach.reset();
  scene.tools.resize(tools, scene.tools.front());
  Simulation simulation(scene);
  const double radius = scene.tools.front().shape.radius;
  std::vector<ToolInput> inputs(tools);
  const auto step = [&](double depth, double slid) {
    for (std::size_t k = 0; k < tools; ++k) {
      const double x = (static_cast<double>(k) - 0.5 * static_cast<double>(tools - 1)) * kApart;
      inputs[k].pose = ToolPose(Vec3(x + slid, radius - depth, 0.001));
    }
    return simulation.step(inputs, kPeriod);
  };
  for (int i = -10; i <= 10; ++i) step(0.1 * i * kDepth, 0);
  const auto places = slide(Vec3::Zero(), Vec3::UnitX(), radius);
  for (const Vec3& place : places) {
    for (const ToolAnswer& answer : step(kDepth, place[0])) {
      if (answer.contacts == 0 || answer.flagged) return state.SkipWithError("no settled contact to time");
    }
  }
  show(state, simulation.state_hash());
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(step(kDepth, places[i++ % kSlideSteps][0]).data());
}

/// A flat patch of `side` x `side` nodes, 3 mm apart, that gives way where it is pressed and near it.
ContactPatch flat_patch(int side) {
  ContactPatch patch;
  patch.reserve(side * side, 2 * (side - 1) * (side - 1));
  for (int i = 0; i < side * side; ++i)
    patch.free.emplace_back(0.003 * (i % side - side / 2), 0, 0.003 * (i / side - side / 2));
  for (int i = 0; i + side < side * side; ++i) {
    if (i % side == side - 1) continue;
    patch.triangles.push_back({i, i + side, i + 1});
    patch.triangles.push_back({i + 1, i + side, i + side + 1});
  }
  patch.compliance.setZero();
  for (int i = 0; i < side * side; ++i) {
    for (int k = 0; k < side * side; ++k) {
      const double c = 3e-3 * std::exp(-(patch.free[i] - patch.free[k]).norm() / 0.005);  // m/N
      patch.compliance.block<3, 3>(3 * i, 3 * k) = c * Mat3::Identity();
    }
  }
  return patch;
}

void run_contact_alone(benchmark::State& state) {
  constexpr int kSide = 7;
  constexpr Tool kTool{0.005};
  ContactPatch patch = flat_patch(kSide);
  ContactSolver solver(kSide * kSide, static_cast<int>(patch.triangles.size()));
  const auto places = slide({0.0004, 0.6 * kTool.radius, 0.0007}, Vec3::UnitX(), kTool.radius);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(3 * (kSide * kSide + 1));
  std::size_t i = 0;
  time_calls(state, kHashedSteps,
             [&] { return solver.solve(patch, kTool, places[i++ % kSlideSteps], u).force; });
}

/// The first seconds of the motion that ships, recorded to where bytes go to die. The label is the hash of
/// the capture.
void run_virtual_session(benchmark::State& state) {
  constexpr VirtualLink kLink{.rate_hz = 30, .ticks_hz = 500, .delay = std::chrono::milliseconds(35)};
  constexpr std::uint64_t kTicks = 5 * 500;
  Liver* const on = liver(state, "quasi_static");
  if (on == nullptr) return;
  const Trajectory motion(
      TrajectorySettings{.file = PALPATE_SOURCE_DIR "/configs/trajectories/liver_paper.csv"});
  const auto record = [&](const std::filesystem::path& file) {
    test::lift_tools(on->simulation);
    protocol::CaptureWriter capture(file);
    VirtualSession session(on->simulation, {&motion, 1}, kLink, capture);
    for (std::uint64_t k = 0; k < kTicks; ++k) session.tick(k);
    session.leave();
  };
  const test::TemporaryFolder folder;
  record(folder.path() / "session.pcap");
  show(state, hash_of(folder.path() / "session.pcap"));
  for (auto _ : state) record("/dev/null");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kTicks));
}

}  // namespace

void add_server_rows() {
  for (const DeformationModelRow& row : models_without_cutting()) {
    const std::string_view name = row.name;
    add(fmt::format("step/{}/free", name), [name](benchmark::State& state) { run_free(state, name); });
    add(fmt::format("step/{}/contact", name), [name](benchmark::State& state) { run_contact(state, name); });
  }
  for (const std::string_view scene : {kFriction, kDense, kTiles}) {
    add(fmt::format("step/quasi_static/{}", scene),
        [scene](benchmark::State& state) { run_contact(state, scene); });
  }
  for (const double radius : {0.006, 0.012, 0.02}) {
    for (const double friction : {0.0, 0.3}) {
      add(fmt::format("step/oval/{:g}_mm/{}", 1e3 * radius, friction > 0 ? "rubbing" : "smooth"),
          [=](benchmark::State& state) { run_oval(state, radius, friction); });
    }
  }
  add("step/pair/one_tool", [](benchmark::State& state) { run_pair(state, 1); });
  add("step/pair/two_tools", [](benchmark::State& state) { run_pair(state, 2); });
  add("contact/flat_patch", run_contact_alone);
  add("virtual_session/5_s", run_virtual_session);
}

}  // namespace palpate::bench
