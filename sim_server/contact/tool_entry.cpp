// Tools that are inside the tissue, or have left it behind: parts of ToolContact.
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_server/contact/tool_contact.h"

namespace palpate::sim {
namespace {

constexpr double kGrazes = 0.1;    // of the tool radius: what the surface beside a touched one may bulge by
constexpr double kMaxPlaces = 64;  // on the axis of a tool that appears: whether they are inside

}  // namespace

/// True if a tool in contact has left the free organ so far behind that it only drags the surface along with
/// it: a linear tissue would let itself be wrapped around the tool and follow it anywhere.
bool ToolContact::escaped(const ToolPose& pose, const ToolTissue& tissue) const noexcept {
  if (now_.force.contacts == 0 || touchable().empty()) return false;
  const Vec3 &p = pose.p_W, far = far_end(tool_, pose);
  // Mostly what it pressed most is near enough, and nothing else need be looked at.
  if (now_.side >= 0 && (tissue.free()[now_.side] - p).norm() <= max_drag_) return false;
  const double distance = tool_.is_sphere() ? (finder_.nearest(tissue.free(), p) - p).norm()
                                            : finder_.nearest(tissue.free(), p, far).distance;
  return distance > max_drag_ && !finder_.inside(tissue.free(), p);
}

/// The tool appears at `pose`. If part of its axis is inside the organ, it is taken to have come in where it
/// last touched the surface, or else through the surface nearest to the deepest place of the axis, as it is
/// turned now, but for what is held.
void ToolContact::place_outside(const ToolPose& pose, ToolTissue tissue) {
  release(tissue);
  now_.placed = true;
  now_.place = pose;
  const Vec3 axis = far_end(tool_, pose) - pose.p_W;
  const double pieces = std::min(std::ceil(axis.norm() / tool_.radius), kMaxPlaces);
  const bool touched = now_.side >= 0;
  double chosen = touched ? std::numeric_limits<double>::max() : -1;  // m
  for (double i = 0; i <= pieces; ++i) {
    const double fraction = pieces > 0 ? i / pieces : 0;
    const Vec3 x = pose.p_W + fraction * axis;
    if ((tool_.trocar && 1 - fraction < kNearPivot) || !finder_.inside(tissue.positions(), x)) continue;
    const Vec3 entry = touched ? tissue.positions()[now_.side] : finder_.entry(tissue.positions(), x);
    const double distance = (entry - x).norm();
    if (touched ? distance >= chosen : distance <= chosen) continue;
    chosen = distance;
    now_.place.p_W = place_at_entry(pose, x, fraction, entry);
  }
}

/// True if the tissue has closed over a tool that touched it, as after a change of shape beyond what its
/// compliance predicted. Then the tool stands before the surface again, without a load, and has not arrived.
/// Where that is farther away than a tool drags tissue, the surface is that of an equilibrium that was not
/// found: the tool stays, without a load.
bool ToolContact::recover_from_inside(ToolTissue tissue) {
  const ToolPose there = now_.place;
  if (!finder_.inside(tissue.positions(), there.p_W + now_.tip_offset)) return false;
  place_outside(there, tissue);
  const double back = (now_.place.p_W - there.p_W).norm();
  if (back > max_drag_) now_.place = there;
  return back > 0;
}

/// Returns where the tip was when the place `inside` on the axis, at that share of it, stood before `entry`.
Vec3 ToolContact::place_at_entry(const ToolPose& pose, const Vec3& inside, double fraction,
                                 const Vec3& entry) const noexcept {
  const Vec3 outward = (entry - inside).normalized();
  const Vec3 outside = entry + tool_.radius * (outward.allFinite() ? outward : Vec3(Vec3::UnitY()));
  if (tool_.trocar && fraction > 0)
    return tool_.trocar->pivot_W + (outside - tool_.trocar->pivot_W) / (1 - fraction);
  return outside + (pose.p_W - inside);
}

double ToolContact::depth_outside_reach(std::span<const Vec3> positions) const noexcept {
  if (!now_.placed) return 0;
  const ToolPose tip(now_.place.p_W + now_.tip_offset, now_.place.q_W);
  const double depth = finder_.depth_beyond(positions, tip.p_W, far_end(tool_, tip), tool_.radius);
  return depth > kGrazes * tool_.radius ? depth : 0;
}

void ToolContact::store_side(const ToolTissue& tissue) noexcept {
  now_.side = -1;
  double most = 0;
  for (const VertexLoad& load : tissue.loads()) {
    if (load.force.squaredNorm() <= most) continue;
    most = load.force.squaredNorm();
    now_.side = load.vertex;
  }
}

}  // namespace palpate::sim
