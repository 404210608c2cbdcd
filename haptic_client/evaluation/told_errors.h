#pragma once
#include <array>

#include "common/discretisation_error.h"

namespace palpate::client {

/// What the server told of one error, as a mean over samples. The source is that of most of the weight that
/// is known.
class ToldError {
 public:
  void add(const DiscretisationError& error, double weight) noexcept;
  /// Unknown while no sample told it.
  DiscretisationError mean() const noexcept;

 private:
  double sum_ = 0;                   // of percent times weight
  std::array<double, 4> weights_{};  // by source
};

/// The same of mesh and time step, each sample by the size of its force. Haptic thread; does not allocate.
class ToldErrors {
 public:
  /// `newton`: size of the force, N.
  void add(const DiscretisationErrors& errors, double newton) noexcept;
  DiscretisationErrors mean() const noexcept { return {mesh_.mean(), time_step_.mean()}; }

 private:
  ToldError mesh_, time_step_;
};

}  // namespace palpate::client
