#pragma once
/// Subcommands of `studies`, and what they share.
#include <cmath>
#include <functional>
#include <vector>

#include "common/program.h"
#include "common/report.h"
#include "common/types.h"

namespace palpate::studies {

Command robustness_command();
Command stability_command();
Command link_command();

/// Option `--quick` of a study.
Option quick_option(bool& quick);

/// Does each k below `count` on all cores, and says on stderr how many of `what` are done. Each thread calls
/// `worker` once, and the function that it returns for each of its k.
void for_all(std::size_t count, const char* what,
             const std::function<std::function<void(std::size_t)>()>& worker);

/// Error of rendered forces against the right ones, N, relative to the RMS of the right ones.
class ForceErrors {
 public:
  void add(const Vec3& rendered, const Vec3& right);
  /// RMS of the errors; 0 where there is no right force.
  double rms() const { return squares_ > 0 ? std::sqrt(error_squares_ / squares_) : 0; }
  /// Mean, 99th percentile and largest of the errors, %; null where there is no right force.
  Json percent();

 private:
  std::vector<double> errors_;
  double error_squares_ = 0, squares_ = 0;
};

}  // namespace palpate::studies
