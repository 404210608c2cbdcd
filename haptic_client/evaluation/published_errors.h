#pragma once
#include <array>

#include "common/discretisation_error.h"

namespace palpate::client {

/// Mean over samples of one published error. The source is that of most of the known weight.
class PublishedError {
 public:
  void add(const DiscretisationError& error, double weight) noexcept;
  /// Unknown while no sample had it.
  DiscretisationError mean() const noexcept;

 private:
  double sum_ = 0;                   // of percent times weight
  std::array<double, 4> weights_{};  // by source
};

/// Means of the published errors of mesh and time step, each sample weighted by the size of its force. Haptic
/// thread; does not allocate.
class PublishedErrors {
 public:
  /// `newton`: size of the force, N.
  void add(const DiscretisationErrors& errors, double newton) noexcept;
  DiscretisationErrors mean() const noexcept { return {mesh_.mean(), time_step_.mean()}; }

 private:
  PublishedError mesh_, time_step_;
};

}  // namespace palpate::client
