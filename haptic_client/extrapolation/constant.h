#pragma once
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// F(t) = F_n (Picinbono and Lombardo 1999, constant extrapolation). Only forces that the model computed, to
/// the bit; rough under about 300 Hz. The last usable sample counts, whatever its time and place. A few
/// instructions.
class Constant : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override {
    if (usable(sample)) force_ = sample.f;
  }
  void restart() noexcept override { force_.setZero(); }
  Vec3 force(const Vec3&, Time) noexcept override { return force_; }

 private:
  Vec3 force_ = Vec3::Zero();
};

}  // namespace palpate::client
