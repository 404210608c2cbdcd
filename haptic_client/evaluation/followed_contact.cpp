#include "haptic_client/evaluation/followed_contact.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kOften = 1000;  // Hz: faster ticks share a solved place
// After a place that could not be solved (more of the surface is near than there is room for, say) it rests
// for so many ticks: each try goes in from outside again, which takes longer than a tick has.
constexpr int kPauseTicks = 100;

/// A tenth of what the law allows itself.
ContactOnPatch::Accuracy accuracy(double rate_hz) {
  const double wider = std::max(1.0, rate_hz / kOften);
  return {.near = 0.003 * wider, .most_near = 0.001 * wider, .tolerance = 2e-4, .most_tolerance = 1e-4};
}
}  // namespace

FollowedContact::FollowedContact(double rate_hz)
    : contact_(std::make_unique<ContactOnPatch>(accuracy(rate_hz))) {}

void FollowedContact::take(const Sample& sample) noexcept {
  if (!usable(sample)) return;
  const Sample known = with_usable_parts(sample);
  surface_ = known.surface;
  motion_.update(known);
  if (!surface_ || surface_->tool.friction > 0 || surface_->modes.count > 0) {
    surface_.reset();
    contact_->separate();
  }
}

std::optional<PathTick::Contact> FollowedContact::follow(const Vec3& p, Time t) noexcept {
  if (pause_ > 0) --pause_;
  if (!surface_ || pause_ > 0) return {};
  const Vec3 shift = surface_->shift + motion_.since_sample(t);
  const auto force = contact_->move_to(*surface_, p - shift);
  if (!force) {
    pause_ = kPauseTicks;
    return {};
  }
  return PathTick::Contact{shift, *force, contact_->tangent()};
}

}  // namespace palpate::client
