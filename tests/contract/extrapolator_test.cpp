// What every extrapolation law must do, row by row of the registry.
#include <array>
#include <limits>

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
          if (row.exact) CHECK((law->force(sample.p, sample.t) - sample.f).norm() < 1e-12);
        }
      }
      SECTION("a constant force stays constant, wherever and whenever") {
        test::Random random(11);
        for (int n = 1; n <= 10; ++n) {
          law->update({static_cast<std::uint64_t>(n), Time{n * 33'000'000}, random.vector(0.01), {1, -2, 3}});
        }
        CHECK((law->force(random.vector(0.01), Time{350'000'000}) - Vec3(1, -2, 3)).norm() < 1e-12);
      }
      SECTION("whatever it is given, the answer is finite") {
        constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
        const std::array wild{0.0, 1e-12, -0.001, 1e30, -1e30, kNan, std::numeric_limits<double>::infinity()};
        const std::array<std::int64_t, 5> times{0, 1, 33'000'000, 33'000'000, std::int64_t{1} << 61};
        test::Random random(12);
        const auto any = [&] { return wild[static_cast<std::size_t>(random.between(0, 6.999))]; };
        for (int n = 1; n <= 5000; ++n) {
          const Sample sample{static_cast<std::uint64_t>(n),
                              Time{times[static_cast<std::size_t>(random.between(0, 4.999))]},
                              {any(), any(), any()},
                              {any(), any(), any()}};
          law->update(sample);
          if (n % 3 == 0) law->update(sample);  // again: same time, same place
          CHECK(law->force({any(), any(), any()}, sample.t).allFinite());
          CHECK(law->force(sample.p, sample.t + Time{2'000'000}).allFinite());
        }
      }
      SECTION("a sample that is not finite changes nothing, one that comes again neither") {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        law->update({1, Time{0}, {0, 0, 0}, {0, 1, 0}});
        law->update({2, Time{33'000'000}, {0.001, 0, 0}, {0, 2, 0}});
        const Vec3 p(0.0015, 0, 0);
        const Vec3 before = law->force(p, Time{40'000'000});
        law->update({3, Time{66'000'000}, {nan, 0, 0}, {0, 3, 0}});
        law->update({4, Time{66'000'000}, {0, 0, 0}, {0, 3, nan}});
        law->update({2, Time{33'000'000}, {0.001, 0, 0}, {0, 2, 0}});
        CHECK(law->force(p, Time{40'000'000}) == before);
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
