#pragma once
#include <algorithm>
#include <array>

#include "common/histogram.h"
#include "common/report.h"
#include "common/time.h"
#include "common/types.h"

namespace palpate {

/// Sizes of an error e = F - F_ref over a run, in percent; "peak" is the largest |F_ref| of the run, "RMS"
/// the root mean square of |F_ref| in contact. NaN, null in reports: not measured.
struct ErrorSizes {
  double mean_percent = 0;        ///< mean |e| / RMS
  double p99_percent = 0;         ///< 99th percentile of |e| / peak
  double max_percent = 0;         ///< largest |e| / peak
  double p99_of_rms_percent = 0;  ///< 99th percentile of |e| / RMS
  double max_of_rms_percent = 0;  ///< largest |e| / RMS
};

/// Error of a law over a run, in percent, at every tick where the reference or the law pushes. Where the
/// reference never pushed, NaN.
struct ErrorMetrics : ErrorSizes {
  double overshoot_percent = 0;  ///< by how much the largest |F| is above the peak / peak; 0: it is not
  double exceed_percent = 0;     ///< of the ticks: |e| > 10 % of max(|F_ref|, 10 % of the peak so far)
  double jump_percent = 0;       ///< largest |F after - F before| when a sample arrived, same place / peak
  double rough_percent = 0;      ///< RMS of e above 30 Hz / peak
  /// Sizes of the mean e over each 10 ms in which the reference or the law pushes: what a hand at 100 Hz
  /// resolves. NaN below 200 ticks a second.
  ErrorSizes mean_10ms = {};
  /// Picinbono and Lombardo 1999, section 4: |e| in percent of |F_ref|, mean and largest, and the largest |F|
  /// in percent of |F_ref|. As a quotient of two small numbers explodes at the onset of contact, |F_ref|
  /// counts as at least 10 % of the peak here.
  double paper_mean_percent = 0, paper_max_percent = 0, paper_max_force_percent = 0;
};

/// Writes sizes as `mean_percent`, `p99_percent`, ..., those of means over 10 ms as `mean_10ms_percent`, ...
/// `of`: "" or "_10ms".
Json to_json(const ErrorSizes& sizes, const std::string& of = "");

/// Writes the metrics by their names, for reports.
Json to_json(const ErrorMetrics& metrics);

/// A reference force at a tick, prepared once for all laws.
struct ReferenceForce {
  /// `t`: of the tick, not negative.
  ReferenceForce(const Vec3& force, Time t);
  Vec3 f;               ///< N
  double norm;          ///< N
  int bin;              ///< of `norm`
  std::int64_t window;  ///< number of the 10 ms that `t` is in
};

/// Adds up what `ErrorMetrics` needs, in flat memory (100 KiB), in one pass, though the peak is known only at
/// the end: ratios are kept by the size of the reference, in steps of 9 %. No allocation; one thread; about
/// 50 ns a tick.
class ErrorTable {
 public:
  /// `rate_hz`: ticks per second, for the 30 Hz high-pass (Butterworth, second order).
  explicit ErrorTable(double rate_hz);

  /// Adds one tick in which the law returned `force` and `reference` was right; in the order of time.
  void add(const Vec3& force, const ReferenceForce& reference) noexcept;
  /// A sample arrived and moved the force by `size` (N).
  void add_jump(double size) noexcept { jump_ = std::max(jump_, size); }

  /// Means over 10 ms count once a tick after them was added.
  ErrorMetrics metrics() const noexcept;

  static int bin_of(double newton) noexcept;

 private:
  static constexpr int kPerOctave = 8;           // a bin is 9 % wide
  static constexpr int kBins = 40 * kPerOctave;  // to 1e6 N
  static constexpr double kSmallest = 1e-6;      // N

  /// Ticks whose |F_ref| is of one size.
  struct Bin {
    double count = 0, error_sum = 0, error_max = 0, force_max = 0;         // N
    double error_ratio_sum = 0, error_ratio_max = 0, force_ratio_max = 0;  // of |F_ref|
  };
  struct Paper {
    double mean = 0, max = 0, max_force = 0;
  };
  /// Sizes of errors, N.
  struct Spread {
    Histogram nN;
    double count = 0, sum = 0, max = 0;
    void add(double newton) noexcept;
    ErrorSizes of(double peak, double rms) const noexcept;
  };
  /// The 10 ms that are being added up.
  struct Window {
    std::int64_t number = 0;
    double ticks = 0;
    bool pushes = false;
    Vec3 error_sum = Vec3::Zero();  // N
  };
  Paper paper(double floor) const noexcept;
  Vec3 high_pass(const Vec3& e) noexcept;
  void add_to_window(const Vec3& e, bool pushes, std::int64_t number) noexcept;

  std::array<Bin, kBins> bins_{};
  Spread errors_, window_errors_;
  Window window_;
  bool has_windows_;  // enough ticks in 10 ms
  double contact_ = 0, ticks_ = 0;
  double reference_squared_ = 0, peak_ = 0, force_max_ = 0, jump_ = 0;
  double exceed_ = 0, rough_squared_ = 0;
  double b0_, a1_, a2_;
  Vec3 z1_ = Vec3::Zero(), z2_ = Vec3::Zero();
};

}  // namespace palpate
