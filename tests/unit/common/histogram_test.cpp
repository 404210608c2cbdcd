#include "common/histogram.h"

#include "tests/support/catch.h"

using palpate::Histogram;

TEST_CASE("a histogram's quantiles are those of the counts within 0.4 %") {
  Histogram h;
  for (int i = 1; i <= 100000; ++i) h.add(i);
  CHECK(h.count() == 100000);
  CHECK(h.max() == 100000);
  CHECK(h.mean() == Approx(50000.5));
  for (const double q : {0.01, 0.5, 0.9, 0.99, 0.999})
    CHECK(h.quantile(q) == Approx(100000 * q).epsilon(0.004));
  CHECK(h.quantile(1) == Approx(100000).epsilon(0.004));
}

TEST_CASE("small counts are exact, negative ones count as zero, huge ones stay finite") {
  Histogram h;
  CHECK(h.quantile(0.5) == 0);
  h.add(-5);
  h.add(3);
  h.add(17);
  CHECK(h.quantile(0.5) == 3);
  CHECK(h.quantile(0.01) == 0);
  h.add(std::numeric_limits<std::int64_t>::max());
  CHECK(h.max() == std::numeric_limits<std::int64_t>::max());
  CHECK(h.quantile(1) > 1e13);
}
