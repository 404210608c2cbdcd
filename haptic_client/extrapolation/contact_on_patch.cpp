#include "haptic_client/extrapolation/contact_on_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/contact/simplex_distance.h"

namespace palpate::client {
namespace {

constexpr int kMostNodes = 96, kMostTriangles = 160;  // a flat patch has fewer than two triangles a node
// Of the tool radius: how far from the tool a patch reaches, on the deformed surface; and how far the tool
// may go on it, as what it presses may move as far again.
constexpr double kMargin = 0.25, kLongestIncrement = 0.12;
constexpr double kMostIncrements = 16, kMostEntering = 32;  // a tick
constexpr double kLeastDepth = 1e-4;                        // of the tool radius
constexpr int kFarCreepAge = 16;                            // increments
constexpr int kMostNear = 2048;  // vertices: a compliance by which more come near the tool is none

}  // namespace

ContactOnPatch::ContactOnPatch(const Accuracy& accuracy)
    : accuracy_(accuracy),
      without_friction_(kMostNodes, kMostTriangles),
      with_friction_(kMostNodes, kMostTriangles, true),
      slot_of_vertex_(SurfaceModel::kMostVertices, -1),
      near_{.is_near = std::vector<char>(SurfaceModel::kMostVertices),
            .moved = std::vector<Vec3>(SurfaceModel::kMostVertices),
            .crept = std::vector<Vec3>(SurfaceModel::kMostVertices, Vec3::Zero()),
            .went = std::vector<Vec3>(SurfaceModel::kMostVertices, Vec3::Zero())},
      u_(3 * (kMostNodes + 1)),
      u_before_(3 * (kMostNodes + 1)) {
  patch_.reserve(kMostNodes, kMostTriangles);
  vertices_.reserve(kMostNodes);
  start_.reserve(kMostNodes);
  loads_.reserve(kMostNodes);
  stored_loads_.reserve(kMostNodes);
  shapes_.reserve(kMostNodes);
  far_.creep.reserve(kMostNodes);
}

/// Smoothed, so that one tick that began late or early changes little.
void ContactOnPatch::bear(Time tick) noexcept {
  if (tick <= Time::zero()) return;
  const double bearable = std::min(kMostWork, kWorkPerSecond * to_seconds(tick));
  most_work_ += (bearable - most_work_) / 8;
}

void ContactOnPatch::separate() noexcept {
  ++solves_;
  state_ = {};
  motion_.setZero();
  loads_.clear();
}

std::optional<Vec3> ContactOnPatch::move_to(const Surface& surface, const Vec3& p,
                                            const ModalMemory* memory) noexcept {
  if ((memory != nullptr) != (memory_ != nullptr)) separate();  // its patch was taken for another frame
  memory_ = memory;
  const double longest = kLongestIncrement * surface.tool.radius;
  const bool too_far = state_.placed && (p - state_.place).norm() > kMostIncrements * longest;
  if (version_ != surface.model->generation() || too_far) separate();
  // With friction, the path is lost.
  if (!surface.model->has_shape() || !p.allFinite() || (too_far && surface.tool.friction > 0)) {
    separate();
    return {};
  }
  work_remaining_ = most_work_;
  const double most = state_.placed ? kMostIncrements : kMostEntering;
  if (!state_.placed) enter(surface, p);
  if (const Vec3 motion = p - state_.place; state_.contacts > 0 && motion.norm() <= near(surface)) {
    const Vec3 force = state_.force + state_.tangent * motion;
    return force.dot(state_.force) > 0 ? force : Vec3(Vec3::Zero());
  }
  const Vec3 from = state_.place, motion = p - state_.place;
  const double increments = std::max(std::ceil(motion.norm() / longest), 1.0);
  bool found = increments <= most;
  for (double i = 1; found && i <= increments; ++i)
    found = increment(surface, i == increments ? p : Vec3(from + (i / increments) * motion));
  if (found) return state_.force;
  separate();
  return {};
}

std::optional<Vec3> ContactOnPatch::probe(const Surface& surface, const Vec3& p,
                                          const ModalMemory* memory) noexcept {
  const State stored = state_;
  stored_loads_ = loads_;
  auto force = move_to(surface, p, memory);
  loads_ = stored_loads_;
  state_ = stored;
  if (state_.placed && !take_patch(surface, state_.place)) separate();
  return force;
}

/// Returns how far from the solved place the tangent leads, m. Friction follows the path more closely.
double ContactOnPatch::near(const Surface& surface) const noexcept {
  const double near = std::min(accuracy_.near * state_.depth, accuracy_.most_near * surface.tool.radius);
  return surface.tool.friction > 0 ? near / 4 : near;
}

ContactSolver::Effort ContactOnPatch::effort(const Surface& surface) const noexcept {
  const double depth = std::max(state_.depth / surface.tool.radius, kLeastDepth);
  // Where the increment before predicts where the surface goes, one look at it is mostly enough.
  return {.max_iterations = 30,
          .tolerance = std::min(accuracy_.tolerance * depth, accuracy_.most_tolerance),
          .expected = 1e-3,
          .work = work_remaining_};
}

bool ContactOnPatch::increment(const Surface& surface, const Vec3& p) noexcept {
  if ((p - center_).norm() > kLongestIncrement * surface.tool.radius && !take_patch(surface, p)) return false;
  const Vec3 tip = state_.place + state_.tip_offset, motion = p - state_.place, before = state_.force;
  const int touched = state_.contacts;
  state_.place = p;
  state_.force.setZero();
  state_.contacts = 0;
  if (patch_.triangles.empty()) return true;
  patch_.tool_compliance = surface.tool_compliance;
  if (memory_ != nullptr) warp(*surface.model);
  start_.clear();
  for (int i = 0; i < patch_.nodes(); ++i) start_.push_back(patch_.free[i] + u_.segment<3>(3 * i));
  ContactSolver& solving = solver(surface);
  const bool predicted = predict_tangent(motion);
  const ContactForce contact =
      solving.solve(patch_, surface.tool, p, displacement(), {start_, tip}, effort(surface));
  work_remaining_ -= solving.work();
  if (!contact.converged) return false;
  note_loads(solving);
  state_.force = contact.force;
  state_.contacts = contact.contacts;
  state_.depth = displacement().cwiseAbs().maxCoeff();
  if (predicted && touched == state_.contacts) {
    learn_tangent(motion, before);
  } else if (state_.contacts > 0) {
    state_.tangent = solving.tangent(patch_);
  }
  return state_.force.allFinite() && state_.tangent.allFinite() && displacement().allFinite();
}

/// Moves the surface on as it went in the last increment, by as much of that as `motion` repeats; false where
/// there is none on this patch.
bool ContactOnPatch::predict_tangent(const Vec3& motion) noexcept {
  auto u = displacement();
  auto before = u_before_.head(u.size());
  const double last = motion_.squaredNorm();
  const double fraction = last > 0 ? std::clamp(motion.dot(motion_) / last, 0.0, 1.5) : 0;
  motion_ = motion;
  before = (1 + fraction) * u - fraction * before;
  before.swap(u);  // in place: `before` is where the increment begins
  return last > 0;
}

/// Broyden's (1965) update: the tangent that gives the change of force along `motion`.
void ContactOnPatch::learn_tangent(const Vec3& motion, const Vec3& force_before) noexcept {
  const double size = motion.squaredNorm();
  if (!(size > 0)) return;
  state_.tangent += (state_.force - force_before - state_.tangent * motion) / size * motion.transpose();
}

/// Notes the loads of the patch nodes, which is all that is needed to continue from here.
void ContactOnPatch::note_loads(const ContactSolver& solved) noexcept {
  const auto forces = solved.node_forces();
  ++solves_;
  loads_.clear();
  for (int i = 0; i < patch_.nodes(); ++i) {
    if (!forces.segment<3>(3 * i).isZero(0)) loads_.push_back({vertices_[i], forces.segment<3>(3 * i)});
  }
  state_.tip_offset = u_.segment<3>(3 * patch_.nodes());
}

/// Notes how the nodes of the patch went in the last increment, so that the next patch knows; returns that of
/// the tip.
Vec3 ContactOnPatch::note_directions(std::size_t vertices) noexcept {
  std::fill_n(near_.went.begin(), vertices, Vec3::Zero());
  if (motion_.isZero(0)) return Vec3::Zero();
  const auto went = [&](int slot) -> Vec3 {
    return u_.segment<3>(3 * slot) - u_before_.segment<3>(3 * slot);
  };
  for (int i = 0; i < patch_.nodes(); ++i) near_.went[vertices_[i]] = went(i);
  return went(patch_.nodes());
}

/// The patch around a tool at `p`, under the loads that are on the surface.
bool ContactOnPatch::take_patch(const Surface& surface, const Vec3& p) noexcept {
  if (version_ != surface.model->generation()) motion_.setZero();
  version_ = surface.model->generation();
  center_ = p;
  const Vec3 tip_went = note_directions(surface.model->rest().size());
  if (!displace_near(surface, p) || !take_triangles(surface, p) || !take_compliance(*surface.model) ||
      !take_shapes(*surface.model))
    return false;
  find_far_creep(*surface.model);
  for (int i = 0; i < patch_.nodes(); ++i) {
    u_.segment<3>(3 * i) = near_.moved[vertices_[i]];
    u_before_.segment<3>(3 * i) = near_.moved[vertices_[i]] - near_.went[vertices_[i]];
  }
  u_.segment<3>(3 * patch_.nodes()) = state_.tip_offset;
  u_before_.segment<3>(3 * patch_.nodes()) = state_.tip_offset - tip_went;
  return std::ranges::all_of(loads_,
                             [&](const VertexLoad& load) { return slot_of_vertex_[load.vertex] >= 0; });
}

/// Finds where the loads have moved what may be near the tool; nothing moves farther than what they press.
bool ContactOnPatch::displace_near(const Surface& surface, const Vec3& p) noexcept {
  const SurfaceModel& model = *surface.model;
  const auto rest = model.rest();
  std::fill_n(near_.is_near.begin(), rest.size(), 0);
  int count = 0;
  const auto displace = [&](int vertex) {
    if (++count > kMostNear) return false;
    Vec3 u = Vec3::Zero();
    for (const VertexLoad& load : loads_) {
      const auto c = model.compliance(vertex, load.vertex);
      if (!c) return false;
      u += *c * load.force;
    }
    near_.moved[vertex] = u;
    near_.crept[vertex] =
        memory_ != nullptr ? Vec3(memory_->creep(model, vertex) - memory_->crept()) : Vec3(Vec3::Zero());
    near_.is_near[vertex] = 1;
    return true;
  };
  double largest = memory_ != nullptr ? memory_->crept().norm() : 0;
  for (const VertexLoad& load : loads_) {
    if (!displace(load.vertex)) return false;
    largest = std::max(largest, (near_.moved[load.vertex] + near_.crept[load.vertex]).norm());
  }
  const double reach = (1 + 2 * kMargin) * surface.tool.radius + largest;
  const double surely = reach + model.longest_edge();
  for (const auto& t : model.triangles()) {
    if ((rest[t[0]] - p).squaredNorm() > surely * surely) continue;
    if (near_.is_near[t[0]] != 0 && near_.is_near[t[1]] != 0 && near_.is_near[t[2]] != 0) continue;
    const auto w = closest_point(p, rest[t[0]], rest[t[1]], rest[t[2]]).weight;
    if ((w[0] * rest[t[0]] + w[1] * rest[t[1]] + w[2] * rest[t[2]] - p).squaredNorm() > reach * reach)
      continue;
    for (const int vertex : t) {
      if (near_.is_near[vertex] == 0 && !displace(vertex)) return false;
    }
  }
  return true;
}

/// Those near the tool on the deformed surface.
bool ContactOnPatch::take_triangles(const Surface& surface, const Vec3& p) noexcept {
  const auto rest = surface.model->rest();
  const double reach = (1 + kMargin) * surface.tool.radius;
  const Vec3 tip = p + state_.tip_offset;
  const auto is_placed = [&](int vertex) -> Vec3 {
    return rest[vertex] + near_.moved[vertex] + near_.crept[vertex];
  };
  for (const int vertex : vertices_) slot_of_vertex_[vertex] = -1;
  vertices_.clear();
  patch_.triangles.clear();
  patch_.free.clear();
  for (const auto& t : surface.model->triangles()) {
    if (near_.is_near[t[0]] == 0 || near_.is_near[t[1]] == 0 || near_.is_near[t[2]] == 0) continue;
    const Vec3 a = is_placed(t[0]), b = is_placed(t[1]), c = is_placed(t[2]);
    const auto w = closest_point(tip, a, b, c).weight;
    if ((w[0] * a + w[1] * b + w[2] * c - tip).squaredNorm() > reach * reach) continue;
    if (patch_.triangles.size() == kMostTriangles || vertices_.size() + 3 > kMostNodes) return false;
    std::array<int, 3> local;
    for (int i = 0; i < 3; ++i) {
      int& slot = slot_of_vertex_[t[i]];
      if (slot < 0) {
        slot = static_cast<int>(vertices_.size());
        vertices_.push_back(t[i]);
        patch_.free.push_back(rest[t[i]]);
      }
      local[i] = slot;
    }
    patch_.triangles.push_back(local);
  }
  return true;
}

bool ContactOnPatch::take_compliance(const SurfaceModel& model) noexcept {
  patch_.compliance.shape(3 * patch_.nodes(), 3 * patch_.nodes());
  for (int j = 0; j < patch_.nodes(); ++j) {
    for (int i = 0; i <= j; ++i) {
      const auto block = model.compliance(vertices_[i], vertices_[j]);
      if (!block) return false;
      patch_.compliance.block<3, 3>(3 * i, 3 * j) = *block;
      patch_.compliance.block<3, 3>(3 * j, 3 * i) = block->transpose();
    }
  }
  return true;
}

bool ContactOnPatch::take_shapes(const SurfaceModel& model) noexcept {
  if (memory_ == nullptr) return true;
  shapes_.resize(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    shapes_[i].fill(Vec3::Zero());
    if (!model.add_shapes(vertices_[i], 1, shapes_[i])) return false;
  }
  return true;
}

/// Updates where the patch is free of the tool, by the published modes of now and by what has crept.
void ContactOnPatch::warp(const SurfaceModel& model) noexcept {
  if (!memory_->creeping().empty() && ++far_.age > kFarCreepAge) find_far_creep(model);
  for (int i = 0; i < patch_.nodes(); ++i)
    patch_.free[i] = model.rest()[vertices_[i]] + memory_->warp(shapes_[i]) + creep_of(i) - memory_->crept();
}

/// Returns how far a patch node has crept, m.
Vec3 ContactOnPatch::creep_of(int node) const noexcept {
  Vec3 sum = far_.creep[node];
  for (const VertexLoad& load : memory_->creeping()) {
    const int slot = slot_of_vertex_[load.vertex];
    if (slot >= 0) sum += patch_.compliance.block<3, 3>(3 * node, 3 * slot) * load.force;
  }
  return sum;
}

/// Loads beyond the patch only fade: what they do need not be found at each increment.
void ContactOnPatch::find_far_creep(const SurfaceModel& model) noexcept {
  far_.age = 0;
  far_.creep.assign(vertices_.size(), Vec3::Zero());
  if (memory_ == nullptr) return;
  for (const VertexLoad& load : memory_->creeping()) {
    if (slot_of_vertex_[load.vertex] >= 0) continue;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (const auto c = model.compliance(vertices_[i], load.vertex)) far_.creep[i] += *c * load.force;
    }
  }
}

/// The tool appears at `p`. If that is inside the surface it is taken to have come in through the nearest
/// part of it.
void ContactOnPatch::enter(const Surface& surface, const Vec3& p) noexcept {
  const auto rest = surface.model->rest();
  state_.placed = true;
  state_.place = p;
  center_.setConstant(std::numeric_limits<double>::max());  // no patch yet
  double best = std::numeric_limits<double>::max(), side = 0;
  Vec3 entry = p;
  for (const auto& t : surface.model->triangles()) {
    const Vec3 &a = rest[t[0]], &b = rest[t[1]], &c = rest[t[2]];
    const auto w = closest_point(p, a, b, c).weight;
    const Vec3 q = w[0] * a + w[1] * b + w[2] * c;
    const double distance = (p - q).norm(), out = (p - q).dot((b - a).cross(c - a).normalized());
    // Of triangles that share the closest point, the one that faces it most says on which side it is.
    const bool same = std::abs(distance - best) < 1e-9;
    if (same ? std::abs(out) <= std::abs(side) : distance > best) continue;
    best = std::min(distance, best);
    side = out;
    entry = q;
  }
  if (!(side < 0)) return;
  state_.place = entry + surface.tool.radius * (entry - p).normalized();
  if (!state_.place.allFinite()) state_.place = p;
}

}  // namespace palpate::client
