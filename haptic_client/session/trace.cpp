#include "haptic_client/session/trace.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

#include "common/error.h"

namespace palpate::client {
namespace {
constexpr std::size_t kFlushAt = 1 << 16;  // bytes
}

TraceWriter::TraceWriter(const std::filesystem::path& file, const std::vector<std::string>& laws)
    : name_(file), file_(file, Contents::kTable), out_(file_.path(), std::ios::binary), laws_(laws.size()) {
  text_ =
      "tick,t_s,px_m,py_m,pz_m,fx_n,fy_n,fz_n,sample,sample_t_s,sample_n,flagged,mesh_percent,motion_percent,"
      "reference_n,extrapolation_n,error_n";
  for (const std::string& law : laws) text_ += fmt::format(",{}_n", law);
  text_ += '\n';
}

void TraceWriter::add(const TickRecord& tick) {
  const TickResult& result = tick.result;
  const Time t{result.tool.t_ns};
  if (!start_) start_ = t;
  const Vec3 &p = result.tool.p_W, &f = result.f_D;
  const auto out = std::back_inserter(text_);
  fmt::format_to(out, "{},{:.9f},{},{},{},{},{},{},{}", result.tool.tick, to_seconds(t - *start_), p[0], p[1],
                 p[2], f[0], f[1], f[2], result.tool.newest_sample);
  if (result.used) {
    fmt::format_to(out, ",{:.9f},{},{}", to_seconds(result.sample.t - *start_), result.sample.f.norm(),
                   result.flagged ? 1 : 0);
  } else {
    text_ += ",,,";
  }
  const DiscretisationErrors errors = result.errors.value_or(DiscretisationErrors{});
  add_error(errors.mesh);
  add_error(errors.time_step);
  add_errors(tick);
  for (std::size_t i = 0; i < laws_; ++i) fmt::format_to(out, ",{}", tick.laws[i].norm());
  text_ += '\n';
  if (text_.size() >= kFlushAt) flush();
}

/// Empty where it is unknown.
void TraceWriter::add_error(const DiscretisationError& error) {
  text_ += ',';
  if (error.known()) fmt::format_to(std::back_inserter(text_), "{}", error.percent);
}

/// The reference force, the error of the rendered law, and that of the force on the hand; empty where nobody
/// could know.
void TraceWriter::add_errors(const TickRecord& tick) {
  const auto out = std::back_inserter(text_);
  text_ += ',';
  if (tick.reference) fmt::format_to(out, "{}", tick.reference->norm());
  text_ += ',';
  if (tick.reference) fmt::format_to(out, "{}", (tick.result.law_W - *tick.reference).norm());
  text_ += ',';
  if (tick.reference && tick.written_W) fmt::format_to(out, "{}", (*tick.written_W - *tick.reference).norm());
}

void TraceWriter::flush() {
  out_ << text_;
  text_.clear();
}

void TraceWriter::finish() {
  flush();
  out_.close();
  if (!out_) fail_at_run_time("{}: could not be written; is the disk full?", name_.string());
  file_.commit();
}

}  // namespace palpate::client
