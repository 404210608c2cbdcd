#pragma once
#include <array>

#include "haptic_client/calibration/swing.h"

namespace palpate::client {

/// Weighs what the grip carries by repeated swings, until the last three agree.
class Weighing {
 public:
  /// Adds `dt` seconds with the grip at `p_D` (m) under the force `f_D` (N), swing by swing. The first swing
  /// does not count, nor the one in which a hand releases the grip.
  void add(const Vec3& p_D, const Vec3& f_D, double dt) noexcept;
  /// Returns the present goal relative to the rest position of the grip: m, along y.
  double offset() const noexcept { return Swing::offset(time_); }

  /// Three swings in a row agree within 0.05 N or 3 %.
  bool done() const noexcept;
  /// A hand held the newest whole swing.
  bool held() const noexcept { return held_; }
  /// N: mean of the last three swings, device frame.
  Vec3 force() const noexcept { return (forces_[0] + forces_[1] + forces_[2]) / 3; }
  /// N: the largest distance of one of them from their mean.
  double spread() const noexcept;

 private:
  Swing swing_;
  std::array<Vec3, 3> forces_{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // in a ring
  std::size_t swings_ = 0;                                                // in a row, free ones
  bool settling_ = true, held_ = false;
  double time_ = 0;  // s
};

}  // namespace palpate::client
