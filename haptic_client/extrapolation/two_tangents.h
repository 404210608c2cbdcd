#pragma once
#include "haptic_client/extrapolation/tangent.h"

namespace palpate::client {

/// Two tangents of the server, at P_n and at the place P^ where it expected the tool in the middle of the
/// sample's use (P^ = P_n + (V_n - v_s) (latency + T / 2), v_s of the organ there, at most 2 mm away),
/// blended along the way between them:
///   D = P^ - P_n,  s = clamp((P - P_n) . D / (|D|^2 + (10 um)^2), 0, 1),  w = s^2 (3 - 2 s),
///   F = (1 - w) T_n(P) + w T^(P),
/// P as it stands on the organ of t_n (`OrganMotion`).
/// Where a sample lacks the second: `Tangent`. Of our own. About 30 ns a tick and 0.8 us a sample.
class TwoTangents : public Extrapolator {
 public:
  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  Vec3 force(const Vec3& p, Time t) noexcept override;
  Request request() const noexcept override { return {.at_tool = true, .ahead = true}; }
  bool stepped_down() const noexcept override { return !newest_.at_tool || !newest_.ahead; }
  std::string_view substitute() const noexcept override {
    return newest_.at_tool && !newest_.ahead ? "tangent" : first_.substitute();
  }

 private:
  Tangent first_;
  Sample newest_;
  OrganMotion motion_;
};

}  // namespace palpate::client
