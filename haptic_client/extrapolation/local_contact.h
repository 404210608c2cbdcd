#pragma once
#include "haptic_client/extrapolation/contact_on_patch.h"
#include "haptic_client/extrapolation/two_tangents.h"

namespace palpate::client {

/// Solves the contact of the tool with the surface near it here and now, at every tick, with the server's own
/// narrow phase and solver on the compliance of the tissue over a sample. F_loc is the force of that small
/// problem; where it differs from the server's, it is corrected by
///   F(P) = F_loc(P') + c (F_n - F_loc(P_n')),   c = min(3, |F_loc(P')| / |F_loc(P_n')|),   P' = P - s - v (t
///   - t_n)
/// with s and v how far the organ has moved and how fast it does: what is missing fades with the contact
/// (c = 0 where F_loc(P_n') = 0). Where the model is not known around the tool (yet), or a sample brings
/// none: `TwoTangents`, from one sample to the next.
class LocalContact : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  Vec3 force(const Vec3& p, Time t) noexcept override;
  Wants wants() const noexcept override { return {.here = true, .ahead = true, .surface = true}; }

 private:
  Vec3 at_rest(const Vec3& p, Time t) const noexcept;

  TwoTangents without_;
  ContactOnPatch contact_;
  Sample newest_;
  Vec3 local_ = Vec3::Zero();  // F_loc(P_n'), N
  bool known_ = false;         // whether the model says what is felt, since the newest sample
};

}  // namespace palpate::client
