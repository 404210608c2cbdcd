#pragma once
#include <array>

#include "common/discretisation_error.h"

namespace palpate {

/// Mean of one error over steps or samples. The source is that of most of the known weight.
class ErrorMean {
 public:
  void add(const DiscretisationError& error, double weight) noexcept;
  /// Unknown while nothing had it.
  DiscretisationError mean() const noexcept;

 private:
  double sum_ = 0;                   // of percent times weight
  std::array<double, 4> weights_{};  // by source
};

/// Means of the errors by mesh and time step, each step or sample weighted by the size of its force: the
/// server and the client of a session say the same of it. One thread; does not allocate.
class ErrorMeans {
 public:
  /// `newton`: size of the force, N.
  void add(const DiscretisationErrors& errors, double newton) noexcept;
  DiscretisationErrors mean() const noexcept { return {mesh_.mean(), time_step_.mean()}; }

 private:
  ErrorMean mesh_, time_step_;
};

}  // namespace palpate
