#include "sim_server/viewer/encoding.h"

#include <limits>

#include "tests/support/catch.h"
#include "tests/support/page_decoder.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// `n` vertices anywhere in a box of 0.2 m; triangles that mean nothing.
OrganShape scattered(int n, test::Random& random) {
  OrganShape organ;
  for (int v = 0; v < n; ++v) {
    organ.rest.push_back(random.vector(0.1));
    organ.flags.push_back(static_cast<std::uint8_t>(v % 4));
    if (v >= 2) organ.triangles.push_back({v, v - 1, v - 2});
  }
  return organ;
}

std::vector<float> floats_of(const std::vector<Vec3>& places) {
  std::vector<float> all;
  for (const Vec3& p : places) {
    for (int i = 0; i < 3; ++i) all.push_back(static_cast<float>(p[i]));
  }
  return all;
}

}  // namespace

TEST_CASE("viewer: the box holds the organ with half of its diagonal to each side") {
  const std::vector<Vec3> rest{{0, 0, 0}, {0.3, 0, 0.4}};
  const ViewBox box = view_box(rest);
  const double room = 0.25;
  CHECK(static_cast<double>(box.min[0]) == Approx(-room));
  CHECK(static_cast<double>(box.size[0]) == Approx(0.3 + 2 * room));
  CHECK(static_cast<double>(box.size[1]) == Approx(2 * room));
  CHECK(static_cast<double>(box.min[2] + box.size[2]) == Approx(0.4 + room));
  const ViewBox point = view_box(std::vector<Vec3>{{1, 2, 3}});
  CHECK(point.size[0] > 0);
}

TEST_CASE("viewer: 16 bits place a vertex to within half of a step, and outside of the box on its wall") {
  const ViewBox box{{-1, 0, 10}, {4, 1e-3F, 65535}};
  test::Random random(1);
  std::vector<float> places;
  for (int k = 0; k < 3000; ++k) {
    const auto i = static_cast<std::size_t>(k % 3);
    places.push_back(static_cast<float>(
        random.between(static_cast<double>(box.min[i]), static_cast<double>(box.min[i] + box.size[i]))));
  }
  std::vector<std::uint16_t> q(places.size());
  quantise(box, places, q);
  for (std::size_t k = 0; k < q.size(); ++k) {
    const double size = static_cast<double>(box.size[k % 3]);
    const double back = static_cast<double>(box.min[k % 3]) + size * q[k] / 65535;
    REQUIRE(std::abs(back - static_cast<double>(places[k])) <= size / 65535 / 2 * (1 + 1e-6));
  }
  constexpr float kInfinite = std::numeric_limits<float>::infinity(),
                  kNone = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> outside{-2, 1, kInfinite, 3.5F, -kInfinite, kNone};
  q.resize(6);
  quantise(box, outside, q);
  CHECK(q == std::vector<std::uint16_t>{0, 65535, 65535, 65535, 0, 0});
}

TEST_CASE("viewer: what moved, added up by another decoder, is the whole surface") {
  test::Random random(2);
  const OrganShape organ = scattered(50, random);
  const ViewBox box = view_box(organ.rest);
  test::PageDecoder page;
  Bytes message;
  write_topology(organ, box, 7, message);
  page.take(message);
  CHECK(page.version == 7);
  CHECK(page.triangles == 48);
  CHECK(page.corners[3] == 3);
  CHECK(page.flags == organ.flags);
  CHECK(page.rest == floats_of(organ.rest));

  std::vector<Vec3> places = organ.rest;
  std::vector<std::uint16_t> now(150), had(150);
  std::size_t named = 0;
  for (std::uint32_t step = 0; step < 40; ++step) {
    const auto moving = static_cast<std::size_t>(step == 0 ? 50 : step % 20);
    for (std::size_t k = 0; step > 0 && k < moving; ++k) places[k * 2] += random.vector(0.01);
    quantise(box, floats_of(places), now);
    write_surface({7, step, 0.5 * step}, now, had, step == 0, message);
    page.take(message);
    named += moving;
    CHECK(page.step == step);
    CHECK(page.t == 0.5 * step);
    CHECK(message.size() == 28 + (step == 0 ? 50 * 6 : moving * 10));
    for (std::size_t v = 0; v < places.size(); ++v) {
      for (std::size_t i = 0; i < 3; ++i) {
        const double half = static_cast<double>(box.size[i]) / 65535 / 2;
        REQUIRE(std::abs(page.positions[3 * v + i] - places[v][static_cast<int>(i)]) <= half + 1e-7);
      }
    }
  }
  CHECK(page.named == named);
  CHECK(page.entire_ones == 1);
}

TEST_CASE("viewer: where most of it moved, the whole is shorter than what moved") {
  std::vector<std::uint16_t> had(30), now(30);
  const auto size_of = [&](int moved) {
    for (int v = 0; v < 10; ++v) now[3 * v + 1] = v < moved ? had[3 * v + 1] + 1 : had[3 * v + 1];
    Bytes message;
    std::vector<std::uint16_t> copy = had;
    write_surface({1, 1, 0}, now, copy, false, message);
    CHECK(copy == now);
    return message.size() - 28;
  };
  CHECK(size_of(0) == 0);
  CHECK(size_of(1) == 10);
  CHECK(size_of(5) == 50);
  CHECK(size_of(6) == 60);
  CHECK(size_of(10) == 60);
}

TEST_CASE("viewer: a field is told as shares of its largest value") {
  Bytes message;
  const std::vector<float> values{0, 2, 4, 1};
  write_field(3, values, message);
  REQUIRE(message.size() == 4 + 12 + 4);
  const auto byte = [&](std::size_t i) { return std::to_integer<int>(message[i]); };
  CHECK(byte(0) == 5);
  CHECK(byte(1) == 1);
  CHECK(byte(4) == 3);
  CHECK(byte(8) == 4);
  CHECK(byte(16) == 0);
  CHECK(byte(17) == 128);
  CHECK(byte(18) == 255);
  CHECK(byte(19) == 64);
  write_field(3, std::vector<float>{0, 0}, message);
  CHECK(byte(16) == 0);
}

TEST_CASE("viewer: ticks of a client, a row of laws for each") {
  ClientTicks ticks{.tool = 1, .laws = 2, .count = 3, .t = 1.5, .dt = 0.002F};
  for (std::size_t k = 0; k < 3; ++k) {
    ticks.rendered[k] = static_cast<float>(k);
    ticks.by_law[k][1] = static_cast<float>(10 + k);
  }
  Bytes message;
  write_ticks(ticks, message);
  REQUIRE(message.size() == 4 + 4 + 8 + 4 + 4 * 3 + 4 * 6);
  float last = 0;
  std::memcpy(&last, message.data() + message.size() - 4, 4);
  CHECK(last == 12);
}
