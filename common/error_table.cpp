#include "common/error_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/perception.h"

namespace palpate {
namespace {

constexpr double kRoughHz = 30;                          // of the high-pass: SCORES.md, rough_percent
constexpr double kFloor = 0.1;                           // of the peak
constexpr Time kWindow = std::chrono::milliseconds(10);  // what a hand resolves at 100 Hz
constexpr double kLeastWindowTicks = 2;                  // fewer have no mean
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr ErrorSizes kNoSizes{kNone, kNone, kNone, kNone, kNone};

}  // namespace

Json to_json(const ErrorSizes& sizes, const std::string& of) {
  return {{"mean" + of + "_percent", sizes.mean_percent},
          {"p99" + of + "_percent", sizes.p99_percent},
          {"max" + of + "_percent", sizes.max_percent},
          {"p99" + of + "_of_rms_percent", sizes.p99_of_rms_percent},
          {"max" + of + "_of_rms_percent", sizes.max_of_rms_percent}};
}

Json to_json(const ErrorMetrics& m) {
  Json json = to_json(static_cast<const ErrorSizes&>(m));
  json.update(to_json(m.mean_10ms, "_10ms"));
  json.update({{"overshoot_percent", m.overshoot_percent},
               {"jump_percent", m.jump_percent},
               {"rough_percent", m.rough_percent},
               {"exceed_percent", m.exceed_percent},
               {"paper_mean_percent", m.paper_mean_percent},
               {"paper_max_percent", m.paper_max_percent},
               {"paper_max_force_percent", m.paper_max_force_percent}});
  return json;
}

ReferenceForce::ReferenceForce(const Vec3& force, Time t)
    : f(force), norm(force.norm()), bin(ErrorTable::bin_of(norm)), window(t / kWindow) {}

void ErrorTable::Spread::add(double newton) noexcept {
  ++count;
  sum += newton;
  max = std::max(max, newton);
  nN.add(static_cast<std::int64_t>(std::min(newton, 1e9) * 1e9));
}

ErrorSizes ErrorTable::Spread::of(double peak, double rms) const noexcept {
  if (count == 0) return kNoSizes;
  const double p99 = nN.quantile(0.99) * 1e-9;
  return {.mean_percent = 100 * (sum / count) / rms,
          .p99_percent = 100 * p99 / peak,
          .max_percent = 100 * max / peak,
          .p99_of_rms_percent = 100 * p99 / rms,
          .max_of_rms_percent = 100 * max / rms};
}

int ErrorTable::bin_of(double newton) noexcept {
  if (newton <= kSmallest) return 0;
  return std::min(static_cast<int>(kPerOctave * std::log2(newton / kSmallest)), kBins - 1);
}

ErrorTable::ErrorTable(double rate_hz) : has_windows_(rate_hz * to_seconds(kWindow) >= kLeastWindowTicks) {
  if (rate_hz <= 2 * kRoughHz) rough_squared_ = kNone;  // no filter does that
  const double w = std::tan(std::numbers::pi * kRoughHz / rate_hz), root = std::numbers::sqrt2 * w;
  b0_ = 1 / (1 + root + w * w);
  a1_ = 2 * (w * w - 1) * b0_;
  a2_ = (1 - root + w * w) * b0_;
}

void ErrorTable::add(const Vec3& force, const ReferenceForce& reference) noexcept {
  const Vec3 e = force - reference.f;
  ++ticks_;
  rough_squared_ += high_pass(e).squaredNorm();
  const double size = force.norm();
  const bool pushes = reference.norm > 0 || size > 0;
  if (has_windows_) add_to_window(e, pushes, reference.window);
  if (!pushes) return;
  const double error = e.norm();
  errors_.add(error);
  force_max_ = std::max(force_max_, size);
  peak_ = std::max(peak_, reference.norm);
  exceed_ += error > kNoticedForce * std::max(reference.norm, kFloor * peak_) ? 1 : 0;
  if (reference.norm == 0) return;
  ++contact_;
  reference_squared_ += reference.norm * reference.norm;
  Bin& bin = bins_[static_cast<std::size_t>(reference.bin)];
  ++bin.count;
  bin.error_sum += error;
  bin.error_max = std::max(bin.error_max, error);
  bin.force_max = std::max(bin.force_max, size);
  bin.error_ratio_sum += error / reference.norm;
  bin.error_ratio_max = std::max(bin.error_ratio_max, error / reference.norm);
  bin.force_ratio_max = std::max(bin.force_ratio_max, size / reference.norm);
}

/// Closes the window before where `number` is that of another.
void ErrorTable::add_to_window(const Vec3& e, bool pushes, std::int64_t number) noexcept {
  if (window_.number != number) {
    if (window_.pushes) window_errors_.add(window_.error_sum.norm() / window_.ticks);
    window_ = {.number = number};
  }
  ++window_.ticks;
  window_.pushes = window_.pushes || pushes;
  window_.error_sum += e;
}

/// Direct form II, transposed.
Vec3 ErrorTable::high_pass(const Vec3& e) noexcept {
  const Vec3 out = b0_ * e + z1_;
  z1_ = -2 * b0_ * e - a1_ * out + z2_;
  z2_ = b0_ * e - a2_ * out;
  return out;
}

ErrorTable::Paper ErrorTable::paper(double floor) const noexcept {
  Paper sums;
  const auto border = static_cast<std::size_t>(bin_of(floor));
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    const Bin& bin = bins_[i];
    if (bin.count == 0) continue;
    const bool small = i < border;
    sums.mean += small ? bin.error_sum / floor : bin.error_ratio_sum;
    sums.max = std::max(sums.max, small ? bin.error_max / floor : bin.error_ratio_max);
    sums.max_force = std::max(sums.max_force, small ? bin.force_max / floor : bin.force_ratio_max);
  }
  sums.mean /= contact_;
  return sums;
}

ErrorMetrics ErrorTable::metrics() const noexcept {
  ErrorMetrics m;
  if (contact_ == 0 || peak_ == 0) {
    return {kNoSizes, kNone, kNone, kNone, kNone, kNoSizes, kNone, kNone, kNone};
  }
  const double rms = std::sqrt(reference_squared_ / contact_);
  static_cast<ErrorSizes&>(m) = errors_.of(peak_, rms);
  m.mean_10ms = window_errors_.of(peak_, rms);
  m.overshoot_percent = 100 * std::max(force_max_ / peak_ - 1, 0.0);
  m.exceed_percent = 100 * exceed_ / errors_.count;
  m.jump_percent = 100 * jump_ / peak_;
  m.rough_percent = 100 * std::sqrt(rough_squared_ / ticks_) / peak_;
  const Paper p = paper(kFloor * peak_);
  m.paper_mean_percent = 100 * p.mean;
  m.paper_max_percent = 100 * p.max;
  m.paper_max_force_percent = 100 * p.max_force;
  return m;
}

}  // namespace palpate
