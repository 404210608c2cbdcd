#pragma once
#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// The current position P is projected on the line through P_(n-1) and P_n, giving P', and
///   F = F_n + r (F_n - F_(n-1))
/// (Picinbono and Lombardo 1999, linear extrapolation over position). As printed, r = |P' - P_n| / |P_n -
/// P_(n-1)|: it has no sign, so on a reversal the force moves the wrong way. Signed, r = (P - P_n) . d /
/// |d|^2 with d = P_n - P_(n-1). Both divide by |d|, which vanishes where the tool rests, while on an organ
/// that moves the force goes on changing: so |d| counts as at least 20 um there, which is not in the paper
/// and changes nothing of its table. With one sample, with P_n = P_(n-1), or with P not finite: F_n. Samples
/// that are not later than the newest are ignored. A few ns.
class LinearPosition : public Extrapolator {
 public:
  enum class Ratio { kPrinted, kSigned };
  explicit LinearPosition(Ratio ratio) : ratio_(ratio) {}
  void update(const Sample& sample) noexcept override { samples_.push(sample); }
  void restart() noexcept override { samples_ = {}; }
  Vec3 force(const Vec3& p, Time t) noexcept override;

 private:
  Ratio ratio_;
  LastTwo samples_;
};

}  // namespace palpate::client
