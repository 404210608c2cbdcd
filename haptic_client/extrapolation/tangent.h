#pragma once
#include "haptic_client/extrapolation/learned_stiffness.h"
#include "haptic_client/extrapolation/organ_motion.h"

namespace palpate::client {

/// The part of a stiffness that a law may use: symmetric, and without its positive eigenvalues (they push a
/// tool sideways the further it is: true of a bent surface, unstable in the hand). About 0.3 us.
Mat3 restoring_part(const Mat3& k) noexcept;

/// A linearisation at `p`: in contact f + K (p - place), zero where it would pull; free of it the surface's
/// plane, as stiff as the server says it is: K n (gap + n . (p - place)) beyond it. Zero where no surface is
/// near.
Vec3 force_at(const Linearisation& l, const Vec3& p) noexcept;

/// F = F_n + K_n (P - P_n - s(t)), K_n = dF/dP the server's own tangent at P_n, s how far the organ has moved
/// since (`OrganMotion`). The first contact comes at the plane that the sample tells, not a sample late.
/// Where a sample has no tangent: `LearnedStiffness`. A linear model of the tissue around the tool between
/// two steps of the simulation: Cavusoglu and Tendick (2000); plane, organ motion and what is left out of K
/// are of our own. About 20 ns a tick and 0.4 us a sample.
class Tangent : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  Vec3 force(const Vec3& p, Time t) noexcept override;
  Request request() const noexcept override { return {.at_tool = true}; }
  bool stepped_down() const noexcept override { return !newest_.at_tool; }
  std::string_view substitute() const noexcept override { return newest_.at_tool ? "" : "learned_stiffness"; }

 private:
  LearnedStiffness learned_;
  Sample newest_;
  OrganMotion motion_;
};

}  // namespace palpate::client
