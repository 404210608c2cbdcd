#include "haptic_client/extrapolation/page_slots.h"

#include <map>
#include <random>

#include "haptic_client/extrapolation/surface_model.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

TEST_CASE("page slots: whatever comes and goes, each page is found in its slot, as in a map") {
  constexpr std::size_t kSlots = 24;  // pages collide
  PageSlots slots(kSlots);
  std::map<std::uint32_t, std::uint16_t> right;
  std::mt19937 random(3);
  for (int turn = 0; turn < 20000; ++turn) {
    const std::uint32_t page = 1 + static_cast<std::uint32_t>(random() % 60);
    if (right.contains(page)) {
      slots.erase(page);
      right.erase(page);
    } else if (right.size() < kSlots) {
      right[page] = static_cast<std::uint16_t>(random() % 1000);
      slots.put(page, right[page]);
    }
    for (std::uint32_t p = 1; p <= 60; ++p)
      if (slots.find(p) != (right.contains(p) ? right[p] : PageSlots::kNone)) FAIL(turn);
  }
  slots.clear();
  for (std::uint32_t p = 1; p <= 60; ++p) CHECK(slots.find(p) == PageSlots::kNone);
}

TEST_CASE("surface model: of the largest surface that a server offers, it keeps what is near the tool") {
  // A strip of 10 000 by 2 vertices, 1 mm apart; compliance 1 m/N along x of each vertex with itself.
  const protocol::SurfaceState state{
      .version = 5, .vertices = 20000, .triangles = 19998, .tool_radius = 0.005};
  const protocol::SurfacePages pages{state.vertices, state.triangles};
  SurfaceModel model;
  model.announce(state);
  const auto answer = [&](std::uint32_t number) {
    protocol::SurfacePage page{.version = 5, .page = number};
    for (std::uint32_t i = 0; i < protocol::SurfacePages::kPerPage; ++i) {
      const bool positions = number < pages.first_triangle_page();
      const std::uint32_t n =
          (positions ? number : number - pages.first_triangle_page()) * protocol::SurfacePages::kPerPage + i;
      if (number >= pages.first_tile()) break;
      if (positions && n < state.vertices) page.values[3 * i] = 1e-3F * static_cast<float>(n / 2);
      if (positions && n % 2 == 1) page.values[3 * i + 2] = 1e-3F;
      for (std::uint32_t c = 0; !positions && n < state.triangles && c < 3; ++c)
        page.values[3 * i + c] = static_cast<float>(n + c);
    }
    if (number >= pages.first_tile()) page.values[0] = static_cast<float>(number % 1000);
    model.take(page);
  };
  const auto fetch = [&](const Vec3& p) {
    std::array<std::uint32_t, 8> requested;
    for (int round = 0; model.choose_missing(p, 0.015, std::chrono::seconds(1 + round), requested); ++round) {
      for (const std::uint32_t page : requested)
        if (page != protocol::ToolState::kNoPage) answer(page);
      REQUIRE(round < 3000);
    }
  };
  for (const int at : {9000, 100, 9900}) {  // mm
    fetch({1e-3 * at, 0, 0});
    REQUIRE(model.has_shape());
    CHECK(model.longest_edge() == Approx(std::sqrt(2.0) * 1e-3).epsilon(1e-3));
    const int vertex = 2 * at / 5 * 5, near = vertex + 20;
    REQUIRE(model.compliance(vertex, near));
    const std::uint32_t tile =
        pages.tile(static_cast<std::uint32_t>(vertex) / 5, static_cast<std::uint32_t>(near) / 5);
    CHECK((*model.compliance(near, vertex))(0, 0) == tile % 1000);
    CHECK_FALSE(model.compliance(10000, 10000));
  }
}
