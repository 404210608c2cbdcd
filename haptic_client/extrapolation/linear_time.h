#pragma once
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// F(t) = F_n + (t - t_n) / (t_n - t_(n-1)) (F_n - F_(n-1)) (Picinbono and Lombardo 1999, linear
/// extrapolation over time). With one sample: F_n; samples that are not later than the newest are
/// ignored, so the divisor is never 0. The forces are no longer the model's and grow without bound while a
/// sample is late; `ForceEstimate` turns time back after three periods beyond the usual age, and the limiter
/// bounds the rest. A few ns.
class LinearTime : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override { samples_.push(sample); }
  void restart() noexcept override { samples_ = {}; }
  Vec3 force(const Vec3& p, Time t) noexcept override;

 private:
  LastTwo samples_;
};

}  // namespace palpate::client
