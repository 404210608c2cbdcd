#ifdef PALPATE_WITH_CAPTURE
// A resection in a session: what of it travels, and what a capture of it is good for.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <random>

#include "sim_server/client_model/slow_modes.h"
#include "sim_server/serving/captured_rerun.h"
#include "sim_server/serving/virtual_session.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;
using protocol::ForceSample;
using protocol::ToolState;

namespace {

constexpr double kRate = 50, kTicks = 1000;  // Hz

Scene cut_scene(const char* model) {
  Scene scene = soft_block_scene(0.02, model, ElasticLaw::kLinear, 0.003);
  scene.rate_hz = kRate;
  scene.tools[0].cut_buttons = 2;
  scene.cutting = Cutting{.power = 20, .energy = 1e7, .where = "test"};
  return scene;
}
/// Down into the block, to and fro there by so much (m), with a button that is read anew each millisecond and
/// bounces for 0.3 s, then is held.
Trajectory motion(const TemporaryFolder& folder, double swing = 0.008) {
  std::minstd_rand random(1);
  std::string rows = "t_s,x_m,y_m,z_m,buttons\n";
  for (int k = 0; k <= 1000; ++k) {
    const double t = 1e-3 * k;
    rows += fmt::format("{},{},{},{},{}\n", t, swing * std::sin(6 * t), 0.003 - 0.006 * t, 0.0005,
                        k < 300 ? 2 * (random() / 1000 % 2) : 2);
  }
  return Trajectory({.file = folder.write("motion.csv", rows)});
}

std::uint64_t record(Simulation& simulation, const Trajectory& motion, const std::filesystem::path& file) {
  protocol::CaptureWriter capture(file);
  VirtualSession session(simulation, {&motion, 1}, {kRate, kTicks}, capture);
  for (int k = 0; k <= static_cast<int>(motion.duration() * kTicks); ++k)
    session.tick(static_cast<std::uint64_t>(k));
  session.leave();
  return simulation.state_hash();
}

std::vector<ForceSample> samples_in(const std::filesystem::path& file) {
  std::vector<ForceSample> samples;
  read_captured_steps(
      file, [](std::uint64_t, const ToolState&) {},
      [&](const CapturedAnswer& answer) { samples.push_back(answer.sample); });
  return samples;
}

}  // namespace

TEST_CASE("a recorded resection, stepped again from its capture alone, gives the same bits") {
  struct Kind {
    const char* model;
    bool blade = false;
  };
  for (const auto& [model, blade] :
       {Kind{"tensor_mass"}, Kind{"implicit"}, Kind{"hybrid"}, Kind{"tensor_mass", true},
        Kind{"implicit", true}, Kind{"hybrid", true}}) {
    CAPTURE(model, blade);
    const TemporaryFolder folder;
    Scene scene = cut_scene(model);
    if (scene.deformation.model == "hybrid")
      scene.cutting->plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.006};
    if (blade) scene.tools[0].blade = Vec3(0, -0.018, 0);
    Simulation first(scene, deep_block()), second(scene, deep_block());
    const std::uint64_t hash = record(first, motion(folder, blade ? 0.016 : 0.008), folder.path() / "a.pcap");
    const ResectionTotals& totals = first.resection()->totals();
    REQUIRE((blade ? 6 * totals.splits : totals.tetrahedra) > 20);
    CapturedRerun rerun(second, kRate);
    std::size_t answers = 0, remaining = 0;
    read_captured_steps(
        folder.path() / "a.pcap",
        [&](std::uint64_t session, const ToolState& state) { rerun.take(session, state); },
        [&](const CapturedAnswer& answer) {
          rerun.take(answer);
          const auto& outcome = rerun.step().front();
          CHECK(outcome.force.force == answer.sample.f_W);
          CHECK(outcome.answer->cuts == answer.sample.cuts);
          ++answers;
        },
        [&](std::uint64_t) { ++remaining; });
    CHECK(rerun.off() == 0);
    CHECK(answers > 40);
    CHECK(remaining == 1);
    CHECK(second.state_hash() == hash);
    CHECK(second.resection()->totals().tetrahedra == first.resection()->totals().tetrahedra);
  }
}

TEST_CASE("tissue that can be cut by tensor_mass gives way over a sub-step, and tells no tangents of that") {
  Simulation simulation(cut_scene("tensor_mass"), deep_block());
  ServedTools served(simulation);
  std::vector<SessionInput> inputs{
      {7, {.flags = ToolState::kRequestsTangent | ToolState::kRequestsAhead}, true}};
  ToolState& state = inputs[0].state;
  int touched = 0;
  for (int k = 1; k <= 30; ++k) {
    ++state.tick;
    state.t_ns += 20'000'000;
    state.p_W = Vec3(0.001, 0.0045 - 1e-4 * k, 0.0005);
    const auto& outcome = served.step(inputs, 0.02).front();
    touched += outcome.force.contacts > 0 ? 1 : 0;
    REQUIRE(outcome.answer);
    CHECK((outcome.answer->flags & (ForceSample::kHasTangent | ForceSample::kHasAhead)) == 0);
  }
  CHECK(touched > 5);
  CHECK(touched < 30);
}

TEST_CASE(
    "samples of tissue that can be cut say in how many steps it was, whether the tool cuts, and of no "
    "surface or modes") {
  const TemporaryFolder folder;
  Simulation simulation(cut_scene("tensor_mass"), deep_block());
  record(simulation, motion(folder), folder.path() / "a.pcap");
  std::uint32_t before = 0;
  int samples = 0, said = 0, changes = 0;
  bool cutting = false;
  for (const ForceSample& sample : samples_in(folder.path() / "a.pcap")) {
    ++samples;
    CHECK((sample.flags & ForceSample::kHasCuts) != 0);
    CHECK((sample.flags & (ForceSample::kHasSurface | ForceSample::kHasModes)) == 0);
    CHECK(sample.cuts >= before);
    CHECK(sample.cuts <= before + 1);
    before = sample.cuts;
    const bool cut = (sample.flags & ForceSample::kCutting) != 0;
    changes += cut != cutting ? 1 : 0;
    cutting = cut;
    said += cutting ? 1 : 0;
  }
  CHECK(cutting);
  CHECK(said > samples / 2);
  CHECK(changes > 4);  // the button bounced
  CHECK(before == simulation.resection()->version());
  CHECK(before > 5);
}

TEST_CASE(
    "what a resection removed, removed again by list, gives the same forces, and at another rate as much "
    "goes") {
  const TemporaryFolder folder;
  const Trajectory path = motion(folder);
  Simulation heated(cut_scene("tensor_mass"), deep_block()), listed(cut_scene("tensor_mass"), deep_block());
  const std::uint64_t hash = record(heated, path, folder.path() / "a.pcap");
  const std::vector<Removal> removals(heated.cut()->removals().begin(), heated.cut()->removals().end());
  REQUIRE(removals.size() > 20);
  listed.set_cut_options({.planned = removals});
  CHECK(record(listed, path, folder.path() / "b.pcap") == hash);
  Scene quick = cut_scene("tensor_mass");
  quick.rate_hz = 500;
  Simulation often(quick, deep_block());
  often.set_cut_options({.planned = removals});
  {
    protocol::CaptureWriter capture(folder.path() / "c.pcap");
    VirtualSession session(often, {&path, 1}, {500, kTicks}, capture);
    for (std::uint64_t k = 0; k <= static_cast<std::uint64_t>(kTicks); ++k) session.tick(k);
  }
  CHECK(often.resection()->remaining().count() == heated.resection()->remaining().count());
  for (std::size_t i = 0; i < removals.size(); ++i) {
    CHECK(often.cut()->removals()[i].tetrahedron == removals[i].tetrahedron);
    CHECK(std::abs(often.cut()->removals()[i].t - removals[i].t) < 1 / 500.0 + 1e-9);
  }
}

TEST_CASE("samples tell of a surface until it is cut, in that step no more, and of another one afterwards") {
  const TemporaryFolder folder;
  const std::string rows = "t_s,x_m,y_m,z_m\n0,0,0.0025,0\n3,0.004,0.002,0.0005\n";
  const Trajectory path({.file = folder.write("still.csv", rows)});
  Scene scene = cut_scene("tensor_mass");
  scene.deformation.of<ClientModes>().modes = 20;
  Simulation simulation(scene, deep_block());
  std::vector<Removal> removals;
  const TetMesh& mesh = simulation.mesh();
  for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
    const Vec3 centre = centre_of(mesh, mesh.tetrahedra[static_cast<std::size_t>(t)]);
    if (centre.norm() < 0.004) removals.push_back({1.5, t});
  }
  REQUIRE(removals.size() > 0);
  simulation.set_cut_options({.planned = removals});
  {
    protocol::CaptureWriter capture(folder.path() / "a.pcap");
    VirtualSession session(simulation, {&path, 1}, {.rate_hz = kRate, .ticks_hz = kTicks, .parts = true},
                           capture);
    for (std::uint64_t k = 0; k <= 3 * static_cast<std::uint64_t>(kTicks); ++k) session.tick(k);
  }
  std::vector<std::uint32_t> before, after;
  for (const ForceSample& sample : samples_in(folder.path() / "a.pcap")) {
    const bool has_surface = (sample.flags & ForceSample::kHasSurface) != 0;
    CHECK(has_surface == ((sample.flags & ForceSample::kHasModes) != 0));
    if (has_surface) (sample.cuts == 0 ? before : after).push_back(sample.surface.version);
    if (sample.cuts == 1 && after.empty()) CHECK(!has_surface);
  }
  CHECK(before.size() > 60);  // of 75 samples; it takes 0.2 s to be told at first
  CHECK(after.size() > 50);
  CHECK(after.size() < 65);  // and 0.1 s alone, 0.2 s for the body, 0.2 s for the surface
  CHECK(std::ranges::count(before, before.front()) == std::ssize(before));
  CHECK(std::ranges::count(after, after.front()) == std::ssize(after));
  CHECK(after.front() != before.front());
}

#endif
