// What every extrapolation law must do, row by row of the registry.
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;

TEST_CASE("contract: every extrapolation law") {
  for (const ExtrapolatorRow& row : extrapolators()) {
    DYNAMIC_SECTION(row.name) {
      const auto law = row.make();
      SECTION("no force before the first sample") {
        CHECK(law->force({0.1, 0.2, 0.3}, Time{5}) == Vec3::Zero());
      }
      SECTION("at the sample itself, its force") {
        test::Random random(10);
        for (int n = 1; n <= 50; ++n) {
          const Sample sample{static_cast<std::uint64_t>(n), Time{n * 33'000'000}, random.vector(0.01),
                              random.vector(2)};
          law->update(sample);
          CHECK((law->force(sample.p, sample.t) - sample.f).norm() < 1e-12);
        }
      }
      SECTION("a constant force stays constant, wherever and whenever") {
        test::Random random(11);
        for (int n = 1; n <= 10; ++n) {
          law->update({static_cast<std::uint64_t>(n), Time{n * 33'000'000}, random.vector(0.01), {1, -2, 3}});
        }
        CHECK((law->force(random.vector(0.01), Time{350'000'000}) - Vec3(1, -2, 3)).norm() < 1e-12);
      }
      SECTION("it does not allocate") {
        std::size_t allocations = 1;
        {
          const test::AllocationGuard guard;
          law->update({1, Time{0}, {0, 0, 0}, {0, 1, 0}});
          law->update({2, Time{33'000'000}, {0.001, 0, 0}, {0, 2, 0}});
          law->force({0.002, 0, 0}, Time{40'000'000});
          allocations = guard.count();
        }
        CHECK(allocations == 0);
      }
    }
  }
}
