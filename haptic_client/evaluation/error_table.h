#pragma once
#include <array>

#include "common/histogram.h"
#include "common/report.h"
#include "common/types.h"

namespace palpate::client {

/// Error of a law over a run, in percent. e = F - F_ref, at every tick where the reference or the law pushes;
/// "peak" is the largest |F_ref| of the run. Where the reference never pushed, NaN, null in reports.
struct ErrorMetrics {
  double mean_percent = 0;       ///< mean |e| / RMS of |F_ref| in contact
  double p99_percent = 0;        ///< 99th percentile of |e| / peak
  double max_percent = 0;        ///< largest |e| / peak
  double overshoot_percent = 0;  ///< by how much the largest |F| is above the peak / peak; 0: it is not
  double exceed_percent = 0;     ///< of the ticks: |e| > 10 % of max(|F_ref|, 10 % of the peak so far)
  double jump_percent = 0;       ///< largest |F after - F before| when a sample arrived, same place / peak
  double rough_percent = 0;      ///< RMS of e above 30 Hz / peak
  /// Picinbono and Lombardo 1999, section 4: |e| in percent of |F_ref|, mean and largest, and the largest |F|
  /// in percent of |F_ref|. As a quotient of two small numbers explodes at the onset of contact, |F_ref|
  /// counts as at least 10 % of the peak here.
  double paper_mean_percent = 0, paper_max_percent = 0, paper_max_force_percent = 0;
};

/// Writes the metrics by their names, for reports.
Json to_json(const ErrorMetrics& metrics);

/// A reference force, prepared once for all laws.
struct Reference {
  explicit Reference(const Vec3& force);
  Vec3 f;       ///< N
  double norm;  ///< N
  int bin;      ///< of `norm`
};

/// Adds up what `ErrorMetrics` needs, in flat memory (60 KiB), in one pass, though the peak is known only at
/// the end: ratios are kept by the size of the reference, in steps of 9 %. No allocation; one thread; about
/// 50 ns a tick.
class ErrorTable {
 public:
  /// `rate_hz`: ticks per second, for the 30 Hz high-pass (Butterworth, second order).
  explicit ErrorTable(double rate_hz);

  /// Adds one tick in which the law returned `force` and `reference` was right.
  void add(const Vec3& force, const Reference& reference) noexcept;
  /// A sample arrived and moved the force by `size` (N).
  void add_jump(double size) noexcept { jump_ = std::max(jump_, size); }

  ErrorMetrics metrics() const noexcept;

  static int bin_of(double newton) noexcept;

 private:
  static constexpr int kPerOctave = 8, kBins = 40 * kPerOctave;
  static constexpr double kSmallest = 1e-6;  // N

  /// Ticks whose |F_ref| is of one size.
  struct Bin {
    double count = 0, error_sum = 0, error_max = 0, force_max = 0;         // N
    double error_ratio_sum = 0, error_ratio_max = 0, force_ratio_max = 0;  // of |F_ref|
  };
  struct Paper {
    double mean = 0, max = 0, max_force = 0;
  };
  Paper paper(double floor) const noexcept;
  Vec3 high_pass(const Vec3& e) noexcept;

  std::array<Bin, kBins> bins_{};
  Histogram error_nN_;
  double pushing_ = 0, contact_ = 0, ticks_ = 0;  // ticks
  double error_sum_ = 0, reference_squared_ = 0, peak_ = 0, error_max_ = 0, force_max_ = 0, jump_ = 0;
  double exceed_ = 0, rough_squared_ = 0;
  double b0_, a1_, a2_;
  Vec3 z1_ = Vec3::Zero(), z2_ = Vec3::Zero();
};

}  // namespace palpate::client
