#include "sim_server/simulation/setup_times.h"

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;
using namespace std::chrono_literals;

namespace {
Time g_now;
Time published_time() {
  return g_now;
}
}  // namespace

TEST_CASE("set-up times: from one call to the next, counted for the stage that the first of them named") {
  int calls = 0;
  SetupTimes times([&](std::string_view, double) { ++calls; }, &published_time);
  g_now = 100ms;
  times("mesh", 0);
  g_now = 103ms;
  times("compliance", 0);
  g_now = 110ms;
  times("compliance", 0.5);
  g_now = 120ms;
  times("contact", 0);
  g_now = 125ms;
  times("contact", 1);
  g_now = 500ms;
  CHECK(times.of("mesh") == 3ms);
  CHECK(times.of("compliance") == 17ms);
  CHECK(times.of("contact") == 5ms);
  CHECK(times.of("nothing") == 0ms);
  CHECK(times.total() == 25ms);
  CHECK(calls == 5);
  CHECK(times.to_json().dump() == R"({"mesh":3.0,"compliance":17.0,"contact":5.0})");
}

TEST_CASE("set-up times: a stage that comes again goes on where it was") {
  SetupTimes times({}, &published_time);
  g_now = 0ms;
  times("a", 0);
  g_now = 1ms;
  times("b", 0);
  g_now = 3ms;
  times("a", 0);
  g_now = 7ms;
  times("a", 1);
  CHECK(times.of("a") == 5ms);
  CHECK(times.of("b") == 2ms);
  CHECK(times.stages().size() == 2);
}
