#ifdef PALPATE_WITH_CAPTURE
#include "sim_server/serving/virtual_session.h"

#include <fstream>
#include <iterator>
#include <set>

#include "protocol/scene_print.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/models/rigid.h"
#include "sim_server/serving/captured_rerun.h"
#include "tests/support/catch.h"
#include "tests/support/served_block.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;
using namespace std::chrono_literals;
using protocol::ForceSample;
using protocol::ToolState;

namespace {

/// Straight down into the top of a wall that answers with 1000 N/m: a force known in closed form.
struct Press {
  Simulation simulation;
  Trajectory motion{{0, 1}, {{0, 0.012, 0}, {0, 0.002, 0}}};  // 10 mm/s; the surface is met after 0.7 s

  Press() : simulation(scene(), block()) {}
  static TetMesh block() {
    const std::vector<double> axis{-0.05, -0.02, 0.02, 0.05}, depth{-0.05, -0.02, 0};
    return grid_block(axis, depth, axis);
  }
  static Scene scene() {
    Scene scene;
    scene.source = "test";
    scene.deformation.model = "rigid";
    scene.deformation.where = "test";
    scene.deformation.of<RigidSettings>().stiffness = 1000;
    scene.tools[0].shape.radius = 0.005;
    return scene;
  }
};

struct Captured {
  std::vector<ToolState> states;
  std::vector<std::pair<Time, ForceSample>> samples;  // with the time they arrived
  std::uint64_t late = 0;                             // deadlines
};

Captured run(const VirtualLink& link, double seconds, const std::filesystem::path& file) {
  Press press;
  Captured found;
  {
    protocol::CaptureWriter capture(file);
    VirtualSession session(press.simulation, {&press.motion, 1}, link, capture);
    for (std::uint64_t k = 0; k <= static_cast<std::uint64_t>(seconds * link.ticks_hz); ++k) session.tick(k);
    session.leave();
    found.late = session.stats().late;
  }
  protocol::CaptureReader reader(file);
  protocol::CapturedDatagram captured;
  protocol::Datagram datagram;
  while (reader.next(captured)) {
    REQUIRE(protocol::decode(captured.bytes, datagram) == protocol::Verdict::kAccepted);
    if (const auto* state = std::get_if<ToolState>(&datagram.message)) found.states.push_back(*state);
    if (const auto* sample = std::get_if<ForceSample>(&datagram.message))
      found.samples.emplace_back(captured.t, *sample);
  }
  return found;
}

/// In which order samples and pages of the surface came. Each page comes once: first those of the shape, in
/// one go, in their own order, then those of compliance.
struct Order {
  std::uint32_t pages = 0;
  std::set<std::uint32_t> numbers = {};
  int nameless = 0, samples_before_pages = 0, samples_behind_pages = 0;
};
Order order_of(Simulation& simulation, const Trajectory& motion, double seconds) {
  const auto state = SurfacePager(simulation, 0).state();
  const protocol::SurfacePages all{state.vertices, state.triangles};
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "order.pcap";
  const VirtualLink link{.rate_hz = 30, .ticks_hz = 500, .delay = 5ms, .parts = true};
  {
    protocol::CaptureWriter capture(file);
    VirtualSession session(simulation, {&motion, 1}, link, capture);
    for (std::uint64_t k = 0; k <= static_cast<std::uint64_t>(seconds * link.ticks_hz); ++k) session.tick(k);
  }
  Order order;
  protocol::CaptureReader reader(file);
  protocol::CapturedDatagram captured;
  protocol::Datagram datagram;
  while (reader.next(captured)) {
    REQUIRE(protocol::decode(captured.bytes, datagram) == protocol::Verdict::kAccepted);
    if (const auto* sample = std::get_if<ForceSample>(&datagram.message)) {
      const bool names = (sample->flags & ForceSample::kHasSurface) != 0;
      order.nameless += names ? 0 : 1;
      ++(order.pages == 0 ? order.samples_before_pages : order.samples_behind_pages);
    }
    if (const auto* page = std::get_if<protocol::SurfacePage>(&datagram.message)) {
      const bool shape = page->page < all.first_tile();
      if (shape) CHECK(order.samples_behind_pages == 0);
      if (shape) CHECK(page->page == order.pages);
      CHECK(order.numbers.insert(page->page).second);
      ++order.pages;
    }
  }
  return order;
}

protocol::SurfacePages entire_model(const Simulation& simulation) {
  const auto state = SurfacePager(simulation, 0).state();
  return {state.vertices, state.triangles};
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("virtual time: step n answers the newest pose at n / rate, its force arrives after the delay") {
  const test::TemporaryFolder folder;
  const Captured found = run({.rate_hz = 30, .ticks_hz = 500, .delay = 35ms}, 1, folder.path() / "a.pcap");
  REQUIRE(found.states.size() == 501);
  REQUIRE(found.samples.size() == 29);  // 31 steps, of which the last two are still on the way
  for (std::size_t n = 0; n < found.samples.size(); ++n) {
    const auto& [arrived, sample] = found.samples[n];
    const auto tick = static_cast<std::uint64_t>(static_cast<double>(n) / 30 * 500 + 1e-9);
    CHECK(sample.number == n + 1);
    CHECK(sample.tool_tick == tick + 1);
    CHECK(Time{sample.tool_t_ns} == tick * 2ms);
    CHECK(arrived == tick * 2ms + 35ms);
    CHECK(sample.step_ns == 0);
    // 10 mm/s down from 12 mm, tool radius 5 mm, 1000 N/m.
    const double depth = std::max(0.0, 0.01 * static_cast<double>(tick) * 0.002 - 0.007);
    CHECK(sample.f_W[1] == Approx(1000 * depth).margin(1e-9));
  }
  for (const ToolState& state : found.states) {
    std::uint64_t newest = 0;
    for (const auto& [arrived, sample] : found.samples) {
      if (arrived <= Time{state.t_ns}) newest = sample.number;
    }
    CHECK(state.newest_sample == newest);
    CHECK(state.p_W[1] == Approx(0.012 - 0.01 * 1e-9 * static_cast<double>(state.t_ns)));
    if (state.tick > 1) CHECK(state.v_W[1] == Approx(-0.01));
  }
}

TEST_CASE("virtual time: steps that take none by their clock answer what they do without one") {
  struct Clock final : StepClock {
    void begin(Time) override {}
    Time took() override { return 0ms; }
  } clock;
  const test::TemporaryFolder folder;
  VirtualLink link{.rate_hz = 30, .ticks_hz = 500, .delay = 35ms};
  const Captured without = run(link, 1, folder.path() / "a.pcap");
  link.clock = &clock;
  const Captured with = run(link, 1, folder.path() / "b.pcap");
  REQUIRE(with.samples.size() >= 28);
  REQUIRE(with.samples.size() <= without.samples.size());
  for (std::size_t n = 0; n < with.samples.size(); ++n) {
    CHECK(with.samples[n].second.tool_tick == without.samples[n].second.tool_tick);
    CHECK(with.samples[n].second.f_W == without.samples[n].second.f_W);
    // It leaves at its deadline, not at the tick before.
    CHECK(std::abs(to_seconds(with.samples[n].first) - (static_cast<double>(n) / 30 + 0.035)) < 1e-6);
  }
  CHECK(with.late == 0);
}

TEST_CASE(
    "virtual time: where steps take time, samples wait for their step, and a long one puts off the others") {
  /// Steps of 10 ms, the fifth of 130 ms.
  struct Clock final : StepClock {
    std::vector<Time> begun;
    void begin(Time t) override { begun.push_back(t); }
    Time took() override { return begun.size() == 5 ? 130ms : 10ms; }
  } clock;
  const test::TemporaryFolder folder;
  const Captured found =
      run({.rate_hz = 25, .ticks_hz = 500, .delay = 3ms, .clock = &clock}, 0.5, folder.path() / "a.pcap");
  // The deadlines at 200, 240 and 280 ms pass over while the fifth step is at work, from 160 to 290 ms.
  CHECK(clock.begun ==
        std::vector<Time>{0ms, 40ms, 80ms, 120ms, 160ms, 290ms, 330ms, 370ms, 410ms, 450ms, 490ms});
  CHECK(found.late == 3);
  REQUIRE(found.samples.size() == 10);  // the last is on the way
  for (std::size_t n = 0; n < found.samples.size(); ++n) {
    const auto& [arrived, sample] = found.samples[n];
    CHECK(arrived == clock.begun[n] + (n == 4 ? 133ms : 13ms));
    CHECK(sample.tool_tick == static_cast<std::uint64_t>(clock.begun[n] / 2ms) + 1);
  }
}

TEST_CASE("virtual time without delay: the tick that is answered knows the answer") {
  const test::TemporaryFolder folder;
  const Captured found = run({.rate_hz = 100, .ticks_hz = 500, .delay = 0ms}, 0.5, folder.path() / "a.pcap");
  for (const auto& [arrived, sample] : found.samples) {
    CHECK(found.states[sample.tool_tick - 1].newest_sample == sample.number);
    CHECK(arrived == Time{sample.tool_t_ns});
  }
  CHECK(found.samples.size() == 51);
}

TEST_CASE("virtual time: the pages of the surface come right after the first sample that names it") {
  // Samples of a tool beyond the world are flagged and name nothing; those within do: from the third step on.
  const Trajectory motion{{0, 0.05, 0.1, 0.3}, {{0, 1500, 0}, {0, 1100, 0}, {0, 0.007, 0}, {0, 0.004, 0}}};
  Simulation block(test::block_scene(), test::block_mesh());
  const Order order = order_of(block, motion, 0.3);
  CHECK(order.samples_before_pages == 3);
  CHECK(order.nameless == 2);
  CHECK(order.pages == entire_model(block).count());
  CHECK(order.samples_behind_pages > 3);
}

TEST_CASE("virtual time: of a surface that the tool stays away from, the shape comes and no compliance") {
  Simulation block(test::block_scene(), test::block_mesh());
  const Order order = order_of(block, {{0, 0.3}, {{0, 0.1, 0}, {0.02, 0.1, 0}}}, 0.3);
  CHECK(order.pages == entire_model(block).first_tile());
  CHECK(order.nameless == 0);
  CHECK(order.samples_behind_pages > 5);
}

TEST_CASE("virtual time: of a long surface, compliance comes where the tool is") {
  // A bar of 400 mm, pressed at one end by a tool that stands: three radii, 15 mm, are near.
  Scene scene = test::block_scene();
  std::vector<double> along;
  for (int i = 0; i <= 80; ++i) along.push_back(0.005 * i);
  Simulation bar(scene, grid_block(along, {-0.016, -0.008, 0}, {-0.01, 0, 0.01}));
  const Order order = order_of(bar, {{0, 0.3}, {{0.02, 0.006, 0}, {0.02, 0.004, 0}}}, 0.3);
  const auto all = entire_model(bar);
  CHECK(order.pages > all.first_tile());
  CHECK(order.pages - all.first_tile() < (all.count() - all.first_tile()) / 4);  // of 90 mm in 400
  const SurfacePager pager(bar, 0);
  const std::span<const Vec3> rest = pager.rest();
  for (std::uint32_t i = 0; i < rest.size(); ++i) {
    if ((rest[i] - Vec3(0.02, 0, 0)).norm() > 0.01) continue;
    const std::uint32_t own = i / protocol::SurfacePages::kCluster;
    CHECK(order.numbers.count(all.tile(own, own)) == 1);
  }
}

TEST_CASE("virtual time: of tissue that is held no sample names the surface, and no page comes") {
  Scene scene = test::block_scene();
  scene.tools[0].grasp_place = Vec3(0.001, 0.005, 0.0005);
  Simulation block(scene, test::block_mesh());
  const Order order = order_of(block, {{0, 0.3}, {{0.001, 0.005, 0.0005}, {0.001, 0.008, 0.0005}}}, 0.3);
  CHECK(order.pages == 0);
  CHECK(order.nameless == order.samples_before_pages);
  CHECK(order.samples_before_pages > 5);
}

TEST_CASE("virtual time: two tools that hold one organ feel each other, by the same stiffness both ways") {
  const Vec3 places[] = {{-0.009, 0.005, 0.0005}, {0.011, 0.005, 0.0005}};
  Scene scene = test::block_scene();
  scene.tools.resize(2, scene.tools.front());
  for (std::size_t i = 0; i < 2; ++i) scene.tools[i].grasp_place = places[i];
  constexpr double kMoved = 0.001;  // m
  // What a tool feels of the other one's motion along an axis: Maxwell and Betti, F1 of u2 = F2 of u1.
  const auto rendered = [&](std::size_t tool, int axis) {
    Simulation block(scene, test::block_mesh());
    std::vector<Trajectory> motions;
    for (std::size_t i = 0; i < 2; ++i)
      motions.emplace_back(
          std::vector{0.0, 0.2},
          std::vector{places[i], Vec3(places[i] + (i == tool ? 0 : kMoved) * Vec3::Unit(axis))});
    const test::TemporaryFolder folder;
    protocol::CaptureWriter capture(folder.path() / "two.pcap");
    const VirtualLink link{.rate_hz = 30, .ticks_hz = 500, .tool = tool};
    VirtualSession session(block, motions, link, capture);
    for (std::uint64_t k = 0; k <= 120; ++k) session.tick(k);
    REQUIRE(capture.flush());
    ForceSample newest;
    protocol::CaptureReader reader(folder.path() / "two.pcap");
    protocol::CapturedDatagram captured;
    protocol::Datagram datagram;
    while (reader.next(captured)) {
      REQUIRE(protocol::decode(captured.bytes, datagram) == protocol::Verdict::kAccepted);
      const auto* sample = std::get_if<ForceSample>(&datagram.message);
      if (sample != nullptr && sample->tool == tool) newest = *sample;
    }
    CHECK(newest.tool == tool);
    return newest.f_W;
  };
  Mat3 first, second;
  for (int axis = 0; axis < 3; ++axis) {
    first.col(axis) = rendered(0, axis) / kMoved;
    second.col(axis) = rendered(1, axis) / kMoved;
  }
  CAPTURE(first, second);
  CHECK(first.norm() > 1);  // N/m
  CHECK((first - second.transpose()).norm() < 1e-6 * first.norm());
}

TEST_CASE(
    "virtual time: a capture of two tools holds a session of each, and is stepped again to the same bits") {
  const bool parts = GENERATE(false, true);
  CAPTURE(parts);
  Scene scene = test::block_scene();
  scene.tools.resize(2, scene.tools.front());
  scene.tools[1].shape.radius = 0.004;
  std::vector<Trajectory> motions;
  for (const double x : {-0.008, 0.008})
    motions.emplace_back(std::vector{0.0, 0.5, 1.0},
                         std::vector{Vec3(x, 0.008, 0), Vec3(x, 0.001, 0.001), Vec3(x, 0.003, -0.002)});
  Simulation first(scene, test::block_mesh()), second(scene, test::block_mesh());
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "two.pcap";
  constexpr std::size_t kSecond = 1;
  {
    protocol::CaptureWriter capture(file);
    VirtualSession session(first, motions,
                           {.rate_hz = 30, .ticks_hz = 500, .delay = 5ms, .parts = parts, .tool = kSecond},
                           capture);
    for (std::uint64_t k = 0; k <= 450; ++k) session.tick(k);
    session.leave();
  }
  CapturedRerun rerun(second, 30);
  std::vector<std::size_t> tools;
  bool pending = false;
  read_captured_steps(
      file,
      [&](std::uint64_t session, const ToolState& state) {
        tools.push_back(state.tool);
        rerun.take(session, state);
      },
      [&](const CapturedAnswer& answer) {
        if (answer.begins_step && pending) rerun.step();
        rerun.take(answer);
        pending = true;
      });
  rerun.step();
  REQUIRE(tools.size() == 2 * 451);
  CHECK(tools.front() == kSecond);  // whose figures are reported
  CHECK(std::ranges::count(tools, kSecond) == 451);
  CHECK(rerun.tools_taken() == 2);
  CHECK(rerun.largest() > 0.1);  // N
  // What clients ask for besides their forces costs the joint contact of both tools some rounding.
  CHECK(rerun.off() <= (parts ? 1e-12 : 0));
}

TEST_CASE("virtual time: the Welcome of a capture tells of which scene it is") {
  const protocol::ScenePrint scene{.mesh = 1, .material = 2, .supports = 3, .tools = 4};
  const test::TemporaryFolder folder;
  run({.rate_hz = 30, .ticks_hz = 500, .scene = scene}, 0.1, folder.path() / "a.pcap");
  protocol::CaptureReader reader(folder.path() / "a.pcap");
  protocol::CapturedDatagram captured;
  protocol::Datagram datagram;
  int welcomes = 0;
  while (reader.next(captured)) {
    REQUIRE(protocol::decode(captured.bytes, datagram) == protocol::Verdict::kAccepted);
    const auto* welcome = std::get_if<protocol::Welcome>(&datagram.message);
    if (welcome == nullptr) continue;
    ++welcomes;
    CHECK(protocol::print_in(*welcome) == scene);
  }
  CHECK(welcomes == 1);
}

TEST_CASE("virtual time twice gives the same bytes") {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.pcap", "b.pcap"})
    run({.rate_hz = 33.3, .ticks_hz = 500, .delay = 35ms}, 1, folder.path() / name);
  CHECK(bytes_of(folder.path() / "a.pcap") == bytes_of(folder.path() / "b.pcap"));
  CHECK(bytes_of(folder.path() / "a.pcap").size() > 500 * 150);
}
#endif
