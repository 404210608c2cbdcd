#pragma once
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// F = F_n + B (P - P_n), B a symmetric stiffness (N/m) learned from the samples alone, by Powell's symmetric
/// secant update (Powell 1970; Dennis and Schnabel 1996, section 9.1): with s = P_n - P_(n-1), y = F_n -
/// F_(n-1), r = y - B s, sigma = |s|^2 + (10 um)^2,
///   B <- B + (r s^T + s r^T) / sigma - (r . s) s s^T / sigma^2.
/// Symmetric, it makes no energy on a closed path; a tool at rest keeps what was learned, which a law that
/// falls back to constant does not. B is forgotten where a sample is free, and kept below 50 kN/m. The force
/// is zero where it would pull: F . F_n < 0. About 7 ns.
class LearnedStiffness : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  Vec3 force(const Vec3& p, Time t) noexcept override;

 private:
  LastTwo samples_;
  Mat3 b_ = Mat3::Zero();
};

}  // namespace palpate::client
