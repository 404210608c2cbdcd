#include "sim_server/contact/tool_contact.h"

#include <algorithm>
#include <cmath>

#include "common/units.h"
#include "sim_server/mesh/bounding_box.h"

namespace palpate::sim {
namespace {

constexpr double kIncrement = 0.5;  // of the tool radius: how far the tool goes between two contact solves
// With friction, which follows the path: shorter, as many as a step has time for; and a part as long in a
// step that turns off the increment before, whose slip says nothing about it (the cosine of the angle), and
// where the tissue sticks to the tool (the slip, of the way): there each new contact sticks from where it
// begins.
constexpr double kFrictionIncrement = 0.08, kFrictionIncrements = 16, kCorner = 0.5, kSticks = 0.5;
constexpr double kShorterInCorner = 2, kShorterInStick = 8;
// Of the increment before: how long the next may be for the slip of both to count.
constexpr double kLongerIncrement = 2;
constexpr double kMaxJump = 0.1;        // of the tool radius: what the surface may move by at once
constexpr double kGather = 1.5;         // of the tool radius: how far from the tip the patch extends
constexpr double kRoomOfAxis = 2.0;     // the same, as room is made for a tool that lies along the surface
constexpr double kMaxIncrements = 256;  // in a step: a tool that goes further is placed anew
// Of the tool radius: how far it presses on in one step, where the tissue is known only near its last shape.
constexpr double kMaxPress = 2.0;
// How far outside its free organ contact may go on: of the tool radius, and of the organ's size, whichever is
// more. A thin organ that bends is soon outside itself.
constexpr double kMaxDrag = 3.0, kMaxBend = 0.5;
// Contact linearisations a step may use, on its path and to settle with other tools, before it answers from
// where it got to.
constexpr int kMaxIterations = 400, kMaxSettling = 400;
// Of an increment with friction: how far things end from where those of the one before went on to.
constexpr double kForeseen = 0.1;

/// Returns how much of the tool's axis can be near the organ, m.
double longest_axis(const Tool& tool, std::span<const Vec3> rest) {
  if (!tool.trocar) return tool.length;
  double longest = 0;
  for (const Vec3& x : rest) longest = std::max(longest, (x - tool.trocar->pivot_W).norm());
  return longest;
}

}  // namespace

ToolContact::ToolContact(const ToolSettings& tool, std::span<const Vec3> rest, const Surface& surface,
                         std::vector<Triangle> touchable, std::span<const int> held, bool cut)
    : tool_(tool.shape),
      finder_(rest, touchable.empty() ? touchable : surface.triangles, touchable,
              (tool.shape.is_sphere() ? kGather : kRoomOfAxis) * tool.shape.radius,
              longest_axis(tool.shape, rest), held,
              cut ? ContactFinder::kRoomOfCuts : ContactFinder::kUsualRoom),
      solver_(finder_.max_nodes(), finder_.max_triangles(), tool.shape.friction > 0),
      max_drag_(std::max(kMaxDrag * tool.shape.radius, kMaxBend * diagonal_of(rest))) {
  if (tool.grasps()) grip_.emplace(tool, rest, touchable, finder_.max_nodes());
  patch_.reserve(finder_.max_nodes(), finder_.max_triangles());
  filled_.reserve(static_cast<std::size_t>(finder_.max_nodes()));
  if (tool.grasp_place) {  // no contact gathers what it holds from the start
    const ToolPose from(*tool.grasp_place);
    finder_.gather(rest, rest, from.p_W, far_end(tool_, from), kGather * tool_.radius, patch_);
  }
  displacement_.resize(3 * (finder_.max_nodes() + 1));
  predicted_.resize(3 * finder_.max_nodes());
  predictor_.changes.reserve(static_cast<std::size_t>(finder_.max_nodes()));
  stored_predictor_.changes.reserve(static_cast<std::size_t>(finder_.max_nodes()));
  stored_loads_.reserve(static_cast<std::size_t>(finder_.max_nodes()));
  if (!has_friction()) return;
  surface_was_.assign(rest.begin(), rest.end());
  for (Trend* const trend : {&trend_, &stored_trend_}) {
    trend->travel.surface.reserve(static_cast<std::size_t>(finder_.max_nodes()));
    trend->forces.reserve(static_cast<std::size_t>(finder_.max_nodes() + finder_.max_triangles()));
  }
  before_.surface.reserve(static_cast<std::size_t>(finder_.max_nodes()));
  nodes_were_.reserve(static_cast<std::size_t>(finder_.max_nodes()));
}

/// Returns the touchable triangles that were in its patch before, when their corners were not yet copies.
std::vector<Triangle> ToolContact::left_of_patch(const SurfaceChange& change,
                                                 std::span<const Triangle> touchable) const {
  const std::span<const int> nodes = finder_.vertices();
  std::vector<Triangle> before;
  for (const Triangle& t : patch_.triangles) before.push_back({nodes[t[0]], nodes[t[1]], nodes[t[2]]});
  std::ranges::sort(before);
  const std::map<int, int> origins = change.origins();
  std::vector<Triangle> left;
  for (const Triangle& t : touchable) {
    Triangle was = t;
    for (int& corner : was) {
      if (const auto origin = origins.find(corner); origin != origins.end()) corner = origin->second;
    }
    if (std::ranges::binary_search(before, was)) left.push_back(t);
  }
  return left;
}

void ToolContact::change_surface(const SurfaceChange& change, std::vector<Triangle> touchable) {
  if (grip_) grip_->change_surface(change, touchable);
  if (holds()) finder_.take(left_of_patch(change, touchable), patch_);  // nothing gathers it again
  finder_.change_surface(change.rest, touchable.empty() ? touchable : change.surface.triangles, touchable);
  filled_.clear();
  predictor_.changes.clear();
  stored_predictor_.changes.clear();
  for (Trend* const trend : {&trend_, &stored_trend_}) {
    trend->travel.surface.clear();
    trend->forces.clear();
  }
  change.apply_to(stored_loads_);
  for (State* const state : {&now_, &stored_}) {
    if (state->side >= 0 && !change.on_surface(state->side)) state->side = -1;
  }
}

void ToolContact::advance_to(const ToolPose& pose, const Bend& path, ToolTissue tissue) {
  open_grip(tissue);
  way_.bend = path;
  move_to(pose, tissue);
  way_.bend = {};
  close_grip(tissue);
}

void ToolContact::open_grip(ToolTissue tissue) {
  if (!grip_ || !grip_->opens()) return;
  release(tissue);
  separate();
}

void ToolContact::close_grip(ToolTissue tissue) {
  if (!grip_ || !grip_->closes() || !now_.placed || !now_.arrived) return;
  grip_->close(now_.place, tissue.positions());
  if (holds()) solve_grasp(now_.place, tissue);
}

/// Moves what it holds with it, straight to `pose`.
void ToolContact::solve_grasp(const ToolPose& pose, ToolTissue tissue) {
  now_.placed = now_.arrived = true;
  now_.place = pose;
  now_.tip_offset.setZero();
  const Grip::Pull pull = grip_->pull(pose, tissue);
  tissue.mark_solved(grip_->vertices());
  if (!pull.force.allFinite()) return reject(tissue);
  now_.grasp_tangent = pull.tangent;
  now_.force = {.force = pull.force,
                .torque = pull.torque,
                .tangent = pull.tangent,
                .contacts = pull.vertices,
                .iterations = pull.rounds,
                .flagged = !pull.converged};
}

void ToolContact::move_to(const ToolPose& pose, ToolTissue tissue) {
  if (holds() && is_tame(pose)) return solve_grasp(pose, tissue);
  if (!start_way(pose, way_.bend, tissue)) return;
  ContactForce contact;
  for (int i = 1; i <= way_.increments && !has_stopped(tissue); ++i) {
    go_on(i, way_.increments, tissue);
    contact = solve_contact(tissue);
    note(contact, tissue);
  }
  end_way(contact, tissue);
}

/// False of a position that no tool has.
bool ToolContact::is_tame(const ToolPose& pose) noexcept {
  return pose.p_W.allFinite() && pose.p_W.cwiseAbs().maxCoeff() <= kMaxCoordinate &&
         pose.q_W.coeffs().allFinite();
}

bool ToolContact::start_way(const ToolPose& pose, Bend path, ToolTissue tissue) {
  way_ = {};
  if (!is_tame(pose)) {
    reject(tissue);
    return false;
  }
  way_.lost = now_.placed && escaped(pose, tissue);
  const bool anew = !now_.placed || way_.lost ||
                    (pose.p_W - now_.place.p_W).norm() > kMaxIncrements * kIncrement * tool_.radius;
  if (!anew && now_.arrived) way_.bend = path;
  if (anew) place_outside(pose, tissue);
  way_.from = now_.place;
  way_.to = pose;
  way_.motion = pose.p_W - now_.place.p_W;
  way_.surface = anew ? 0 : surface_motion(tissue);
  way_.increments =
      static_cast<int>(std::max(increments_to(pose), increments_for(way_.motion.norm(), way_.surface)));
  way_.touched = now_.force.contacts > 0;
  return true;
}

void ToolContact::start_settling(ToolTissue tissue) {
  way_ = {};
  way_.from = way_.to = now_.place;
  way_.surface = surface_motion(tissue);
  way_.increments = static_cast<int>(increments_for(0, way_.surface));
  way_.again = true;
  way_.touched = now_.force.contacts > 0;
  way_.iterations = now_.force.iterations;
}

void ToolContact::go_on(int increment, int of, ToolTissue tissue) {
  if (!way_.again) start_increment(increment == 1, tissue);
  const double fraction = static_cast<double>(increment) / of;
  if (way_.surface > 0) tissue.set_remaining_fraction(1 - fraction);
  way_.length = way_.motion.norm() / of / tool_.radius;
  if (way_.again) return;
  now_.place = increment == of
                   ? way_.to
                   : ToolPose(way_.from.p_W + fraction * way_.motion + path_offset(fraction, way_.motion),
                              way_.from.q_W.slerp(fraction, way_.to.q_W));
}

bool ToolContact::has_stopped(const ToolTissue& tissue) const {
  const int most = way_.again ? kMaxIterations + kMaxSettling : kMaxIterations;
  const bool anywhere = tissue.traits().constant_compliance;
  return way_.stopped || way_.iterations >= most || (way_.pressed > kMaxPress && !anywhere);
}

void ToolContact::note(const ContactForce& contact, std::span<const FeatureForce> features, int index,
                       ToolTissue tissue) {
  const bool touched = way_.pressed > 0 || way_.touched;
  way_.iterations += contact.iterations;
  note_trend(contact, features, index, tissue);
  if (contact.contacts > 0) way_.pressed += way_.length;
  if (contact.contacts == 0 && touched && recover_from_inside(tissue)) way_.stopped = true;
}

void ToolContact::end_way(const ContactForce& contact, ToolTissue tissue) {
  tissue.set_remaining_fraction(0);
  // Else the next step goes on from here.
  now_.arrived = now_.place.p_W == way_.to.p_W && now_.place.q_W.coeffs() == way_.to.q_W.coeffs();
  set_force(contact, way_.iterations, tissue);
  if (way_.lost) flag();
}

/// Returns how far the surface near the tool has gone since contact was last solved, m; 0: not so far that
/// the tool need meet it in parts.
double ToolContact::surface_motion(ToolTissue tissue) const {
  const double surface =
      tissue.surface_motion(now_.place.p_W, far_end(tool_, now_.place), kGather * tool_.radius);
  return surface > kMaxJump * tool_.radius ? surface : 0;
}

/// Returns in how many increments they move where the surface comes along by `surface` (m) while the tool
/// goes by `motion` (m).
double ToolContact::increments_for(double motion, double surface) const noexcept {
  if (surface == 0) return 1;
  return std::clamp(std::ceil((motion + surface) / (kIncrement * tool_.radius)), 1.0, kMaxIncrements);
}

double ToolContact::increments_to(const ToolPose& pose) const noexcept {
  // A far end goes around the tip on an arc, which is longer than its chord; with friction the surface
  // counts.
  const double around = tool_.length + (has_friction() && !tool_.trocar ? tool_.radius : 0),
               turn = around > 0 ? around * now_.place.q_W.angularDistance(pose.q_W) : 0;
  const double motion = (pose.p_W - now_.place.p_W).norm() + turn;
  const double increments = std::clamp(std::ceil(motion / (kIncrement * tool_.radius)), 1.0, kMaxIncrements);
  if (!has_friction()) return increments;
  const Vec3 way = pose.p_W - now_.place.p_W, &before = trend_.travel.way;
  const bool turns = way.dot(before) < kCorner * way.norm() * before.norm();
  const double shorter = sticks(trend_.travel) ? kShorterInStick
                         : turns               ? kShorterInCorner
                                               : 1,
               wanted = std::ceil(shorter * motion / (kFrictionIncrement * tool_.radius));
  return std::max(increments, std::min(wanted, kFrictionIncrements));
}

/// Returns how far, at a fraction of the path, the cubic through both poses and velocities is from the line
/// (Hermite). Never farther than a quarter of it, or of an increment without friction, whatever the
/// velocities.
Vec3 ToolContact::path_offset(double fraction, const Vec3& motion) const noexcept {
  if (!has_friction()) return Vec3::Zero();
  const double most = std::min(motion.norm(), kIncrement * tool_.radius);
  const auto bounded = [most](const Vec3& bend) -> Vec3 {
    const double size = bend.norm();
    if (!std::isfinite(size)) return Vec3::Zero();
    return size <= most ? bend : most / size * bend;
  };
  return fraction * (1 - fraction) *
         ((1 - fraction) * bounded(way_.bend.begin) - fraction * bounded(way_.bend.end));
}

Vec3 ToolContact::surface_velocity(const Vec3& p_W, const Tissue& tissue, std::span<const Vec3> velocities,
                                   std::span<const VertexLoad> loads) const noexcept {
  if (velocities.empty()) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  double weights = 0;
  for (const VertexLoad& load : loads) {
    const double weight = load.force.norm();
    sum += weight * velocities[load.vertex];
    weights += weight;
  }
  if (weights > 0) return sum / weights;
  return finder_.foot(tissue.positions, p_W).of(velocities);
}

void ToolContact::settle(ToolTissue tissue) {
  if (holds()) return solve_grasp(now_.place, tissue);
  const double surface = surface_motion(tissue), increments = increments_for(0, surface);
  ContactForce contact;
  int iterations = now_.force.iterations;
  double i = 1;
  for (; i <= increments && iterations < kMaxIterations + kMaxSettling; ++i) {
    if (surface > 0) tissue.set_remaining_fraction(1 - i / increments);
    contact = solve_contact(tissue);
    iterations += contact.iterations;
  }
  tissue.set_remaining_fraction(0);
  if (i <= increments) contact.converged = false;
  const bool may_be_inside =
      now_.force.contacts > 0 && (contact.contacts == 0 || !tissue.traits().constant_compliance);
  if (may_be_inside && recover_from_inside(tissue)) {
    now_.arrived = false;
    contact = {};
  }
  set_force(contact, iterations, tissue);
}

void ToolContact::set_force(const ContactForce& contact, int iterations, ToolTissue tissue) {
  now_.arrived ? tissue.mark_solved(finder_.vertices()) : tissue.mark_solved();
  if (!contact.force.allFinite()) return reject(tissue);
  now_.force = {.force = contact.force,
                .torque = contact.torque,
                .contacts = contact.contacts,
                .iterations = iterations,
                .flagged = !contact.converged || !now_.arrived};
  if (!now_.force.flagged) store_side(tissue);
}

const ContactPatch& ToolContact::gather(std::span<const Vec3> positions,
                                        std::span<const Vec3> free) noexcept {
  const ToolPose tip(now_.place.p_W + now_.tip_offset, now_.place.q_W);
  finder_.gather(positions, free, tip.p_W, far_end(tool_, tip), kGather * tool_.radius, patch_);
  filled_.clear();
  return patch_;
}

void ToolContact::differentiate(ToolTissue tissue) noexcept {
  if (now_.force.contacts == 0) return;
  if (holds()) return set_tangent(now_.grasp_tangent, tissue);
  differentiate(solver_, patch_, 0, filled_, tissue);
}

void ToolContact::differentiate(ContactSolver& solver, const ContactPatch& patch, int index,
                                std::span<const int> vertices, const ToolTissue& tissue) noexcept {
  set_tangent(solver.tangent(patch, index), tissue);
  if (!tissue.traits().constant_compliance) return;
  solver.for_load_changes([&](int node, const Mat3& change) {
    predictor_.changes.push_back({vertices[static_cast<std::size_t>(node)], change});
  });
}

void ToolContact::set_tangent(const Mat3& tangent, const ToolTissue& tissue) noexcept {
  now_.force.tangent = tangent;
  predictor_.changes.clear();
  predictor_.from = now_.place.p_W;
  if (tangent_time_ == 0 || tissue.traits().later == nullptr) return;
  // Tissue that gives way by so much more by then stands behind the contact like a spring in a row with it.
  const Mat3 &k = now_.force.tangent,
             yields = tissue.traits().later->later_compliance(tissue.loads(), tangent_time_);
  const Mat3 later = k * (Mat3::Identity() - yields * k).inverse();
  if (later.allFinite()) now_.force.tangent = later;
}

bool ToolContact::exhausted() const {
  return now_.force.iterations >= kMaxIterations + kMaxSettling;
}

void ToolContact::keep(std::span<const VertexLoad> loads) {
  stored_ = now_;
  stored_predictor_ = predictor_;
  stored_trend_ = trend_;
  stored_loads_.assign(loads.begin(), loads.end());
}

void ToolContact::restore(ToolTissue tissue) {
  now_ = stored_;
  predictor_ = stored_predictor_;
  trend_ = stored_trend_;
  tissue.set_loads(stored_loads_);
  tissue.apply_loads();
  tissue.mark_solved();
}

ToolForce ToolContact::probe(const Vec3& p_W, ToolTissue tissue) {
  keep(tissue.loads());
  move_to({p_W, now_.place.q_W}, tissue);
  differentiate(tissue);
  const ToolForce there = now_.force;
  restore(tissue);
  return there;
}

SurfacePlane ToolContact::nearest(const Vec3& p_W, const Tissue& tissue) const noexcept {
  if (touchable().empty()) return {};
  const Vec3 offset = p_W - finder_.nearest(tissue.positions, p_W);
  const double distance = offset.norm();
  if (!(distance > 0)) return {};
  const SurfacePlane tip{offset / distance, std::max(distance - tool_.radius, 0.0)};
  if (tool_.is_sphere()) return tip;
  const Vec3 far = far_end(tool_, {p_W, now_.place.q_W});
  const NearestOnSegment axis = finder_.nearest(tissue.positions, p_W, far);
  if (!(axis.distance > 0)) return {};
  const double radius = tool_.trocar ? tool_.trocar->shaft_radius : tool_.radius;
  // A tip that turns a shaft about its pivot has farther to go than the shaft.
  const double fraction = tool_.trocar ? std::max(1 - axis.on_segment, kNearPivot) : 1;
  const double gap = std::max(axis.distance - radius, 0.0) / fraction;
  if (gap >= tip.gap) return tip;
  const Vec3 on_axis = p_W + axis.on_segment * (far - p_W);
  return {(on_axis - axis.on_triangle) / axis.distance, gap};
}

double ToolContact::surface_strain(std::span<const Vec3> positions,
                                   std::span<const Vec3> rest) const noexcept {
  const std::span<const int> vertices = finder_.vertices();
  double least = 1, most = 1;  // squared stretch
  for (const Triangle& t : patch_.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int a = vertices[t[i]], b = vertices[t[(i + 1) % 3]];
      const double stretch = (positions[a] - positions[b]).squaredNorm() / (rest[a] - rest[b]).squaredNorm();
      least = std::min(least, stretch);
      most = std::max(most, stretch);
    }
  }
  return std::max(1 - std::sqrt(least), std::sqrt(most) - 1);
}

double ToolContact::least_area(std::span<const Vec3> positions, std::span<const Vec3> rest,
                               std::span<const char> floating) const noexcept {
  const std::span<const int> vertices = finder_.vertices();
  double least = 1;
  for (const Triangle& t : patch_.triangles) {
    if (!floating.empty() && floating[static_cast<std::size_t>(vertices[t[0]])] != 0) continue;
    const auto area = [&](std::span<const Vec3> at) -> Vec3 {
      const Vec3& corner = at[vertices[t[0]]];
      return (at[vertices[t[1]]] - corner).cross(at[vertices[t[2]]] - corner);
    };
    const Vec3 before = area(rest);
    least = std::min(least, area(positions).dot(before) / before.squaredNorm());
  }
  return least;
}

/// No answer: the tool is taken away, and enters afresh with the next step.
void ToolContact::reject(ToolTissue tissue) {
  release(tissue);
  separate();
  flag();
}

void ToolContact::separate() noexcept {
  now_.tip_offset.setZero();
  now_.placed = false;
  now_.side = -1;
  now_.force = {};
  predictor_.changes.clear();
  trend_.travel.surface.clear();
  trend_.forces.clear();
  if (grip_) grip_->open();
}

void ToolContact::start_increment(bool first, const ToolTissue& tissue) {
  if (!has_friction()) return;
  const ToolPose tip(now_.place.p_W + now_.tip_offset, now_.place.q_W);
  tip_was_ = tip;
  offset_was_ = now_.tip_offset;
  before_ = trend_.travel;
  increment_from_ = tissue.before();
  if (first) return;
  std::ranges::copy(tissue.positions(), surface_was_.begin());
  increment_from_ = surface_was_;
}

void ToolContact::note_trend(const ContactForce& contact, std::span<const FeatureForce> features, int index,
                             const ToolTissue& tissue) noexcept {
  if (!has_friction() || way_.again) return;
  trend_.travel.surface.clear();
  trend_.forces.clear();
  if (contact.contacts == 0) return;
  trend_.travel.way = now_.place.p_W + offset_was_ - tip_was_.p_W;
  trend_.travel.offset = now_.tip_offset - offset_was_;
  trend_.travel.turn = now_.place.q_W * tip_was_.q_W.conjugate();
  trend_.travel.carried.setZero();
  double pressed = 0;
  for (const VertexLoad& load : tissue.loads()) {
    const Vec3 by = tissue.positions()[load.vertex] - increment_from_[load.vertex];
    pressed += load.force.norm();
    trend_.travel.carried += load.force.norm() / pressed * (by - trend_.travel.carried);
  }
  for (const int vertex : finder_.vertices())
    trend_.travel.surface.push_back({vertex, tissue.positions()[vertex] - increment_from_[vertex]});
  for (const FeatureForce& feature : features) {
    if (feature.tool == index) trend_.forces.push_back(feature);
  }
}

/// Returns how far the tool goes on in this increment in the direction of an increment before, of that way.
double ToolContact::share_of(const Travel& travel) const noexcept {
  if (travel.surface.empty() || travel.way.isZero(0)) return 0;
  const Vec3 way = now_.place.p_W + offset_was_ - tip_was_.p_W;
  return std::clamp(way.dot(travel.way) / travel.way.squaredNorm(), 0.0, kLongerIncrement);
}

/// True if the tissue under the tool went along with it, or it touched nothing and may stick where it comes.
bool ToolContact::sticks(const Travel& travel) noexcept {
  return travel.surface.empty() || (travel.way - travel.carried).norm() < kSticks * travel.way.norm();
}

double ToolContact::slip_lead() const noexcept {
  if (sticks(before_)) return 0;  // what only came into contact meanwhile has not slipped
  // In steps: so it stays as it is while the end of the increment moves by little, as in the tangent.
  constexpr double kSteps = 8;
  const double share = std::round(kSteps * share_of(before_)) / kSteps;
  return share * share / (1 + 2 * share);
}

bool ToolContact::has_way() const noexcept {
  return now_.place.p_W + offset_was_ != tip_was_.p_W || !before_.way.isZero(0);
}

ToolPose ToolContact::slip_start(double lead) const noexcept {
  if (lead == 0) return tip_was_;
  return {tip_was_.p_W + lead * (before_.way + before_.offset),
          Quat::Identity().slerp(lead, before_.turn) * tip_was_.q_W};
}

Vec3 ToolContact::surface_lead(int vertex, double lead) const noexcept {
  const auto moved = std::ranges::find(before_.surface, vertex, &Travel::Moved::vertex);
  return moved == before_.surface.end() ? Vec3(Vec3::Zero()) : Vec3(lead * moved->by);
}

bool ToolContact::follows_trend() const noexcept {
  return !trend_.travel.surface.empty() && !way_.again && !trend_.travel.way.isZero(0);
}

Vec3 ToolContact::foreseen(int vertex) const noexcept {
  if (!follows_trend()) return Vec3::Zero();
  const auto moved = std::ranges::find(trend_.travel.surface, vertex, &Travel::Moved::vertex);
  return moved == trend_.travel.surface.end() ? Vec3(Vec3::Zero())
                                              : Vec3(share_of(trend_.travel) * moved->by);
}

Vec3 ToolContact::foreseen_tip() const noexcept {
  return follows_trend() ? Vec3(share_of(trend_.travel) * trend_.travel.offset) : Vec3(Vec3::Zero());
}

double ToolContact::uncertainty() const noexcept {
  if (!follows_trend()) return tool_.radius;
  const Vec3 way = now_.place.p_W + offset_was_ - tip_was_.p_W;
  const double share = share_of(trend_.travel);
  return kForeseen * ((way - share * trend_.travel.way).norm() + way_.length * tool_.radius);
}

void ToolContact::append_forces(int index, std::vector<FeatureForce>& forces) const {
  for (FeatureForce feature : trend_.forces) {
    feature.tool = index;
    forces.push_back(feature);
  }
}

/// Takes the compliance of the vertices in `filled_`: column by column where that is possible, as most are
/// never needed.
void ToolContact::take_compliance(const ToolTissue& tissue) {
  patch_.compliance.shape(3 * patch_.nodes(), 3 * patch_.nodes());
  patch_.source = tissue.traits().columns;
  patch_.vertices = filled_;
  if (patch_.source == nullptr) return tissue.model().compliance(filled_, patch_);
  patch_.filled.assign(filled_.size(), 0);
  patch_.source->begin(patch_);
}

ContactForce ToolContact::solve_contact(ToolTissue tissue) {
  const ToolPose tip(now_.place.p_W + now_.tip_offset, now_.place.q_W);
  const double reach = kGather * tool_.radius;
  finder_.gather(tissue.positions(), tissue.free(), tip.p_W, far_end(tool_, tip), reach, patch_,
                 tissue.moved_since_search());
  if (patch_.triangles.empty()) {
    release(tissue);
    return {};
  }
  const std::span<const int> vertices = finder_.vertices();
  if (!tissue.traits().constant_compliance || !std::ranges::equal(vertices, filled_)) {
    filled_.assign(vertices.begin(), vertices.end());
    take_compliance(tissue);
  }
  const int m = patch_.nodes();
  auto u = displacement_.head(3 * (m + 1));
  for (int i = 0; i < m; ++i) u.segment<3>(3 * i) = tissue.positions()[vertices[i]] - patch_.free[i];
  for (int i = 0; i < m && follows_trend(); ++i) u.segment<3>(3 * i) += foreseen(vertices[i]);
  u.tail<3>() = now_.tip_offset + foreseen_tip();
  predict(filled_, patch_, u.head(3 * m), predicted_.head(3 * m));
  nodes_were_.clear();
  const double lead = slip_lead();
  const ToolPose start = slip_start(lead);
  if (has_friction()) {
    for (const int vertex : vertices)
      nodes_were_.push_back(increment_from_[vertex] + surface_lead(vertex, lead));
  }
  const ContactForce contact =
      solver_.solve(patch_, tool_, now_.place, u, {nodes_were_, start.p_W, start.q_W, trend_.forces},
                    {.expected = uncertainty() / tool_.radius});
  now_.tip_offset = u.tail<3>();
  tissue.drop_loads();
  const auto forces = solver_.node_forces();
  for (int i = 0; i < m; ++i) {
    if (!forces.segment<3>(3 * i).isZero(0)) tissue.add_load({vertices[i], forces.segment<3>(3 * i)});
  }
  tissue.apply_loads();
  return contact;
}

void ToolContact::predict(std::span<const int> vertices, ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> u,
                          Eigen::Ref<Eigen::VectorXd> work) noexcept {
  const Vec3 motion = now_.place.p_W - predictor_.from;
  if (motion.isZero(0) || motion.norm() > kIncrement * tool_.radius) return predictor_.changes.clear();
  const Eigen::Index size = u.size();
  work.setZero();
  for (const Predictor::LoadChange& change : predictor_.changes) {
    const auto at = std::ranges::find(vertices, change.vertex);
    if (at == vertices.end()) continue;
    const int node = static_cast<int>(at - vertices.begin());
    patch.require(node);
    work.noalias() += patch.compliance.block(0, 3 * node, size, 3) * (change.per_motion * motion);
  }
  predictor_.changes.clear();
  // A surface that would go much farther than the tool is about to snap to a place that nothing predicts.
  if (size > 0 && work.cwiseAbs().maxCoeff() <= 2 * motion.norm()) u += work;
}

void ToolContact::release(ToolTissue tissue) {
  now_.tip_offset.setZero();
  predictor_.changes.clear();
  trend_.travel.surface.clear();
  trend_.forces.clear();
  tissue.release();
}

std::size_t ToolContact::bytes() const {
  return solver_.bytes() + patch_.compliance.bytes() + surface_was_.size() * sizeof(Vec3) +
         (grip_ ? grip_->bytes() : 0);
}

}  // namespace palpate::sim
