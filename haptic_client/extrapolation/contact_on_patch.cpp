#include "haptic_client/extrapolation/contact_on_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/contact/simplex_distance.h"

namespace palpate::client {
namespace {

constexpr int kMostNodes = 160, kMostTriangles = 320;
constexpr double kStride = 0.5;     // of the tool radius, as on the server
constexpr double kMostStrides = 8;  // a tick
constexpr double kSlack = 0.35;     // of the tool radius: how far the tool goes before the next patch
constexpr double kMargin = 0.1;     // of the tool radius: how far around what is touched

Vec3 closest(const SurfaceModel& model, const std::array<int, 3>& t, const Vec3& p) noexcept {
  const auto x = model.rest();
  const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
  const auto w = closest_point(p, a, b, c).weight;
  return w[0] * a + w[1] * b + w[2] * c;
}

}  // namespace

ContactOnPatch::ContactOnPatch()
    : solver_(kMostNodes, kMostTriangles),
      slot_of_vertex_(SurfaceModel::kMostVertices, -1),
      u_(3 * (kMostNodes + 1)),
      kept_u_(3 * (kMostNodes + 1)) {
  patch_.reserve(kMostNodes, kMostTriangles);
  vertices_.reserve(kMostNodes);
  loads_.reserve(kMostNodes);
}

std::optional<Vec3> ContactOnPatch::go(const SurfaceModel& model, const SphereTool& tool,
                                       double tool_compliance, const Vec3& p) noexcept {
  if (!model.has_shape() || !p.allFinite()) {
    lift();
    return {};
  }
  patch_.tool_compliance = tool_compliance;
  const double stride = kStride * tool.radius;
  if (version_ != model.version() || (p - place_).norm() > kMostStrides * stride) lift();
  if (!cover(model, tool, p)) {
    lift();
    return {};
  }
  if (!placed_) enter(tool, p);
  const Vec3 from = place_, way = p - place_;
  const double strides = std::max(std::ceil(way.norm() / stride), 1.0);
  Vec3 force = Vec3::Zero();
  for (double i = 1; i <= strides; ++i) {
    place_ = i == strides ? p : Vec3(from + (i / strides) * way);
    force = solver_.solve(patch_, tool, place_, displacement()).force;
  }
  if (force.allFinite() && displacement().allFinite()) return force;
  lift();
  return {};
}

std::optional<Vec3> ContactOnPatch::probe(const SurfaceModel& model, const SphereTool& tool,
                                          double tool_compliance, const Vec3& p) noexcept {
  return go(model, tool, tool_compliance, p);
}

double ContactOnPatch::largest_displacement() const noexcept {
  return placed_ ? u_.head(3 * (patch_.nodes() + 1)).cwiseAbs().maxCoeff() : 0;
}

/// Sees to it that the patch has everything that a tool at `p` may touch, which at rest lies as far from it
/// as the tool reaches and the surface moves.
bool ContactOnPatch::cover(const SurfaceModel& model, const SphereTool& tool, const Vec3& p) noexcept {
  const double needed = (1 + kMargin) * tool.radius + largest_displacement();
  if (placed_ && (p - center_).norm() + needed <= reach_) return true;
  loads_.clear();
  if (placed_) {
    const auto forces = solver_.node_forces();
    for (int i = 0; i < patch_.nodes(); ++i) {
      if (!forces.segment<3>(3 * i).isZero(0)) loads_.emplace_back(vertices_[i], forces.segment<3>(3 * i));
    }
  }
  const Vec3 tip = u_.segment<3>(3 * patch_.nodes());
  if (!gather(model, p, needed + kSlack * tool.radius)) return false;
  auto u = displacement();
  u.setZero();
  if (!placed_) return true;
  u.tail<3>() = tip;
  for (const auto& [vertex, force] : loads_) {
    const int slot = slot_of_vertex_[vertex];
    if (slot < 0) return false;  // a load left the patch: it jumped
    for (int axis = 0; axis < 3; ++axis)
      u.head(3 * patch_.nodes()) +=
          force[axis] * patch_.compliance.col(3 * slot + axis).head(3 * patch_.nodes());
  }
  return true;
}

bool ContactOnPatch::gather(const SurfaceModel& model, const Vec3& p, double reach) noexcept {
  for (const int vertex : vertices_) slot_of_vertex_[vertex] = -1;
  vertices_.clear();
  patch_.triangles.clear();
  patch_.free.clear();
  center_ = p;
  reach_ = reach;
  version_ = model.version();
  const auto triangles = model.triangles();
  for (const auto& t : triangles) {
    if ((closest(model, t, p) - p).squaredNorm() > reach * reach) continue;
    if (patch_.triangles.size() == kMostTriangles || vertices_.size() + 3 > kMostNodes) return false;
    std::array<int, 3> local;
    for (int i = 0; i < 3; ++i) {
      int& slot = slot_of_vertex_[t[i]];
      if (slot < 0) {
        slot = static_cast<int>(vertices_.size());
        vertices_.push_back(t[i]);
        patch_.free.push_back(model.rest()[t[i]]);
      }
      local[i] = slot;
    }
    patch_.triangles.push_back(local);
  }
  return gather_compliance(model);
}

bool ContactOnPatch::gather_compliance(const SurfaceModel& model) noexcept {
  constexpr int kStrideOfTile = SurfaceModel::kTileStride;
  const int m = patch_.nodes();
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i <= j; ++i) {
      const auto [data, transposed] = model.compliance(vertices_[i], vertices_[j]);
      if (data == nullptr) return false;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          const double c = data[transposed ? column * kStrideOfTile + row : row * kStrideOfTile + column];
          patch_.compliance(3 * i + row, 3 * j + column) = c;
          patch_.compliance(3 * j + column, 3 * i + row) = c;
        }
      }
    }
  }
  return true;
}

/// The tool appears at `p`. If that is inside the surface it is taken to have come in through the nearest
/// part of it.
void ContactOnPatch::enter(const SphereTool& tool, const Vec3& p) noexcept {
  displacement().setZero();
  placed_ = true;
  place_ = p;
  double best = std::numeric_limits<double>::max(), side = 0;
  Vec3 door = p;
  for (const auto& t : patch_.triangles) {
    const Vec3 &a = patch_.free[t[0]], &b = patch_.free[t[1]], &c = patch_.free[t[2]];
    const auto w = closest_point(p, a, b, c).weight;
    const Vec3 q = w[0] * a + w[1] * b + w[2] * c;
    const double distance = (p - q).norm();
    const double out = (p - q).dot((b - a).cross(c - a).normalized());
    // Triangles that share the closest point: the one that faces it most decides on which side it is.
    const bool same = std::abs(distance - best) < 1e-9;
    if (!same && distance > best) continue;
    if (same && std::abs(out) < std::abs(side)) continue;
    best = std::min(distance, best);
    side = out;
    door = q;
  }
  if (!(side < 0)) return;
  place_ = door + tool.radius * (door - p).normalized();
  if (!place_.allFinite()) place_ = p;
}

}  // namespace palpate::client
