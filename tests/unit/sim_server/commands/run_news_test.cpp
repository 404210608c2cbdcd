#include "sim_server/commands/run_news.h"

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("run: a report says that forces may be older where the server had no real-time priority") {
  CHECK_THAT(real_time_text({{"real_time", false}}),
             Catch::Contains("make the force older") && Catch::Contains("`ulimit -r`"));
  CHECK(real_time_text({{"real_time", true}}).empty());
}
