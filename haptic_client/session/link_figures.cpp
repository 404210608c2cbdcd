#include "haptic_client/session/link_figures.h"

#include <algorithm>

#include "common/ages.h"

namespace palpate::client {
using protocol::ForceSample;

void LinkFigures::received(std::size_t bytes, Time now) noexcept {
  if (bytes_down == 0) began = now;
  bytes_down += bytes;
  if (now - began < std::chrono::seconds(1)) early_bytes_down += bytes;
}

void LinkFigures::sample(const ForceSample& sample, Time now) noexcept {
  if (samples > 0) {
    longest_gap = std::max(longest_gap, now - newest_sample);
    gaps += now - newest_sample > kGap ? 1 : 0;
    if (now - newest_sample > kOutage) unanswered = 0;  // of a link that was down nothing is known
  }
  newest_sample = now;
  surfaces += (sample.flags & ForceSample::kHasSurface) != 0 ? 1 : 0;
  if ((sample.flags & ForceSample::kHasUplink) != 0) uplink = sample.uplink;
  ++samples;
  const std::int64_t age = now.count() - sample.tool_t_ns;
  if (age >= 0) age_ns.add(age);
  if ((sample.flags & ForceSample::kHasTangent) == 0 || (sample.flags & ForceSample::kInContact) == 0) return;
  const Mat3& k = sample.at_tool.tangent;
  const Vec3& n = sample.at_tool.normal_W;
  const Vec3 kn = k.col(0) * n[0] + k.col(1) * n[1] + k.col(2) * n[2];
  stiffest = std::max(stiffest, -n.dot(kn));
}

void LinkFigures::page() noexcept {
  ++pages;
  unanswered = 0;
}

void LinkFigures::requested_pages(Time now) noexcept {
  ++page_requests;
  if (unanswered > 0 && now - newest_unanswered < kEvery) return;
  if (unanswered++ == 0) first_unanswered = now;
  newest_unanswered = now;
}

/// A link that is down altogether says nothing of the size of its datagrams: the newest sample is late, too.
bool LinkFigures::drops_large() const noexcept {
  constexpr std::uint64_t kEnough = 6;  // of those that come every 250 ms at the fewest, one in 450 ms counts
  return unanswered >= kEnough && newest_sample - first_unanswered > kPatience;
}

std::string large_datagrams_text() {
  return "pages of the surface were requested, and none came, though samples do: datagrams of 937 bytes do "
         "not "
         "get through, as where a tunnel or firewall on the way drops IP fragments, so that a law without "
         "pages stands in; let fragments pass, give the tunnel an MTU of 1280 bytes (`ip link set dev IF mtu "
         "1280`), or choose a law that needs no pages (`--method two_tangents`)";
}

}  // namespace palpate::client
