// The law that solves contact where its model of the surface is still on the way, too large, or of another
// version: two tangents meanwhile, and exact again.
#include "protocol/codec.h"
#include "protocol/link_simulator.h"
#include "tests/support/catch.h"
#include "tests/support/listener.h"

using namespace palpate;
using namespace palpate::client;
using namespace palpate::test;
using namespace std::chrono_literals;
using protocol::SurfacePage;
using protocol::ToolState;

namespace {

const protocol::LinkConditions kBad{
    .delay = 0.02, .jitter = 0.03, .loss = 0.1, .duplicates = 0.1, .reordered = 0.1, .reorder_delay = 0.1};

/// Asks for the model page by page, as the pipeline does; what it asks and what comes travels as bytes.
struct Asking : Listener {
  Vec3 tick(const Vec3& p) {
    const Time now = t + kTick;
    if (now - requested >= 8ms && newest.number > 0) ask(p, now);
    answer(now);
    take(now);
    return Listener::tick(p);
  }
  void ask(const Vec3& p, Time now) {
    requested = now;
    ToolState state{.tick = ++asks, .p_W = p, .flags = ToolState::kRequestsSurface | ToolState::kAsksPages};
    if (!model.choose_missing(p, 3 * 0.005, now, state.pages)) return;
    state.surface_version = model.version();
    send(up, state, now);
  }
  void answer(Time now) {
    SurfacePage page;
    for (protocol::Datagram datagram; receive(up, now, datagram);) {
      for (const std::uint32_t number : std::get<ToolState>(datagram.message).pages) {
        if (pager.page(number, page)) send(down, page, now);
      }
    }
  }
  void take(Time now) {
    for (protocol::Datagram datagram; receive(down, now, datagram); ++pages)
      model.take(std::get<SurfacePage>(datagram.message));
  }
  /// Whether nothing that may be touched from here is missing, asked for or not.
  bool complete() {
    std::array<std::uint32_t, 8> none;
    return !model.choose_missing(place, 3 * 0.005, t + 1s, none);
  }
  static void send(protocol::LinkSimulator& link, const protocol::Message& message, Time now) {
    std::array<std::byte, protocol::kMaxDatagram> bytes;
    link.send({bytes.data(), protocol::encode({1, 1}, message, bytes)}, now);
  }
  static bool receive(protocol::LinkSimulator& link, Time now, protocol::Datagram& datagram) {
    const auto bytes = link.receive(now);
    if (bytes) REQUIRE(protocol::decode(*bytes, datagram) == protocol::Verdict::kAccepted);
    return bytes.has_value();
  }

  protocol::LinkSimulator up{kBad, 3}, down{kBad, 4};
  sim::SurfacePager pager{block.simulation, 0};
  Time requested{};
  std::uint64_t asks = 0, pages = 0;
};

/// A listener, and two tangents on the same samples.
struct Beside : Listener {
  using Listener::Listener;
  Vec3 tick(const Vec3& p) {
    const auto before = newest.number;
    const Vec3 given = Listener::tick(p);
    if (newest.number != before) other.take(sample_of(newest), p, t);
    simpler = other.force(p, t);
    return given;
  }
  ForceEstimate other{std::make_unique<TwoTangents>()};
  Vec3 simpler = Vec3::Zero();
};

/// The block with vertices 2 mm apart, under a sphere of 15 mm, which comes near several hundred triangles.
sim::Scene crowded_scene() {
  sim::Scene scene = block_scene();
  scene.tools[0].shape.radius = 0.015;
  scene.tools[0].reach = sim::Box{Vec3(-1, -1e-3, -1), Vec3(1, 1e-3, 1)};  // so that the whole model has room
  return scene;
}
sim::TetMesh crowded_mesh() {
  std::vector<double> side;
  for (int i = -10; i <= 10; ++i) side.push_back(0.002 * i);
  return sim::grid_block(side, {-0.016, -0.012, -0.008, -0.004, 0}, side);
}

}  // namespace

TEST_CASE("local contact: the model asked for over a bad link comes whole, and meanwhile nothing is worse") {
  Asking listener;
  Listener none;
  const Errors while_missing = follow(listener, 2s), without = follow(none, 2s);
  CHECK_FALSE(listener.complete());
  CAPTURE(while_missing.largest, without.largest);
  CHECK(while_missing.largest < 1.5 * without.largest);
  const Errors later = follow(listener, 4s), still_without = follow(none, 4s);
  CAPTURE(later.largest, still_without.largest);
  CHECK(later.largest < 1.5 * still_without.largest);
  REQUIRE(listener.complete());
  const Errors exact = follow(listener);
  CAPTURE(exact.mean, exact.largest);
  CHECK(exact.mean < 5e-4);
  CHECK(exact.largest < 0.01);
  for (const auto* link : {&listener.up, &listener.down}) {
    const protocol::LinkCounts& counts = link->counts();
    for (const std::uint64_t count : {counts.lost, counts.duplicated, counts.reordered}) CHECK(count > 0);
  }
}

TEST_CASE(
    "local contact: more triangles near the tool than it has room for: it says so, and is two tangents") {
  Beside listener(crowded_scene(), crowded_mesh());
  listener.learn(kEntireModel);
  listener.place = {0, 0.018, 0.001};
  std::array<std::uint32_t, 8> none;
  REQUIRE_FALSE(listener.model.choose_missing(listener.place, 0.05, 1s, none));
  int pressed = 0;
  for (int i = 0; i < 1000; ++i) {  // down to 2 mm deep, and to and fro
    const Vec3 p(0.003 * std::sin(0.01 * i), std::max(0.018 - 2.5e-5 * i, 0.013), 0.001);
    const Vec3 given = listener.tick(p);
    if (p[1] > 0.0145) continue;
    CHECK(listener.law.stepped_down());
    CHECK(listener.law.substitute() == "two_tangents");
    CHECK(given == listener.simpler);
    pressed += given.norm() > 0.5 ? 1 : 0;
  }
  CHECK(pressed > 500);
}

TEST_CASE(
    "local contact: another version of the surface while it presses: two tangents until its pages are here") {
  Beside listener;
  listener.learn(kEntireModel);
  sim::Simulation truth(block_scene(), block_mesh());
  double peak = 0;
  int simpler = 0;
  const auto follow_for = [&](Time duration) {
    for (const Time end = listener.t + duration; listener.t < end;) {
      const Vec3 p = slide(listener.t + kTick), right = truth.step(p, 0.002).force, given = listener.tick(p);
      peak = std::max(peak, right.norm());
      simpler += listener.law.stepped_down() && !given.isZero(0) ? 1 : 0;
      if (listener.law.stepped_down()) CHECK(given == listener.simpler);
      if (listener.newest.number > 2 && !listener.law.stepped_down())
        CHECK((given - right).norm() < 0.01 * peak);
    }
  };
  follow_for(150ms);
  simpler = 0;
  follow_for(200ms);
  CHECK(simpler == 0);
  listener.published = [](protocol::ForceSample& sample) { sample.surface.version ^= 2; };
  follow_for(100ms);
  CHECK(simpler > 30);  // from the next sample on, 30 ms later at most
  protocol::SurfaceState other = sim::SurfacePager(listener.block.simulation, 0).state();
  other.version ^= 2;
  REQUIRE(listener.model.version() == other.version);
  for (SurfacePage page : all_pages(listener.block.simulation)) {
    page.version = other.version;
    listener.model.take(page);
  }
  follow_for(60ms);
  simpler = 0;
  CHECK(follow(listener, 1s).mean < 5e-4);
  follow_for(400ms);
  CHECK(simpler == 0);
}

TEST_CASE("local contact: a surface of more vertices than it takes is left to two tangents") {
  Beside listener;
  listener.published = [](protocol::ForceSample& sample) {
    sample.surface.vertices = SurfaceModel::kMostVertices + 1;
  };
  int pressed = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 given = listener.tick(slide(listener.t + kTick));
    CHECK(listener.model.version() == 0);
    CHECK(given == listener.simpler);
    pressed += listener.law.stepped_down() && given.norm() > 0.1 ? 1 : 0;
  }
  CHECK(pressed > 300);
}
