#include "haptic_client/extrapolation/surface_model.h"

#include <set>

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/served_block.h"

using namespace palpate;
using namespace palpate::client;
using protocol::SurfacePage;
using protocol::SurfacePages;
using protocol::SurfaceState;
using protocol::ToolState;
using namespace std::chrono_literals;

namespace {

using Requested = std::array<std::uint32_t, 8>;

struct Served {
  sim::Simulation block{test::block_scene(), test::block_mesh()};
  sim::SurfacePager pager{block, 0};
  SurfaceModel model;
  Served() { model.announce(pager.state()); }

  /// Asks and answers until nothing is missing; returns how many pages came.
  int fetch(const Vec3& p, double reach) {
    int came = 0;
    SurfacePage page;
    for (Requested requested; model.choose_missing(p, reach, now += 8ms, requested);) {
      for (const std::uint32_t number : requested) {
        if (number == ToolState::kNoPage) continue;
        REQUIRE(pager.page(number, page));
        model.take(page);
        ++came;
      }
    }
    return came;
  }
  Time now = 1s;
};

}  // namespace

TEST_CASE("surface pages: tiles of clusters in any order, and back") {
  const SurfacePages pages{.vertices = 4000, .triangles = 7996};
  CHECK(pages.clusters() == 800);
  CHECK(pages.first_triangle_page() == 54);  // 4000 / 75
  CHECK(pages.first_tile() == 54 + 107);     // 7996 / 75
  CHECK(pages.count() == 161 + 800 * 801 / 2);
  std::uint32_t page = pages.first_tile();
  for (std::uint32_t a = 0; a < 800; ++a) {
    for (std::uint32_t b = 0; b <= a; ++b, ++page) {
      REQUIRE(pages.tile(a, b) == page);
      REQUIRE(pages.tile(b, a) == page);
      REQUIRE(pages.clusters_of(page) == std::pair(a, b));
    }
  }
}

TEST_CASE("surface model: page by page it becomes the server's surface and compliance, to float precision") {
  Served served;
  CHECK(served.pager.state().vertices == 11 * 11 * 2 + 40 * 3);
  const SurfacePages pages{served.pager.state().vertices, served.pager.state().triangles};
  CHECK(served.fetch({0, 0.01, 0}, 1) == static_cast<int>(pages.count()));
  REQUIRE(served.model.has_shape());
  // The same triangles, by where their corners are.
  const auto key = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 sum = a + b + c;
    return std::array{std::lround(sum[0] * 1e6), std::lround(sum[1] * 1e6), std::lround(sum[2] * 1e6)};
  };
  std::multiset<std::array<long, 3>> at_tool, there;
  const auto rest = served.model.rest();
  for (const auto& t : served.model.triangles()) at_tool.insert(key(rest[t[0]], rest[t[1]], rest[t[2]]));
  const auto& x = served.block.rest();
  for (const auto& t : served.block.touchable(0)) there.insert(key(x[t[0]], x[t[1]], x[t[2]]));
  CHECK(at_tool == there);
  // The same compliance, vertex by vertex.
  std::vector<int> vertex(rest.size(), -1);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t v = 0; v < x.size(); ++v) {
      if ((x[v] - rest[i]).norm() < 1e-7) vertex[i] = static_cast<int>(v);
    }
    REQUIRE(vertex[i] >= 0);
  }
  ContactPatch patch;
  patch.reserve(2, 0);
  double largest = 0, worst = 0;
  for (int i = 0; i < static_cast<int>(rest.size()); ++i) {
    for (int j = 0; j < static_cast<int>(rest.size()); ++j) {
      const std::array both{vertex[i], vertex[j]};
      served.block.model().compliance(both, patch);
      const auto block = served.model.compliance(i, j);
      REQUIRE(block);
      const Mat3 right = i == j ? patch.compliance.block<3, 3>(0, 0) : patch.compliance.block<3, 3>(0, 3);
      largest = std::max(largest, right.norm());
      worst = std::max(worst, (*block - right).norm());
    }
  }
  CHECK(worst < 1e-6 * largest);
}

TEST_CASE("surface model: the nearest pages first, none twice within 200 ms, again when they were lost") {
  Served served;
  Requested requested;
  REQUIRE(served.model.choose_missing({0, 0, 0}, 0.006, 1s, requested));
  const Requested first = requested;
  std::set<std::uint32_t> seen(first.begin(), first.end());
  while (served.model.choose_missing({0, 0, 0}, 0.006, 1100ms, requested)) {
    for (const std::uint32_t page : requested)
      CHECK((page == ToolState::kNoPage || seen.insert(page).second));
  }
  CHECK(served.model.choose_missing({0, 0, 0}, 0.006, 1201ms, requested));
  CHECK(requested == first);
  served.now = 2s;
  SurfacePage page;
  while (!served.model.has_shape()) {  // the shape alone
    served.model.choose_missing({0, 0, 0}, 0.006, served.now += 300ms, requested);
    for (const std::uint32_t number : requested) {
      if (served.pager.page(number, page)) served.model.take(page);
    }
  }
  REQUIRE(served.model.choose_missing({0.02, 0, 0.02}, 0.006, 60s, requested));
  const SurfacePages pages{served.pager.state().vertices, served.pager.state().triangles};
  const auto [a, b] = pages.clusters_of(requested[0]);
  REQUIRE(a == b);
  const Vec3 near = served.model.rest()[SurfacePages::kCluster * a];
  CHECK((near - Vec3(0.02, 0, 0.02)).norm() < 0.012);
}

TEST_CASE(
    "surface model: what is of another version, beyond its size or no number of a vertex is not taken") {
  Served served;
  served.fetch({0, 0, 0}, 1);
  const std::uint32_t version = served.model.version();
  SurfaceState other = served.pager.state();
  other.version ^= 2;
  served.model.announce(other);
  CHECK_FALSE(served.model.has_shape());
  SurfacePage page;
  served.pager.page(0, page);
  served.model.take(page);  // of the old version
  Requested requested;
  REQUIRE(served.model.choose_missing({0, 0, 0}, 0.006, 9s, requested));
  CHECK(requested[0] == 0);
  served.model.announce(served.pager.state());
  REQUIRE(served.model.version() == version);
  const SurfacePages pages{served.pager.state().vertices, served.pager.state().triangles};
  for (const float corner : {-1.0f, 1e9f, static_cast<float>(served.pager.state().vertices)}) {
    served.pager.page(pages.first_triangle_page(), page);
    page.values[4] = corner;
    served.model.take(page);
  }
  page.page = pages.count();
  served.model.take(page);
  CHECK(served.fetch({0, 0, 0}, 1) == static_cast<int>(pages.count()));
  other.vertices = SurfaceModel::kMostVertices + 1;
  other.version ^= 4;
  served.model.announce(other);
  CHECK(served.model.version() == 0);
  CHECK_FALSE(served.model.choose_missing({0, 0, 0}, 0.006, 99s, requested));
}

TEST_CASE("surface model: full, it forgets the oldest, it does not allocate") {
  SurfaceModel model;
  const SurfaceState state{.version = 3, .vertices = 2000, .triangles = 1, .tool_radius = 0.005};
  const SurfacePages pages{state.vertices, state.triangles};
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    model.announce(state);
    for (std::uint32_t page = 0; page < pages.first_tile() + SurfaceModel::kRoom + 2; ++page)
      model.take({.version = 3, .page = page, .values = {static_cast<float>(page)}});
    Requested requested;
    model.choose_missing({0, 0, 0}, 0.006, 1s, requested);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
  constexpr int kCluster = SurfacePages::kCluster;
  const auto known = [&](std::uint32_t tile) {
    const auto [a, b] = pages.clusters_of(pages.first_tile() + tile);
    return model.compliance(static_cast<int>(a) * kCluster, static_cast<int>(b) * kCluster);
  };
  CHECK_FALSE(known(0));
  CHECK_FALSE(known(1));
  REQUIRE(known(2));
  CHECK((*known(2))(0, 0) == pages.first_tile() + 2);
  CHECK(known(SurfaceModel::kRoom + 1));
}

TEST_CASE("surface model: what it forgot for want of room it asks for again where the tool comes back") {
  // 2000 vertices in a row, 1 mm apart, all of them within reach of each other: of the 400 clusters the
  // nearest 120 are wanted at a time, and there is room for 127.
  const SurfaceState state{.version = 3, .vertices = 2000, .triangles = 1, .tool_radius = 0.005};
  const SurfacePages pages{state.vertices, state.triangles};
  SurfaceModel model;
  model.announce(state);
  const auto answer = [&](std::uint32_t number) {
    SurfacePage page{.version = 3, .page = number, .values = {static_cast<float>(number)}};
    for (std::uint32_t i = 0; number < pages.first_triangle_page() && i < SurfacePages::kPerPage; ++i)
      page.values[3 * i] = 0.001F * static_cast<float>(SurfacePages::kPerPage * number + i);
    model.take(page);
  };
  Time now = 1s;
  const auto fetch = [&](double x) {
    std::size_t came = 0;
    for (Requested requested; came < 50000 && model.choose_missing({x, 0, 0}, 3, now += 300ms, requested);) {
      for (const std::uint32_t number : requested) {
        if (number == ToolState::kNoPage) continue;
        answer(number);
        ++came;
      }
    }
    return came;
  };
  constexpr std::size_t kPairs = 120 * 121 / 2;
  const auto known_at_first = [&] {
    std::size_t known = 0;
    for (int a = 0; a < 120; ++a) {
      for (int b = 0; b <= a; ++b) {
        const auto c = model.compliance(5 * a, 5 * b);
        const auto tile = pages.tile(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
        known += c && (*c)(0, 0) == tile ? 1 : 0;
      }
    }
    return known;
  };
  CHECK(fetch(0) == pages.first_tile() + kPairs);
  CHECK(known_at_first() == kPairs);
  CHECK(fetch(1) == kPairs);  // all of them new
  CHECK(known_at_first() == SurfaceModel::kRoom - kPairs);
  CHECK(fetch(0) == kPairs);  // what was left of the first was the oldest, and went first
  CHECK(known_at_first() == kPairs);
  CHECK(fetch(0) == 0);
}

TEST_CASE("surface model: a page that is known later is asked for again, but was not lost") {
  Served served;
  served.fetch(Vec3::Zero(), 0);  // the shape, and what is nearest
  const Vec3 far(0.02, 0, 0);
  SurfaceModel& model = served.model;
  Requested first, none, again;
  REQUIRE(model.choose_missing(far, 0.003, served.now += 8ms, first));
  for (const std::uint32_t number : first) {
    if (number == ToolState::kNoPage) continue;
    const auto waited = model.waited_for(number + SurfacePages::kNotYet, served.now + 5ms);
    CHECK(waited == 5ms);
    model.take({.version = model.version(), .page = number + SurfacePages::kNotYet});
  }
  CHECK(std::ranges::find(first, ToolState::kNoPage) == first.end());  // else what follows says little
  served.now += 150ms;
  if (model.choose_missing(far, 0.003, served.now, none))
    for (const std::uint32_t number : none) CHECK(std::ranges::find(first, number) == first.end());
  served.now += 100ms;
  REQUIRE(model.choose_missing(far, 0.003, served.now, again));
  CHECK(again == first);
  CHECK(model.requested_again() == 0);
  served.now += 250ms;  // nobody answers
  REQUIRE(model.choose_missing(far, 0.003, served.now, again));
  CHECK(model.requested_again() == first.size());
}
