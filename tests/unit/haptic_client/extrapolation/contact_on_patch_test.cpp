// The contact that goes with the tool: where it gives no answer.
#include "haptic_client/extrapolation/contact_on_patch.h"

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/served_block.h"

using namespace palpate;
using namespace palpate::client;

namespace {

constexpr double kRadius = 0.002;
// It enters in at most 32 strides of 0.12 radii each, from where it just touches: the centre one radius
// above.
constexpr double kDeepest = (32 * 0.12 - 1) * kRadius;

/// The whole model of the block, and tools upon it.
struct OnBlock {
  OnBlock() {
    const sim::Simulation block(test::block_scene(), test::block_mesh());
    model.announce(sim::SurfacePager(block, 0).state());
    for (const protocol::SurfacePage& page : test::all_pages(block)) model.take(page);
    REQUIRE(model.has_shape());
  }
  Surface under(double radius, double friction = 0) const {
    return {.model = &model, .tool = {.radius = radius, .friction = friction}};
  }
  SurfaceModel model;
};

Vec3 below(double depth) {
  return {0.001, -depth, 0.0005};
}

}  // namespace

TEST_CASE(
    "contact on a patch: inside deeper than it enters in a tick there is no answer, and it stands nowhere") {
  const OnBlock block;
  for (const double friction : {0.0, 0.3}) {
    CAPTURE(friction);
    const Surface surface = block.under(kRadius, friction);
    ContactOnPatch contact, fresh;
    CHECK(contact.move_to(surface, below(-0.9 * kRadius)));
    for (const double deep : {kDeepest + 1e-6, 0.007, 0.0075}) {
      CHECK_FALSE(contact.move_to(surface, below(deep)));
      CHECK_FALSE(contact.probe(surface, below(deep)));
    }
    // From where it stood, or had got to, its path would be another.
    const Vec3 place(0.0013, 0.85 * kRadius, 0.0002);
    const auto force = contact.move_to(surface, place), right = fresh.move_to(surface, place);
    REQUIRE(force);
    REQUIRE(right);
    CHECK(right->norm() > 0.01);
    CHECK(*force == *right);
  }
}

TEST_CASE("contact on a patch: it enters as deep as that") {
  const OnBlock block;
  ContactOnPatch contact;
  const auto force = contact.move_to(block.under(kRadius), below(kDeepest - 1e-6));
  REQUIRE(force);
  CHECK((*force)[1] > 0.5);
}

TEST_CASE("contact on a patch: after a jump it enters anew, but with friction only at the next call") {
  const OnBlock block;
  const Vec3 place = below(-0.9 * kRadius), far = place + Vec3(2 * 16 * 0.12 * kRadius, 0, 0);
  for (const double friction : {0.0, 0.3}) {
    CAPTURE(friction);
    const Surface surface = block.under(kRadius, friction);
    ContactOnPatch contact, fresh;
    REQUIRE(contact.move_to(surface, place));
    const auto there = contact.move_to(surface, far), right = fresh.move_to(surface, far);
    REQUIRE(right);
    CHECK(right->norm() > 0.01);
    CHECK(there.has_value() == (friction == 0));
    CHECK(contact.move_to(surface, far) == right);
  }
}

TEST_CASE("contact on a patch: a tool tiny against its way returns without an answer") {
  const OnBlock block;
  for (const double radius : {1e-9, 1e-30, 1e-300, 5e-324, 0.0}) {
    CAPTURE(radius);
    ContactOnPatch contact;
    const Surface surface = block.under(radius);
    contact.move_to(surface, below(-0.001));
    CHECK_FALSE(contact.move_to(surface, below(0.004)));
    CHECK_FALSE(contact.probe(surface, below(0.004)));
    contact.move_to(surface, below(-0.001));
    CHECK_FALSE(contact.move_to(surface, below(0.004)));
  }
}

TEST_CASE(
    "contact on a patch: whatever the pages say, friction 10 and a wild compliance too, a call ends in "
    "time") {
  const sim::Simulation block(test::block_scene(), test::block_mesh());
  test::Random random(7);
  SurfaceModel model;
  model.announce(sim::SurfacePager(block, 0).state());
  const std::uint32_t tiles = sim::SurfacePager(block, 0).pages().first_tile();
  for (protocol::SurfacePage page : test::all_pages(block)) {
    if (page.page >= tiles) {
      for (float& value : page.values) value *= static_cast<float>(random.between(-3, 30));
    }
    model.take(page);
  }
  const Surface surface{.model = &model, .tool = {.radius = 0.005, .friction = 10}};
  ContactOnPatch contact;
  double most = 0;
  int unanswered = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 p(0.004 * std::sin(0.1 * i), 0.004 - 0.002 * std::sin(0.13 * i), 0.003 * std::cos(0.07 * i));
    unanswered += contact.move_to(surface, p) ? 0 : 1;
    most = std::max(most, contact.work());
  }
  CHECK(most <= ContactOnPatch::kMostWork);
  CHECK(most > 0.2 * ContactOnPatch::kMostWork);  // else this says nothing
  CHECK(unanswered > 0);
}

TEST_CASE("contact on a patch: at 1000 and 4000 Hz friction of 10 takes a quarter of a tick at most") {
  const OnBlock block;
  const Surface surface = block.under(0.005, 10);
  for (const double rate_hz : {1000.0, 4000.0}) {
    ContactOnPatch contact;
    double most = 0;
    for (int i = 0; i < 4000; ++i) {  // up to 0.2 m/s
      contact.bear(from_seconds(1 / rate_hz));
      const double angle = 50 / rate_hz * i;
      const Vec3 p(0.004 * std::sin(angle), 0.004 - 0.0025 * std::sin(0.73 * angle),
                   0.003 * std::cos(0.61 * angle));
      contact.move_to(surface, p);
      if (i > 100) most = std::max(most, contact.work());
    }
    CAPTURE(rate_hz, most);
    CHECK(most <= 1.01 * 2e9 * 0.25 / rate_hz);
    CHECK(most > 0.2 * 2e9 * 0.25 / rate_hz);  // else this says nothing
  }
}

TEST_CASE(
    "contact on a patch: friction of 10 takes no more of a tick than it bears, usual friction never so "
    "much") {
  // A quarter of 2 ms, at 2e9 multiplications a second.
  constexpr double kBearable = 1e6;
  const OnBlock block;
  for (const double friction : {0.3, 10.0}) {
    CAPTURE(friction);
    const Surface surface = block.under(0.005, friction);
    ContactOnPatch contact;
    double most = 0;
    int unanswered = 0;
    for (int i = 0; i < 4000; ++i) {  // up to 0.2 m/s, at 500 Hz
      const double angle = 0.1 * i;
      const Vec3 p(0.004 * std::sin(angle), 0.004 - 0.0025 * std::sin(0.73 * angle),
                   0.003 * std::cos(0.61 * angle));
      unanswered += contact.move_to(surface, p) ? 0 : 1;
      most = std::max(most, contact.work());
    }
    CAPTURE(most, unanswered);
    CHECK(most <= kBearable);
    if (friction < 1) {
      CHECK(unanswered == 0);
    } else {
      CHECK(unanswered > 0);  // else this says nothing
      CHECK(unanswered < 80);
    }
  }
}
