#pragma once
#include <array>
#include <cstdint>

namespace palpate {

/// Counts of non-negative whole numbers (nanoseconds, usually) in log-linear buckets: 128 steps an octave, so
/// a quantile is right within 0.4 %; the maximum is exact. One thread writes; read it when that thread rests.
/// `add` is a few instructions, nothing allocates (40 KiB of counters).
class Histogram {
 public:
  void add(std::int64_t value) noexcept;

  std::int64_t count() const noexcept { return count_; }
  std::int64_t max() const noexcept { return max_; }
  double mean() const noexcept { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }

  /// The value that a share `q` in [0, 1] of the counts does not exceed (middle of its bucket); 0 when empty.
  double quantile(double q) const noexcept;
  /// Returns how many counts are larger than `value`, rounded to a bucket.
  std::int64_t count_above(std::int64_t value) const noexcept;

 private:
  static constexpr int kBits = 8;      // bits of kSteps
  static constexpr int kSteps = 128;   // buckets per octave
  static constexpr int kOctaves = 38;  // up to 2^45, about 9 hours in ns
  static int bucket_of(std::int64_t value) noexcept;
  static double middle_of(int bucket) noexcept;

  std::array<std::int64_t, kSteps*(kOctaves + 1)> counts_{};
  std::int64_t count_ = 0, max_ = 0;
  double sum_ = 0;
};

}  // namespace palpate
