#include "sim_server/simulation/setup_times.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace palpate::sim {

SetupTimes::SetupTimes(Progress report, Time (*clock)()) : report_(std::move(report)), clock_(clock) {}

void SetupTimes::operator()(std::string_view what, double fraction) {
  const Time t = clock_();
  if (!current_.empty()) stage(current_).took += t - last_;
  stage(what);
  current_ = what;
  last_ = t;
  if (report_) report_(what, fraction);
}

SetupTimes::Stage& SetupTimes::stage(std::string_view what) {
  const auto found = std::ranges::find_if(stages_, [&](const Stage& s) { return s.name == what; });
  if (found != stages_.end()) return *found;
  stages_.push_back({std::string(what), Time::zero()});
  return stages_.back();
}

Time SetupTimes::of(std::string_view what) const {
  for (const Stage& stage : stages_) {
    if (stage.name == what) return stage.took;
  }
  return Time::zero();
}

Time SetupTimes::total() const {
  Time sum = Time::zero();
  for (const Stage& stage : stages_) sum += stage.took;
  return sum;
}

Json SetupTimes::to_json() const {
  Json json = Json::object();
  for (const Stage& stage : stages_) json[stage.name] = 1e3 * to_seconds(stage.took);
  return json;
}

}  // namespace palpate::sim
