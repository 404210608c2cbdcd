#pragma once
#include <limits>

namespace palpate {

/// Work that an iteration may do in a call, in multiplications, roughly. It makes a haptic tick end in time,
/// whatever problem it is given. Equal on every machine, unlike a clock.
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
