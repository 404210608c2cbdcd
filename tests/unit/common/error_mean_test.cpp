#include "common/error_mean.h"

#include "tests/support/catch.h"

using namespace palpate;

TEST_CASE("error means: a mean by the size of the force, with the source of most of it, unknown left out") {
  ErrorMeans errors;
  CHECK_FALSE(errors.mean().mesh.known());
  errors.add({{ErrorSource::kEstimated, 4}, {ErrorSource::kUnknown, 0}}, 3);
  errors.add({{ErrorSource::kUnknown, 0}, {ErrorSource::kUnknown, 0}}, 100);
  errors.add({{ErrorSource::kMeasured, 8}, {ErrorSource::kNone, 0}}, 1);
  const DiscretisationErrors mean = errors.mean();
  CHECK(mean.mesh.percent == 5);  // (3 x 4 + 1 x 8) / 4
  CHECK(mean.mesh.source == ErrorSource::kEstimated);
  CHECK(mean.time_step.source == ErrorSource::kNone);
  CHECK(mean.time_step.percent == 0);
}
