#pragma once
#include <limits>

namespace palpate {

/// How much work an iteration may still do, in multiplications, roughly: so that a haptic tick ends in time,
/// whatever problem it is given. The same on every machine, unlike a clock.
class WorkBudget {
 public:
  /// Allows so much from now on.
  void allow(double multiplications) noexcept {
    allowed_ = multiplications;
    used_ = 0;
    spent_ = false;
  }
  /// Uses some; false where there is not as much left, and from then on.
  bool spend(double multiplications) noexcept {
    spent_ = spent_ || !(used_ + multiplications <= allowed_);
    if (!spent_) used_ += multiplications;
    return !spent_;
  }
  bool is_spent() const noexcept { return spent_; }
  double used() const noexcept { return used_; }

 private:
  double allowed_ = std::numeric_limits<double>::infinity(), used_ = 0;
  bool spent_ = false;
};

}  // namespace palpate
