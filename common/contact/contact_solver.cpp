#include "common/contact/contact_solver.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace palpate {
namespace {

constexpr double kLongestMove = 0.2;    // of the tool radius, per iteration
constexpr double kFirstStep = 2.0 / 3;  // of the way to the solution of the first linearised contact
// Of the largest patch: how much may be near enough to touch, where Newton steps are taken.
constexpr double kTouching = 0.5;
constexpr int kFewest = 96;  // never fewer nodes, or contacts: those of a client's patch (`ContactOnPatch`)
// Of what the conditions of friction lack, remains for the next iteration, which changes them by more: half
// as many solves in all as at 0.
constexpr double kInexact = 1e-2;
// How far beyond the radius features are considered: a multiple of what moved last, within fractions of the
// radius.
constexpr double kMargin = 4, kMinReach = 1e-3, kMaxReach = 0.05;

/// Writes where the nodes are, displaced by `u`, to `places`, which has room for them.
void deform(std::span<const Vec3> free, const Eigen::Ref<const Eigen::VectorXd>& u,
            std::vector<Vec3>& places) {
  places.assign(free.begin(), free.end());
  for (std::size_t i = 0; i < free.size(); ++i) places[i] += u.segment<3>(3 * static_cast<Eigen::Index>(i));
}

/// Features farther than what still moves (`change`, m) cannot touch in this iteration; the next looks again.
double margin_for(double change, const Tool& tool) noexcept {
  return std::clamp(kMargin * change, kMinReach * tool.radius, kMaxReach * tool.radius);
}

/// The fraction of the way to the next solution that plain iteration goes: less where it swings, more where
/// it creeps (towards a snap-through, say).
class PlainStep {
 public:
  /// `onward`: the solution lies on the side to which the last step went.
  double after(bool onward) noexcept {
    onward_run_ = onward ? onward_run_ + 1 : 0;
    fraction_ = std::clamp(fraction_ * (onward ? 1.3 : 0.5), 0.1, onward_run_ > 6 ? 4.0 : 1.0);
    return fraction_;
  }

 private:
  double fraction_ = kFirstStep;
  int onward_run_ = 0;
};

/// Whose turn it is: Newton's, but after each of its failures plain iteration's, ever longer.
class NewtonTurns {
 public:
  void miss() noexcept { plain_remaining_ = 2 << ++failures_; }
  bool next() noexcept { return --plain_remaining_ < 0; }

 private:
  int failures_ = 0, plain_remaining_ = 0;
};

}  // namespace

const ContactSolver::Effort ContactSolver::kUsualEffort{};

void ContactPatch::reserve(int max_nodes, int max_triangles) {
  free.reserve(static_cast<std::size_t>(max_nodes));
  triangles.reserve(static_cast<std::size_t>(max_triangles));
  compliance.reserve(3 * max_nodes, 3 * max_nodes);
  filled.reserve(static_cast<std::size_t>(max_nodes));
}

void ContactPatch::require(int node) noexcept {
  if (source == nullptr || filled[node] != 0) return;
  source->fill(node, *this);
  filled[node] = 1;
}

ContactSolver::ContactSolver(int max_nodes, int max_triangles, bool friction, int tools)
    : complementarity_(max_triangles), coulomb_(friction ? max_triangles : 0, friction ? max_nodes : 0) {
  second_.slot_of_node.resize(static_cast<std::size_t>(max_nodes + tools));
  const int unknowns = 3 * (max_nodes + tools), across_rows = friction ? 2 : 0,
            rows = max_triangles + across_rows * max_nodes;
  most_nodes_ = std::min(max_nodes, std::max(kFewest, static_cast<int>(kTouching * max_nodes)));
  most_contacts_ = std::min(max_triangles, std::max(kFewest, static_cast<int>(kTouching * max_triangles)));
  const int touching = 3 * (most_nodes_ + tools), touched = most_contacts_ + across_rows * most_nodes_;
  for (BoundedMatrix* square : {&second_.curvature, &second_.compliance, &second_.system})
    square->reserve(touching, touching);
  for (BoundedMatrix* tall : {&response_, &second_.bent, &second_.toward})
    tall->reserve(touching, touched + across_rows / 2 * most_nodes_ + 3);
  second_.jacobian.reserve(touched + across_rows / 2 * most_nodes_, touching);
  if (friction) second_.spread.reserve(touching, touched);
  if (friction) second_.turning.reserve(touched, most_contacts_);
  delassus_.reserve(rows + across_rows / 2 * max_nodes, rows + 3);
  gap_.resize(rows);
  lambda_.resize(rows);
  next_.resize(unknowns);
  increment_.resize(unknowns);
  node_force_.resize(3 * max_nodes);
  second_.moved.resize(unknowns, 3);
  second_.load_change.resize(unknowns, 3);
  second_.rhs.resize(rows + across_rows / 2 * max_nodes, 3);
  contacts_.reserve(static_cast<std::size_t>(max_triangles));
  second_.considered.reserve(static_cast<std::size_t>(max_triangles));
  second_.gap_changes.reserve(static_cast<std::size_t>(max_nodes + tools));
  second_.rows.reserve(static_cast<std::size_t>(rows));
  second_.active.reserve(static_cast<std::size_t>(max_triangles));
  deformed_.reserve(static_cast<std::size_t>(max_nodes));
  second_.nodes.reserve(static_cast<std::size_t>(max_nodes + tools));
  path_.tools.reserve(static_cast<std::size_t>(tools));
  slack_.resize(rows);
  rendered_.reserve(static_cast<std::size_t>(rows));
  if (!friction) return;
  const auto nodes = static_cast<std::size_t>(max_nodes);
  path_.was.reserve(nodes);
  friction_nodes_.places.reserve(nodes);
  friction_nodes_.frames.reserve(nodes);
  second_.friction_nodes.reserve(nodes);
  friction_nodes_.pressing.reserve(nodes);
  second_.mu.reserve(nodes);
  for (auto* shares : {&friction_nodes_.shares, &second_.shares}) shares->reserve(3 * contacts_.capacity());
  friction_nodes_.at_node.assign(nodes * static_cast<std::size_t>(tools), -1);
}

const Contact& ContactSolver::contact_of(Eigen::Index row) const {
  const auto k = static_cast<std::size_t>(row), n = contacts_.size();
  return k < n ? contacts_[k] : friction_nodes_.places[(k - n) / 2];
}

Vec3 ContactSolver::direction(Eigen::Index row) const {
  const auto k = static_cast<std::size_t>(row), n = contacts_.size();
  return k < n ? contacts_[k].normal
               : Vec3(friction_nodes_.frames[(k - n) / 2].col(1 + (row - static_cast<int>(n)) % 2));
}

double ContactSolver::contact_compliance(double mean) noexcept {
  constexpr double kMost = 1e-9, kFraction = 1e-6;  // m/N; of a node's
  return std::min(kMost, kFraction * mean);
}

double ContactSolver::contact_compliance(const ContactPatch& patch, int nodes) noexcept {
  return contact_compliance(patch.compliance.diagonal().head(3 * nodes).mean() + patch.tool_compliance);
}

/// Displacement difference tip minus surface of a row: W u.
double ContactSolver::along(Eigen::Index row, Eigen::Index nodes,
                            const Eigen::Ref<const Eigen::VectorXd>& u) const {
  const Contact& c = contact_of(row);
  const Vec3 d = direction(row), tip = u.segment<3>(3 * (nodes + c.tool));
  Vec3 relative = tip;
  for (int i = 0; i < c.size; ++i) relative -= c.weight[i] * u.segment<3>(3 * c.node[i]);
  if (c.fraction == 1) return d.dot(relative);
  return d.dot(relative) + (c.at_tip(d) - d).dot(tip);
}

/// Returns how far the tip went over the surface at the place of a row in this increment.
Vec3 ContactSolver::travel(Eigen::Index row) const {
  const Contact& c = contact_of(row);
  const MovedTool& tool = path_.tools[c.tool];
  Vec3 travel = c.at_tip(tool.tip - tool.tip_was) + tool.turned * c.arm;
  for (int i = 0; i < c.size; ++i) travel -= c.weight[i] * (deformed_[c.node[i]] - path_.was[c.node[i]]);
  return travel;
}

/// The vertices of a contact's feature, ascending; -1, where it is no face.
std::array<int, 3> ContactSolver::vertices_of(const Contact& c) const {
  std::array<int, 3> vertices = c.node;
  if (path_.vertices.empty()) return vertices;
  for (int i = 0; i < c.size; ++i) vertices[i] = path_.vertices[c.node[i]];
  std::ranges::sort(vertices);
  return vertices;
}

/// The place of a tool's tip among the nodes considered.
Eigen::Index ContactSolver::tip_of(int tool) const {
  return static_cast<Eigen::Index>(second_.nodes.size() - path_.tools.size()) + tool;
}

void ContactSolver::start_increment(const ContactPatch& patch, std::span<const TouchingTool> tools) noexcept {
  path_.has_friction = std::ranges::any_of(tools, [](const TouchingTool& t) { return t.tool->friction > 0; });
  rendered_.assign(tools.front().start.forces.begin(), tools.front().start.forces.end());
  path_.vertices = patch.vertices;
  path_.tools.clear();
  for (const TouchingTool& t : tools) {
    MovedTool& increment = path_.tools.emplace_back();
    increment.pivots = t.tool->trocar.has_value();
    increment.radius = t.tool->radius;
    increment.tip_was = t.start.tip;
    if (path_.has_friction && !t.tool->trocar)  // a pivoting shaft turns by its tip
      increment.turned = Mat3::Identity() - (t.start.q_W * t.pose.q_W.conjugate()).toRotationMatrix();
  }
  if (!path_.has_friction) return;
  assert(second_.spread.size() > 0);  // it was made for friction
  const auto nodes = tools.front().start.nodes;
  path_.was.assign(nodes.begin(), nodes.begin() + patch.nodes());
}

/// Finds what each tool may touch, with the nodes and tips displaced by `u`, where things still move by
/// `change` (m). False: there is room for some of it only.
bool ContactSolver::find_contacts(std::span<const TouchingTool> tools,
                                  const Eigen::Ref<const Eigen::VectorXd>& u, double change) noexcept {
  contacts_.clear();
  bool complete = true;
  const auto tips = u.size() - 3 * static_cast<Eigen::Index>(tools.size());
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const std::size_t first = contacts_.size();
    const Vec3 tip = tools[t].pose.p_W + u.segment<3>(tips + 3 * static_cast<Eigen::Index>(t));
    path_.tools[t].tip = tip;
    complete &=
        find_contacts_on_patch(deformed_, tools[t].triangles, *tools[t].tool, {tip, tools[t].pose.q_W},
                               margin_for(change, *tools[t].tool), contacts_);
    for (Contact& c : std::span(contacts_).subspan(first)) {
      c.tool = static_cast<int>(t);
      c.friction = tools[t].tool->friction;
    }
  }
  return complete;
}

/// Gaps, and slips, of the contacts as they would be without forces.
void ContactSolver::linearise(ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u) noexcept {
  const auto n = static_cast<Eigen::Index>(contacts_.size());
  for (const Contact& c : contacts_) {
    for (int i = 0; i < c.size; ++i) patch.require(c.node[i]);
  }
  for (Eigen::Index row = 0; row < rows(); ++row) {
    const Contact& c = contact_of(row);
    gap_[row] =
        (row < n ? c.distance - c.radius : direction(row).dot(travel(row))) - along(row, patch.nodes(), u);
  }
}

/// W C W^T, and the compliance of the contacts themselves. Column by column: C of a contact's force on the
/// surface (in `next_`), then what of it each contact sees.
void ContactSolver::assemble_delassus(const ContactPatch& patch) noexcept {
  const auto n = static_cast<Eigen::Index>(contacts_.size()), size = rows();
  delassus_.shape(size, size);
  const Eigen::Index unknowns = 3 * patch.nodes();
  auto moved = next_.head(unknowns);
  for (Eigen::Index column = 0; column < size; ++column) {
    const Contact& b = contact_of(column);
    const Vec3 db = direction(column), at_tip = patch.tool_compliance * b.at_tip(db);
    moved.setZero();
    for (int j = 0; j < b.size; ++j)
      moved.noalias() += patch.compliance.block(0, 3 * b.node[j], unknowns, 3) * (b.weight[j] * db);
    for (Eigen::Index row = 0; row <= column; ++row) {
      const Contact& a = contact_of(row);
      Vec3 relative = a.tool == b.tool ? a.at_tip(at_tip) : Vec3(Vec3::Zero());
      for (int i = 0; i < a.size; ++i) relative += a.weight[i] * moved.segment<3>(3 * a.node[i]);
      delassus_(row, column) = delassus_(column, row) = direction(row).dot(relative);
    }
  }
  for (Eigen::Index row = 0; row < size; ++row)
    delassus_(row, row) += row < n ? contact_compliance_ : friction_compliance_;
}

ContactForce ContactSolver::solve(ContactPatch& patch, const Tool& tool, const ToolPose& pose,
                                  Eigen::Ref<Eigen::VectorXd> u, const IncrementStart& start,
                                  const Effort& effort) noexcept {
  const TouchingTool one{&tool, pose, start, patch.triangles};
  ContactForce force;
  solve(patch, std::span(&one, 1), u, std::span(&force, 1), effort);
  return force;
}

void ContactSolver::solve(ContactPatch& patch, std::span<const TouchingTool> tools,
                          Eigen::Ref<Eigen::VectorXd> u, std::span<ContactForce> forces,
                          const Effort& effort) noexcept {
  start_increment(patch, tools);
  work_.allow(effort.work);
  complementarity_.count_work(work_);
  coulomb_.count_work(work_);
  contact_compliance_ = contact_compliance(patch, patch.nodes());
  friction_compliance_ = contact_compliance_ / 10;
  const int m = patch.nodes();
  ContactForce result;
  result.converged = false;
  const double radius = std::ranges::min(path_.tools, {}, &MovedTool::radius).radius;
  auto next = next_.head(u.size()), increment = increment_.head(u.size());
  double change = effort.expected * radius, last_change = radius;
  PlainStep step;
  NewtonTurns turns;
  bool newton_worked = false;
  while (true) {
    ++result.iterations;
    deform(patch.free, u, deformed_);
    const bool contacts_complete = find_contacts(tools, u, change),
               complete = find_friction_nodes(patch) && contacts_complete;
    const auto size = static_cast<double>(rows());
    if (!work_.spend(size * (27.0 * m + 9 * size))) {
      contacts_.clear();
      find_friction_nodes(patch);
      next = u;
      break;
    }
    linearise(patch, u);
    // With friction a plain step costs most of what Newton's does, and is taken in its place.
    const bool by_newton = path_.has_friction && recall(lambda_.head(rows())) && turns.next() &&
                           newton_step(patch, u, change, next) &&
                           (next - u).cwiseAbs().maxCoeff() < kLongestMove * radius;
    const bool solved = by_newton || plain_step(patch, next) || !path_.has_friction;
    change = (next - u).cwiseAbs().maxCoeff();
    // Newton's next step is at least as much shorter than this one as this is than the last.
    const double remaining =
        by_newton && newton_worked ? change * std::min(1.0, change / last_change) : change;
    result.converged = solved && complete && remaining <= effort.tolerance * radius && !work_.is_spent();
    if (result.converged || result.iterations == effort.max_iterations) break;
    // Plain iteration, where Newton fails: never so far that the surface could pass the tip.
    const bool onward = result.iterations == 1 || increment.dot(next - u) > 0;
    increment = std::min(step.after(onward), kLongestMove * radius / change) * (next - u);
    if (newton_worked && change > last_change) turns.miss();
    last_change = change;
    newton_worked =
        by_newton || (!path_.has_friction && turns.next() && newton_step(patch, u, change, next) &&
                      (next - u).cwiseAbs().maxCoeff() < kLongestMove * radius);
    if (newton_worked) {
      u = next;
    } else {
      u += increment;
    }
  }
  u = next;
  result.converged = result.converged && !is_passed();
  collect_result(m, result, forces);
}

/// Forces in the rows considered, on the Delassus operator as it stands. `force`: where to start; if that is
/// `near`, and turns out not to be, it gives up soon.
bool ContactSolver::solve_contacts(const Eigen::Ref<const Eigen::VectorXd>& gap,
                                   Eigen::Ref<Eigen::VectorXd> force, bool near) noexcept {
  const auto delassus = delassus_.leftCols(force.size());
  if (second_.friction_nodes.empty()) return complementarity_.solve(delassus, gap, force);
  return near ? coulomb_.solve_near(delassus, gap, friction_considered(), force, kInexact)
              : coulomb_.solve(delassus, gap, friction_considered(), force, kInexact);
}

/// Keeps the forces of this iteration, as what to start from in the next, whose contacts are not all the
/// same.
void ContactSolver::store(const Eigen::Ref<const Eigen::VectorXd>& force) noexcept {
  rendered_.clear();
  const int n = static_cast<int>(contacts_.size());
  for (int k = 0; k < n; ++k) {
    const Contact& c = contacts_[k];
    if (force[k] > 0) rendered_.push_back({vertices_of(c), c.part, c.tool, false, force[k] * c.normal});
  }
  for (int i = 0; i < static_cast<int>(friction_nodes_.places.size()); ++i) {
    const Contact& c = friction_nodes_.places[i];
    const Vec3 beta = friction_nodes_.frames[i].rightCols<2>() * force.segment<2>(n + 2 * i);
    if (!beta.isZero(0)) rendered_.push_back({vertices_of(c), c.part, c.tool, true, beta});
  }
}

/// Takes the forces of the iteration before, for as many rows as `force` has; false if there are none.
bool ContactSolver::recall(Eigen::Ref<Eigen::VectorXd> force) const noexcept {
  const auto before = [&](const Contact& c, bool friction) {
    const std::array<int, 3> vertices = vertices_of(c);
    const auto found = std::ranges::find_if(rendered_, [&](const FeatureForce& f) {
      return f.vertex == vertices && f.part == c.part && f.tool == c.tool && f.friction == friction;
    });
    return found == rendered_.end() ? nullptr : &*found;
  };
  bool any = false;
  force.setZero();
  const auto n = static_cast<Eigen::Index>(contacts_.size());
  for (Eigen::Index row = 0; row < n; ++row) {
    const FeatureForce* const rendered = before(contact_of(row), false);
    if (rendered == nullptr) continue;
    any = true;
    force[row] = rendered->force.norm();
  }
  for (Eigen::Index row = n; row < force.size(); row += 2) {
    const FeatureForce* const rendered = before(contact_of(row), true);
    if (rendered == nullptr) continue;
    for (int i = 0; i < 2; ++i) force[row + i] = direction(row + i).dot(rendered->force);
  }
  return any;
}

/// Lists the rows of the contacts considered, and of the places of friction that these press on.
void ContactSolver::consider() noexcept {
  second_.friction_nodes.clear();
  second_.shares.clear();
  second_.mu.clear();
  second_.rows.assign(second_.considered.begin(), second_.considered.end());
  for (const FrictionPlaces::Share& s : friction_nodes_.shares) {
    const auto contact = std::ranges::lower_bound(second_.considered, s.contact);
    if (contact == second_.considered.end() || *contact != s.contact) continue;
    const auto known = std::ranges::find(second_.friction_nodes, s.place);
    const int place = static_cast<int>(known - second_.friction_nodes.begin());
    second_.shares.push_back({static_cast<int>(contact - second_.considered.begin()), place, s.share});
    if (known != second_.friction_nodes.end()) continue;
    second_.friction_nodes.push_back(s.place);
    second_.mu.push_back(friction_nodes_.places[static_cast<std::size_t>(s.place)].friction);
  }
  for (const int node : second_.friction_nodes) {
    const int row = static_cast<int>(contacts_.size()) + 2 * node;
    second_.rows.push_back(row);
    second_.rows.push_back(row + 1);
  }
}

void ContactSolver::consider_all() noexcept {
  second_.considered.resize(contacts_.size());
  std::iota(second_.considered.begin(), second_.considered.end(), 0);
  consider();
}

/// Contact forces of the linearised problem, and the displacements they give; false: the forces are only near
/// to those.
bool ContactSolver::plain_step(const ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> next) noexcept {
  assemble_delassus(patch);
  consider_all();
  auto lambda = lambda_.head(rows());
  recall(lambda);
  const bool solved = solve_contacts(gap_.head(rows()), lambda);
  store(lambda);
  auto load = node_force_.head(3 * patch.nodes());
  load.setZero();
  for (MovedTool& tool : path_.tools) tool.tip_load.setZero();
  for (Eigen::Index row = 0; row < rows(); ++row) {
    if (lambda[row] == 0) continue;
    const Contact& c = contact_of(row);
    const Vec3 force = lambda[row] * direction(row);
    for (int i = 0; i < c.size; ++i) load.segment<3>(3 * c.node[i]) -= c.weight[i] * force;
    path_.tools[c.tool].tip_load += c.at_tip(force);
  }
  displace(patch, next);
  return solved;
}

/// The displacement under the loads in `node_force_`, and those on the tips.
void ContactSolver::displace(const ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> next) const noexcept {
  const Eigen::Index size = 3 * patch.nodes();
  auto moved = next.head(size);
  moved.setZero();
  for (Eigen::Index k = 0; k < size; ++k) {
    if (node_force_[k] != 0) moved += node_force_[k] * patch.compliance.col(k).head(size);
  }
  for (std::size_t t = 0; t < path_.tools.size(); ++t)
    next.segment<3>(size + 3 * static_cast<Eigen::Index>(t)) =
        patch.tool_compliance * path_.tools[t].tip_load;
}

void ContactSolver::collect_result(int nodes, const ContactForce& outcome,
                                   std::span<ContactForce> forces) noexcept {
  const auto n = static_cast<Eigen::Index>(contacts_.size());
  force_size_ = 3 * nodes;
  node_force_.head(force_size_).setZero();
  std::ranges::fill(forces, outcome);
  for (Eigen::Index row = 0; row < rows(); ++row) {
    if (lambda_[row] == 0 || (row < n && !(lambda_[row] > 0))) continue;
    const Contact& c = contact_of(row);
    ContactForce& result = forces[c.tool];
    result.contacts += row < n;
    const double size = lambda_[row];
    const Vec3 d = direction(row);
    result.force += size * c.at_tip(d);
    // The tip's normals pass through its centre; and the device does not render the part that a pivot
    // carries.
    if ((row >= n || c.part != Contact::kTip) && !path_.tools[c.tool].pivots)
      result.torque += c.arm.cross(size * d);
    for (int i = 0; i < c.size; ++i) node_force_.segment<3>(3 * c.node[i]) -= size * c.weight[i] * d;
  }
}

/// True if a contact bears so much that its own compliance lets the surface pass it: no place is left for
/// what cannot give way.
bool ContactSolver::is_passed() const noexcept {
  constexpr double kPassed = 0.01;  // of the tool radius; of tissue it is less than a millionth
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (lambda_[k] * contact_compliance_ > kPassed * contacts_[k].radius) return true;
  }
  return false;
}

void ContactSolver::node_forces_of(int tool, Eigen::Ref<Eigen::VectorXd> forces) const noexcept {
  forces.setZero();
  for (Eigen::Index row = 0; row < rows(); ++row) {
    const Contact& c = contact_of(row);
    if (c.tool != tool || lambda_[row] == 0) continue;
    for (int i = 0; i < c.size; ++i)
      forces.segment<3>(3 * c.node[i]) -= lambda_[row] * c.weight[i] * direction(row);
  }
}

std::size_t ContactSolver::bytes() const {
  return coulomb_.bytes() + complementarity_.bytes() + delassus_.bytes() + response_.bytes() +
         second_.curvature.bytes() + second_.compliance.bytes() + second_.bent.bytes() +
         second_.toward.bytes() + second_.system.bytes() + second_.jacobian.bytes() + second_.spread.bytes() +
         second_.turning.bytes();
}

}  // namespace palpate
