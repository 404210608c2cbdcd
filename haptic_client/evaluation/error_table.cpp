#include "haptic_client/evaluation/error_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

namespace palpate::client {
namespace {

constexpr double kRoughHz = 30;
constexpr double kNoticed = 0.1;  // of the force: about the smallest difference a hand can tell
constexpr double kFloor = 0.1;    // of the peak

}  // namespace

Json to_json(const ErrorMetrics& m) {
  return {{"mean_percent", m.mean_percent},
          {"p99_percent", m.p99_percent},
          {"max_percent", m.max_percent},
          {"overshoot_percent", m.overshoot_percent},
          {"jump_percent", m.jump_percent},
          {"rough_percent", m.rough_percent},
          {"exceed_percent", m.exceed_percent},
          {"paper_mean_percent", m.paper_mean_percent},
          {"paper_max_percent", m.paper_max_percent},
          {"paper_max_force_percent", m.paper_max_force_percent}};
}

Reference::Reference(const Vec3& force) : f(force), norm(force.norm()), bin(ErrorTable::bin_of(norm)) {}

int ErrorTable::bin_of(double newton) noexcept {
  if (newton <= kSmallest) return 0;
  return std::min(static_cast<int>(kPerOctave * std::log2(newton / kSmallest)), kBins - 1);
}

ErrorTable::ErrorTable(double rate_hz) {
  if (rate_hz <= 2 * kRoughHz)
    rough_squared_ = std::numeric_limits<double>::quiet_NaN();  // no filter does that
  const double w = std::tan(std::numbers::pi * kRoughHz / rate_hz), root = std::numbers::sqrt2 * w;
  b0_ = 1 / (1 + root + w * w);
  a1_ = 2 * (w * w - 1) * b0_;
  a2_ = (1 - root + w * w) * b0_;
}

void ErrorTable::add(const Vec3& force, const Reference& reference) noexcept {
  const Vec3 e = force - reference.f;
  ++ticks_;
  rough_squared_ += high_pass(e).squaredNorm();
  const double size = force.norm();
  if (reference.norm == 0 && size == 0) return;
  const double error = e.norm();
  ++pushing_;
  error_sum_ += error;
  error_max_ = std::max(error_max_, error);
  force_max_ = std::max(force_max_, size);
  error_nN_.add(static_cast<std::int64_t>(std::min(error, 1e9) * 1e9));
  peak_ = std::max(peak_, reference.norm);
  exceed_ += error > kNoticed * std::max(reference.norm, kFloor * peak_) ? 1 : 0;
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
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  }
  m.mean_percent = 100 * (error_sum_ / pushing_) / std::sqrt(reference_squared_ / contact_);
  m.p99_percent = 100 * error_nN_.quantile(0.99) * 1e-9 / peak_;
  m.max_percent = 100 * error_max_ / peak_;
  m.overshoot_percent = 100 * std::max(force_max_ / peak_ - 1, 0.0);
  m.exceed_percent = 100 * exceed_ / pushing_;
  m.jump_percent = 100 * jump_ / peak_;
  m.rough_percent = 100 * std::sqrt(rough_squared_ / ticks_) / peak_;
  const Paper p = paper(kFloor * peak_);
  m.paper_mean_percent = 100 * p.mean;
  m.paper_max_percent = 100 * p.max;
  m.paper_max_force_percent = 100 * p.max_force;
  return m;
}

}  // namespace palpate::client
