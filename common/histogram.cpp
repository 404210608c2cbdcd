#include "common/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace palpate {

int Histogram::bucket_of(std::int64_t value) noexcept {
  if (value < kSteps) return static_cast<int>(value);  // exact below one octave's worth of steps
  const int octave = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(value))) - kBits + 1;
  const int step = static_cast<int>(value >> (octave - 1)) - kSteps;
  return std::min(octave * kSteps + step, kSteps * (kOctaves + 1) - 1);
}

double Histogram::middle_of(int bucket) noexcept {
  if (bucket < kSteps) return bucket;
  const int octave = bucket / kSteps;
  const double width = std::ldexp(1.0, octave - 1);
  return (kSteps + bucket % kSteps) * width + (width - 1) / 2;
}

void Histogram::add(std::int64_t value) noexcept {
  value = std::max<std::int64_t>(value, 0);
  ++counts_[static_cast<std::size_t>(bucket_of(value))];
  ++count_;
  max_ = std::max(max_, value);
  sum_ += static_cast<double>(value);
}

double Histogram::quantile(double q) const noexcept {
  const auto wanted = static_cast<std::int64_t>(std::ceil(q * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    seen += counts_[i];
    if (seen >= wanted && seen > 0)
      return std::min(middle_of(static_cast<int>(i)), static_cast<double>(max_));
  }
  return 0;
}

std::int64_t Histogram::count_above(std::int64_t value) const noexcept {
  const auto first = counts_.begin() + bucket_of(std::max<std::int64_t>(value, 0)) + 1;
  return std::accumulate(first, counts_.end(), std::int64_t{0});
}

}  // namespace palpate
