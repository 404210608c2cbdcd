#include "haptic_client/trace.h"

#include <fmt/format.h>
#include <iterator>

#include "common/report.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {

void write_trace(const std::filesystem::path& file, const std::vector<TickRecord>& ticks,
                 const std::vector<std::string>& laws) {
  std::string text = "t_s,px_m,py_m,pz_m,fx_n,fy_n,fz_n,sample_t_s,sample_n";
  std::vector<std::unique_ptr<Extrapolator>> shadows;
  for (const std::string& law : laws) {
    text += fmt::format(",{}_n", law);
    shadows.push_back(find_row(extrapolators(), law, "method", "trace").make());
  }
  text += '\n';
  const auto out = std::back_inserter(text);
  const Time start = ticks.empty() ? Time{} : ticks.front().t;
  Time newest{std::numeric_limits<Time::rep>::min()};
  for (const TickRecord& tick : ticks) {
    const Vec3 &p = tick.p_W, &f = tick.f_D;
    fmt::format_to(out, "{:.6f},{:.7f},{:.7f},{:.7f},{:.5f},{:.5f},{:.5f}", to_seconds(tick.t - start), p[0],
                   p[1], p[2], f[0], f[1], f[2]);
    const bool use = tick.fresh && tick.sample.t > newest;
    if (use) {
      newest = tick.sample.t;
      fmt::format_to(out, ",{:.6f},{:.5f}", to_seconds(newest - start), tick.sample.f.norm());
    } else {
      text += ",,";
    }
    for (const auto& law : shadows) {
      if (use) law->update(tick.sample);
      fmt::format_to(out, ",{:.5f}", law->force(p, tick.t).norm());
    }
    text += '\n';
  }
  write_whole(file, text);
}

}  // namespace palpate::client
