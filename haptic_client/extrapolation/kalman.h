#pragma once
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// A Kalman filter on the force, which Picinbono and Lombardo (1999) name and turn down: force and its rate
/// as state, the rate driven by white noise of q = 100 N^2/s^3, samples with noise of r = (1 mN)^2
/// (Bar-Shalom et al. 2001, section 6.2.2, discretised continuous white noise acceleration);
///   F = f + (t - t_n) df/dt.
/// The samples of a simulation hardly have noise, so it comes out as linear in time, as the authors guessed.
/// It is not exact at a sample, by about a millinewton. About 4 ns.
class Kalman : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override;
  void restart() noexcept override { *this = {}; }
  Vec3 force(const Vec3& p, Time t) noexcept override;

 private:
  bool any_ = false;
  Time t_{};
  Vec3 f_ = Vec3::Zero(), rate_ = Vec3::Zero();  // N, N/s
  double p00_ = 0, p01_ = 0, p11_ = 0;           // covariance: N^2, N^2/s, N^2/s^2
};

}  // namespace palpate::client
