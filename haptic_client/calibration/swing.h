#pragma once
#include "common/types.h"

namespace palpate::client {

/// Motion of the grip in a weighing, 4 mm up, 8 mm down and back in two seconds, and the force it took. Joint
/// friction opposes the way up as much as the way down, and inertia cancels over a period. So the mean over a
/// full swing is the weight alone. A hand that holds the grip shows as a spring.
class Swing {
 public:
  static constexpr double kPeriod = 2;  ///< s

  /// Returns the goal at `t` (s, any) relative to the rest position of the grip: m, along y.
  static double offset(double t) noexcept;

  /// Adds `dt` seconds with the grip at `p_D` (m) under the force `f_D` (N), device frame.
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
