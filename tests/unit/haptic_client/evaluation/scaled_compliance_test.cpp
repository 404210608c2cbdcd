#include "haptic_client/evaluation/scaled_compliance.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using protocol::SurfacePage;
using protocol::SurfacePages;

TEST_CASE("a surface published as twice as compliant: tiles are doubled, modes slower by the root of two") {
  const SurfacePages pages{.vertices = 12, .triangles = 20, .modes = 16};
  const auto published = [&](std::uint32_t number) {
    SurfacePage page{.page = number};
    page.values.fill(3.0F);
    return with_scaled_compliance(page, pages, 2).values;
  };
  const std::uint32_t tiles = pages.first_tile(), spectrum = pages.spectrum();
  REQUIRE(spectrum - tiles == 6);  // three clusters
  for (std::uint32_t number = 0; number < pages.count(); ++number) {
    CAPTURE(number);
    const auto values = published(number);
    const bool is_tile = number >= tiles && number < spectrum;
    CHECK(values[1] == (is_tile ? 6.0F : 3.0F));
    CHECK(values[0] == Approx(is_tile ? 6 : number == spectrum ? 3 / std::sqrt(2.0) : 3));
    CHECK(values[3] == values[0]);
  }
}
