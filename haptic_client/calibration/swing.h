#pragma once
#include "common/types.h"

namespace palpate::client {

/// One slow motion of the grip, 4 mm up, 8 mm down and back in two seconds, and the force it took. The
/// joints' friction holds against the way up as much as against the way down, and what speeds the grip up
/// brakes it later: the mean over a whole swing is the weight alone. A hand that holds the grip shows as a
/// spring.
class Swing {
 public:
  static constexpr double kPeriod = 2;  ///< s

  /// Where to be at `t` (s, any) from where the grip rests: m, along y.
  static double offset(double t) noexcept;

  /// What was done for `dt` seconds.
  void add(const Vec3& p_D, const Vec3& f_D, double dt) noexcept;
  bool complete() const noexcept { return time_ >= kPeriod; }

  /// N, device frame; after `add`.
  Vec3 mean_force() const noexcept { return force_ / time_; }
  /// The grip did not move freely: a spring of more than 60 N/m holds it, or it moved by less than 2 mm.
  bool held() const noexcept;

 private:
  double time_ = 0, y_ = 0, yy_ = 0, fy_ = 0;  // sums over time: y, y^2, f_y y
  double lowest_ = 1e9, highest_ = -1e9;       // m
  Vec3 force_ = Vec3::Zero();
};

}  // namespace palpate::client
