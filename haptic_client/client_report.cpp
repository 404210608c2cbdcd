#include "haptic_client/client_report.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace palpate::client {

const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kNotFinite:
      return "a force was not finite";
    case Fault::kStorm:
      return "the force oscillated against the slew limit";
    case Fault::kDeviceLost:
      return "the device was lost";
  }
  return "unknown";
}

Json make_report(const ClientConfig& config, const HapticLoop& loop, const Pipeline& pipeline,
                 const NetLink& link) {
  const HapticLoopStats& ticks = loop.stats();
  const PipelineStats& stats = pipeline.stats();
  const LimiterCounts& limiter = pipeline.limiter().counts();
  const protocol::LinkStats& net = link.stats();
  const auto per = [](double sum, double count) { return count > 0 ? sum / count : 0; };
  const Json tool = {
      {"device", config.device.name},
      {"method", config.method},
      {"loop",
       {{"rate_hz", config.rate_hz},
        {"ticks", ticks.ticks},
        {"missed", ticks.missed},
        {"period_us", quantiles(ticks.period_ns, 1e3)},
        {"tick_us", quantiles(ticks.tick_ns, 1e3)}}},
      {"force",
       {{"samples", stats.samples},
        {"overtaken", stats.overtaken},
        {"age_ms", quantiles(stats.age_ns, 1e6)},
        {"max_newton", stats.max_newton}}},
      {"motion",
       {{"mean_speed_m_s", per(stats.path_m, stats.path_s)},
        {"max_speed_m_s", stats.max_speed},
        {"spatial_sampling_mm", 1e3 * per(stats.sample_path_m, static_cast<double>(stats.sample_pairs))}}},
      {"safety",
       {{"clamped", limiter.clamped},
        {"slewed", limiter.slewed},
        {"ramped", pipeline.watchdog().ramped()},
        {"latched", limiter.latched}}}};
  return {{"server", config.server},
          {"tools", Json::array({tool})},
          {"link",
           {{"sent", net.sent},
            {"received", net.received},
            {"lost", net.lost},
            {"reordered", net.reordered},
            {"duplicated", net.duplicated},
            {"rejected", net.rejected}}}};
}

void print_report(const Json& report) {
  const Json& tool = report["tools"][0];
  const auto number = [](const Json& group, const char* key) { return group[key].get<double>(); };
  const Json &loop = tool["loop"], &force = tool["force"], &motion = tool["motion"], &safety = tool["safety"];
  const Json &link = report["link"], &age = force["age_ms"], &period = loop["period_us"],
             &tick = loop["tick_us"];
  const double due = number(loop, "ticks") + number(loop, "missed");
  fmt::print("haptic_client: {} with {}\n", tool["device"].get<std::string>(),
             tool["method"].get<std::string>());
  fmt::print(
      "  loop    {:g} Hz, {:.0f} ticks, {:.0f} missed ({:.2f} % on time); period {:.0f} us (p50), {:.0f} "
      "(p99), "
      "{:.0f} (max); a tick takes {:.1f} us (p50), {:.1f} (p99)\n",
      number(loop, "rate_hz"), number(loop, "ticks"), number(loop, "missed"),
      due > 0 ? 100 * number(loop, "ticks") / due : 0, number(period, "p50"), number(period, "p99"),
      number(period, "max"), number(tick, "p50"), number(tick, "p99"));
  fmt::print(
      "  force   {:.0f} samples, age {:.1f} ms (p50), {:.1f} (p99), {:.1f} (max); largest force {:.2f} N\n",
      number(force, "samples"), number(age, "p50"), number(age, "p99"), number(age, "max"),
      number(force, "max_newton"));
  fmt::print("  motion  {:.4f} m/s mean, {:.4f} max; {:.2f} mm between samples\n",
             number(motion, "mean_speed_m_s"), number(motion, "max_speed_m_s"),
             number(motion, "spatial_sampling_mm"));
  fmt::print("  safety  {:.0f} ticks clamped, {:.0f} slewed; {:.0f} fades, {:.0f} latched faults\n",
             number(safety, "clamped"), number(safety, "slewed"), number(safety, "ramped"),
             number(safety, "latched"));
  fmt::print(
      "  link    {:.0f} sent, {:.0f} received, {:.0f} lost, {:.0f} reordered, {:.0f} duplicated, {:.0f} "
      "rejected\n",
      number(link, "sent"), number(link, "received"), number(link, "lost"), number(link, "reordered"),
      number(link, "duplicated"), number(link, "rejected"));
  std::fflush(stdout);
}

}  // namespace palpate::client
