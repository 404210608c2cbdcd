#pragma once
#include <span>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

/// The history of a body over its steps, and the formula by which a step of length h turns positions at its
/// end into velocities and accelerations there:
///   v = c (x - x~),   a = c (v - v~),
///   backward Euler:  c = 1 / h,      x~ = x_n,
///   BDF2:            c = 3 / (2 h),  x~ = (4 x_n - x_(n-1)) / 3,
/// and v~ by the same formula from the velocities (Hairer, Norsett and Wanner 1993, Solving Ordinary
/// Differential Equations I, eq. III.1.22'). The internal forces f of the nodes have a history too, because
/// damping in proportion to the stiffness asks for their rate df/dt = c (f - f~). The first step of BDF2 is
/// one of backward Euler. All steps of a body have to be of one length for BDF2 to be of second order. Every
/// array is by nodes. After construction nothing allocates but `restart`.
class TimeStepping {
 public:
  /// Starts at rest at `x` (nodes, m), where no internal forces act.
  TimeStepping(std::span<const Vec3> x, bool second_order);
  /// Restarts at `x` (nodes, m) with these internal forces (nodes, N), as if it had always been there, at the
  /// velocities `v` (nodes, m/s), or the present ones where that is empty.
  void restart(std::span<const Vec3> x, std::span<const Vec3> v, std::span<const Vec3> internal);
  /// Begins a step of `h` (s > 0): sets c, x~, v~ and f~. May be called again before the step ends.
  void begin(double h);
  /// Ends it at `x` (nodes, m). Takes the internal forces there (nodes, N) by a swap: afterwards `internal`
  /// is of the same size, its values of no meaning. `stop`: the body comes to rest there, and has been there
  /// in the step before.
  void end(std::span<const Vec3> x, std::vector<Vec3>& internal, bool stop);

  /// Between two steps: a node rests where it is, and always did.
  void stop(std::size_t i) {
    v_[i] = earlier_v_[i] = Vec3::Zero();
    earlier_x_[i] = x_[i];
  }
  /// Between two steps: a node goes towards another by this share of the way, and always was there, as fast
  /// as what was.
  void slide(std::size_t i, std::size_t towards, double fraction) {
    for (std::vector<Vec3>* const of : {&x_, &v_, &earlier_x_, &earlier_v_})
      (*of)[i] = (1 - fraction) * (*of)[i] + fraction * (*of)[towards];
  }
  /// The internal forces (nodes, N) always were these.
  void forget_forces(std::span<const Vec3> internal) {
    f_.assign(internal.begin(), internal.end());
    earlier_f_ = f_;
  }

  /// Returns c of the step in hand, 1/s; 0 before the first.
  double c() const { return c_; }
  /// Length of the step in hand, s.
  double step_length() const { return h_; }
  /// Steps that have ended.
  int steps() const { return steps_; }
  /// Velocity (m/s) of node i that ends the step at `x` (m).
  Vec3 velocity_at(std::size_t i, const Vec3& x) const { return c_ * (x - predictor_x_[i]); }
  /// Acceleration (m/s^2) of node i that ends the step with velocity `v` (m/s).
  Vec3 acceleration_at(std::size_t i, const Vec3& v) const { return c_ * (v - predictor_v_[i]); }
  /// df/dt / c of node i that ends the step with the internal force `f` (N): f - f~, N.
  Vec3 change_of_force(std::size_t i, const Vec3& f) const { return f - predictor_f_[i]; }

  /// Positions (m), velocities (m/s) and internal forces (N) at the end of the last step.
  std::span<const Vec3> position() const { return x_; }
  std::span<const Vec3> velocity() const { return v_; }
  std::span<const Vec3> internal_force() const { return f_; }
  std::size_t bytes() const {
    return 3 * (x_.size() + earlier_x_.size() + predictor_x_.size()) * sizeof(Vec3);
  }

 private:
  bool second_order_;
  double c_ = 0, h_ = 0;
  int steps_ = 0;
  std::vector<Vec3> x_, v_, f_;                                // at the end of the last step
  std::vector<Vec3> earlier_x_, earlier_v_, earlier_f_;        // and of the one before
  std::vector<Vec3> predictor_x_, predictor_v_, predictor_f_;  // x~, v~, f~
};

}  // namespace palpate::sim
