// What the headline of a client's report says of the age of its force.
#include <nlohmann/json.hpp>

#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "haptic_client/session/whole_error.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

namespace {

/// A tool's report with 25 samples and 500 ticks a second: 40 + 2 ms of the age are waits.
Json report_of(double age_p50, double age_p99, bool real_time) {
  return {{"motion", {{"sample_rate_hz", 25}}},
          {"force", {{"age_ms", {{"p50", age_p50}, {"p99", age_p99}}}}},
          {"loop", {{"rate_hz", 500}, {"real_time", real_time}}}};
}

}  // namespace

TEST_CASE("report: an age that the rates do not explain is told where threads had no real-time priority") {
  CHECK_FALSE(unexplained_age_ms(report_of(30, 71.9, false)));
  CHECK(unexplained_age_ms(report_of(30, 72.1, false)) == 72.1);
  CHECK_FALSE(unexplained_age_ms(report_of(30, 72.1, true)));
  Json replayed = report_of(30, 100, false);
  replayed.erase("loop");
  CHECK_FALSE(unexplained_age_ms(replayed));
  Json without_samples = report_of(0, 100, false);
  without_samples["motion"]["sample_rate_hz"] = 0;
  CHECK_FALSE(unexplained_age_ms(without_samples));
}

TEST_CASE("report and page name the same parts of the error on the hand") {
  std::vector<std::string> names, keys;
  for (const HandError& error : kHandErrors) names.emplace_back(error.name), keys.emplace_back(error.key);
  CHECK(names == std::vector<std::string>{"", "extrapolation", "outages", "fades", "limits", "worst tick"});
  CHECK(keys == std::vector<std::string>{"total_percent", "extrapolation_percent", "outages_percent",
                                         "fades_percent", "limits_percent", "hand_max_percent"});
}

TEST_CASE("report: a total of which the mesh's share is not known says so after what is known") {
  CHECK(total_text({{"total_percent", 5.9}, {"hand_percent", 0.4}}) ==
        "at most 5.9 % of its root mean square in the mean");
  CHECK(
      total_text({{"total_percent", nullptr}, {"hand_percent", 18}}) ==
      "18 % of its root mean square in the mean, and what mesh and time step add to it, which is not known");
}

TEST_CASE("report: how the mesh's share is known is told of each source, with the command that measures it") {
  const auto how = [](const DiscretisationErrors& errors) {
    Pipeline pipeline(find_row(extrapolators(), "constant", "law", "test").make(), {}, {});
    Observation observation({"constant"}, 500, "test", Workspace{}, 0);
    for (std::uint64_t tick = 1; tick <= 10; ++tick) {
      const Time t = from_seconds(1 + 0.002 * static_cast<double>(tick));
      protocol::ForceSample sample{.number = tick, .tool_t_ns = t.count(), .f_W = {0, 1, 0}};
      sample.flags = protocol::ForceSample::kHasErrors;
      sample.errors = errors;
      observation.tick(pipeline.tick({.t = t}, &sample), Time::zero(), 0);
    }
    return whole_error_report(observation)["how"];
  };
  const Json estimated = how({{ErrorSource::kEstimated, 30}, {ErrorSource::kMeasured, 2}});
  CHECK(estimated["mesh"] ==
        "estimated, by elements to a radius of the tool or by presses on linear and quadratic ones; "
        "`sim_server study SCENE --out DIR` measures it");
  CHECK(estimated["motion"] ==
        "measured by a study of this scene, within a radius of the tool of where it pressed");
  const Json none = how({{ErrorSource::kNone, 0}, {ErrorSource::kNone, 0}});
  CHECK(none["mesh"] == "none: this tissue has no mesh");
  CHECK(none["motion"] == "none: the force follows from the place of the tool alone");
  CHECK(how({})["mesh"] == "unknown: nobody has measured it; `sim_server study SCENE --out DIR` does");
}
