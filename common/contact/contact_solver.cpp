#include "common/contact/contact_solver.h"

#include <algorithm>
#include <cassert>

namespace palpate {
namespace {

constexpr double kLongestMove = 0.2;    // of the tool radius, per iteration
constexpr double kFirstStep = 2.0 / 3;  // of the way to the solution of the first linearised contact
// Of the largest patch: how much may be near enough to touch, where Newton steps are taken.
constexpr double kTouching = 0.5;
constexpr int kFewest = 96;  // never fewer nodes, or contacts: those of a client's patch (`ContactOnPatch`)
// How far beyond the radius features are considered: a multiple of what moved last, within fractions of the
// radius.
constexpr double kMargin = 4, kMinReach = 1e-3, kMaxReach = 0.05;

/// Displacement difference tip minus surface along a direction: a row of W u.
double along(const Contact& c, const Vec3& direction, Eigen::Index tip,
             const Eigen::Ref<const Eigen::VectorXd>& u) {
  Vec3 relative = u.segment<3>(3 * tip);
  for (int i = 0; i < c.size; ++i) relative -= c.weight[i] * u.segment<3>(3 * c.node[i]);
  if (c.fraction == 1) return direction.dot(relative);
  return direction.dot(relative) + (c.at_tip(direction) - direction).dot(u.segment<3>(3 * tip));
}

/// Where the nodes are, displaced by `u`, in `places`, which has room for them.
void deform(std::span<const Vec3> free, const Eigen::Ref<const Eigen::VectorXd>& u,
            std::vector<Vec3>& places) {
  places.assign(free.begin(), free.end());
  for (std::size_t i = 0; i < free.size(); ++i) places[i] += u.segment<3>(3 * static_cast<Eigen::Index>(i));
}

/// Features farther than what still moves (`change`, m) cannot touch in this iteration; the next looks again.
double margin_for(double change, const Tool& tool) noexcept {
  return std::clamp(kMargin * change, kMinReach * tool.radius, kMaxReach * tool.radius);
}

/// How much of the way to the next solution plain iteration goes: less where it swings, more where it creeps
/// (towards a snap-through, say).
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
    : complementarity_(max_triangles), coulomb_(friction ? max_triangles : 0) {
  second_.slot_of_node.resize(static_cast<std::size_t>(max_nodes + tools));
  const int unknowns = 3 * (max_nodes + tools), per_contact = friction ? 3 : 1,
            rows = per_contact * max_triangles;
  most_nodes_ = std::min(max_nodes, std::max(kFewest, static_cast<int>(kTouching * max_nodes)));
  most_contacts_ = std::min(max_triangles, std::max(kFewest, static_cast<int>(kTouching * max_triangles)));
  const int touching = 3 * (most_nodes_ + tools), touched = per_contact * most_contacts_;
  for (BoundedMatrix* square : {&second_.curvature, &second_.compliance, &second_.system})
    square->reserve(touching, touching);
  for (BoundedMatrix* tall : {&response_, &second_.bent, &second_.toward})
    tall->reserve(touching, touched + 3);
  second_.jacobian.reserve(touched, touching);
  if (friction) second_.spread.reserve(touching, touched);
  delassus_.reserve(rows, rows + 3);
  gap_.resize(rows);
  lambda_.resize(rows);
  next_.resize(unknowns);
  increment_.resize(unknowns);
  node_force_.resize(3 * max_nodes);
  second_.moved.resize(unknowns, 3);
  second_.load_change.resize(unknowns, 3);
  second_.rhs.resize(rows, 3);
  contacts_.reserve(static_cast<std::size_t>(max_triangles));
  second_.considered.reserve(static_cast<std::size_t>(max_triangles));
  second_.active.reserve(static_cast<std::size_t>(max_triangles));
  deformed_.reserve(static_cast<std::size_t>(max_nodes));
  second_.nodes.reserve(static_cast<std::size_t>(max_nodes + tools));
  path_.tools.reserve(static_cast<std::size_t>(tools));
  slack_.resize(rows);
  rendered_.reserve(static_cast<std::size_t>(max_triangles));
  if (!friction) return;
  frames_.reserve(static_cast<std::size_t>(max_triangles));
  path_.was.reserve(static_cast<std::size_t>(max_nodes));
  friction_.resize(max_triangles);
}

Vec3 ContactSolver::direction(int contact, int row) const {
  return row == 0 ? contacts_[contact].normal : Vec3(frames_[contact].col(row));
}

double ContactSolver::contact_compliance(double mean) noexcept {
  constexpr double kMost = 1e-9, kFraction = 1e-6;  // m/N; of a node's
  return std::min(kMost, kFraction * mean);
}

double ContactSolver::contact_compliance(const ContactPatch& patch, int nodes) noexcept {
  return contact_compliance(patch.compliance.diagonal().head(3 * nodes).mean() + patch.tool_compliance);
}

/// How far the tip went over the surface at a contact in this increment.
Vec3 ContactSolver::travel(const Contact& c) const {
  const MovedTool& tool = path_.tools[c.tool];
  Vec3 travel = c.at_tip(tool.tip - tool.tip_was) + tool.turned * c.arm;
  for (int i = 0; i < c.size; ++i) travel -= c.weight[i] * (deformed_[c.node[i]] - path_.was[c.node[i]]);
  return travel;
}

/// The place of a tool's tip among the nodes considered.
Eigen::Index ContactSolver::tip_of(int tool) const {
  return static_cast<Eigen::Index>(second_.nodes.size() - path_.tools.size()) + tool;
}

void ContactSolver::start_increment(const ContactPatch& patch, std::span<const TouchingTool> tools) noexcept {
  path_.has_friction = std::ranges::any_of(tools, [](const TouchingTool& t) { return t.tool->friction > 0; });
  rendered_.clear();  // whose nodes are those of another patch
  path_.tools.clear();
  for (const TouchingTool& t : tools) {
    MovedTool& increment = path_.tools.emplace_back();
    increment.pivots = t.tool->trocar.has_value();
    increment.radius = t.tool->radius;
    increment.tip_was = t.start.tip;
    // A sphere may spin, a pivoting shaft turns by its tip.
    if (path_.has_friction && t.tool->length > 0 && !t.tool->trocar)
      increment.turned = Mat3::Identity() - (t.start.q_W * t.pose.q_W.conjugate()).toRotationMatrix();
  }
  if (!path_.has_friction) return;
  assert(second_.spread.size() > 0);  // it was made for friction
  const auto nodes = tools.front().start.nodes;
  path_.was.assign(nodes.begin(), nodes.begin() + patch.nodes());
}

/// What each tool may touch, with the nodes and tips displaced by `u`, where things still move by `change`
/// (m).
void ContactSolver::find_contacts(std::span<const TouchingTool> tools,
                                  const Eigen::Ref<const Eigen::VectorXd>& u, double change) noexcept {
  contacts_.clear();
  const auto tips = u.size() - 3 * static_cast<Eigen::Index>(tools.size());
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const std::size_t first = contacts_.size();
    const Vec3 tip = tools[t].pose.p_W + u.segment<3>(tips + 3 * static_cast<Eigen::Index>(t));
    path_.tools[t].tip = tip;
    find_contacts_on_patch(deformed_, tools[t].triangles, *tools[t].tool, {tip, tools[t].pose.q_W},
                           margin_for(change, *tools[t].tool), contacts_);
    for (Contact& c : std::span(contacts_).subspan(first)) {
      c.tool = static_cast<int>(t);
      c.friction = tools[t].tool->friction;
    }
  }
}

/// Gaps, and slips, of the contacts as they would be without forces; and the Delassus operator.
void ContactSolver::linearise(ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u) noexcept {
  const int m = patch.nodes(), n = static_cast<int>(contacts_.size()), rows = rows_of_contact();
  frames_.clear();
  for (int k = 0; k < n; ++k) {
    const Contact& c = contacts_[k];
    if (rows > 1) {
      const Vec3 across = c.normal.unitOrthogonal();
      frames_.emplace_back() << c.normal, across, c.normal.cross(across);
    }
    for (int i = 0; i < c.size; ++i) patch.require(c.node[i]);
    for (int row = 0; row < rows; ++row) {
      const Vec3 d = direction(k, row);
      const double now = row == 0 ? c.distance - c.radius : d.dot(travel(c));
      gap_[rows * k + row] = now - along(c, d, m + c.tool, u);
    }
  }
  assemble_delassus(patch);
}

/// W C W^T, and the compliance of the contacts themselves. Column by column: C of a contact's force on the
/// surface (in `next_`), then what of it each contact sees.
void ContactSolver::assemble_delassus(const ContactPatch& patch) noexcept {
  const int n = static_cast<int>(contacts_.size()), rows = rows_of_contact();
  delassus_.shape(rows * n, rows * n);
  const Eigen::Index size = 3 * patch.nodes();
  auto moved = next_.head(size);
  for (int column = 0; column < rows * n; ++column) {
    const Contact& b = contacts_[column / rows];
    const Vec3 db = direction(column / rows, column % rows), at_tip = patch.tool_compliance * b.at_tip(db);
    moved.setZero();
    for (int j = 0; j < b.size; ++j)
      moved.noalias() += patch.compliance.block(0, 3 * b.node[j], size, 3) * (b.weight[j] * db);
    for (int row = 0; row <= column; ++row) {
      const Contact& a = contacts_[row / rows];
      Vec3 relative = a.tool == b.tool ? a.at_tip(at_tip) : Vec3(Vec3::Zero());
      for (int i = 0; i < a.size; ++i) relative += a.weight[i] * moved.segment<3>(3 * a.node[i]);
      delassus_(row, column) = delassus_(column, row) = direction(row / rows, row % rows).dot(relative);
    }
  }
  for (int row = 0; row < rows * n; ++row)
    delassus_(row, row) += row % rows == 0 ? contact_compliance_ : friction_compliance_;
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
    find_contacts(tools, u, change);
    const auto rows = static_cast<double>(contacts_.size()) * rows_of_contact();
    if (!work_.spend(rows * (27.0 * m + 9 * rows))) {
      contacts_.clear();
      next = u;
      break;
    }
    linearise(patch, u);
    solve_linearised(patch, next);
    change = (next - u).cwiseAbs().maxCoeff();
    result.converged = change <= effort.tolerance * radius && !work_.is_spent();
    if (result.converged || result.iterations == effort.max_iterations) break;
    // Plain iteration, where Newton fails: never so far that the surface could pass the tip.
    const bool onward = result.iterations == 1 || increment.dot(next - u) > 0;
    increment = std::min(step.after(onward), kLongestMove * radius / change) * (next - u);
    if (newton_worked && change > last_change) turns.miss();
    last_change = change;
    newton_worked = turns.next() && newton_step(patch, u, change, next) &&
                    (next - u).cwiseAbs().maxCoeff() < kLongestMove * radius;
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

/// Forces in the rows of the contacts, on the Delassus operator as it stands. `force`: where to start.
bool ContactSolver::solve_contacts(const Eigen::Ref<const Eigen::VectorXd>& gap,
                                   Eigen::Ref<Eigen::VectorXd> force) noexcept {
  const auto delassus = delassus_.leftCols(gap.size());
  if (!path_.has_friction) return complementarity_.solve(delassus, gap, force);
  auto friction = friction_.head(gap.size() / 3);
  for (Eigen::Index k = 0; k < friction.size(); ++k) friction[k] = contacts_[k].friction;
  return coulomb_.solve(delassus, gap, friction, force);
}

/// Keeps the forces of this iteration, as what to start from in the next, whose contacts are not all the
/// same.
void ContactSolver::store(const Eigen::Ref<const Eigen::VectorXd>& force) noexcept {
  rendered_.clear();
  const int rows = rows_of_contact();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (!(force[rows * k] > 0)) continue;
    const Vec3 rendered =
        rows > 1 ? Vec3(frames_[k] * force.segment<3>(3 * k)) : force[k] * contacts_[k].normal;
    rendered_.push_back({contacts_[k].node, contacts_[k].part, contacts_[k].tool, rendered});
  }
}

void ContactSolver::recall(Eigen::Ref<Eigen::VectorXd> force) const noexcept {
  force.setZero();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    const auto same = [&](const Rendered& rendered) {
      return rendered.node == contacts_[k].node && rendered.part == contacts_[k].part &&
             rendered.tool == contacts_[k].tool;
    };
    const auto rendered = std::ranges::find_if(rendered_, same);
    if (rendered == rendered_.end()) continue;
    if (path_.has_friction) {
      force.segment<3>(3 * k) = frames_[k].transpose() * rendered->force;
    } else {
      force[k] = rendered->force.norm();
    }
  }
}

/// Contact forces of the linearised problem, and the displacements they give.
void ContactSolver::solve_linearised(const ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> next) noexcept {
  const auto n = static_cast<Eigen::Index>(contacts_.size()) * rows_of_contact();
  auto lambda = lambda_.head(n);
  recall(lambda);
  solve_contacts(gap_.head(n), lambda);
  store(lambda);
  auto load = node_force_.head(3 * patch.nodes());
  load.setZero();
  for (MovedTool& tool : path_.tools) tool.tip_load.setZero();
  for (int row = 0; row < n; ++row) {
    if (lambda[row] == 0) continue;
    const int rows = rows_of_contact();
    const Contact& c = contacts_[row / rows];
    const Vec3 force = lambda[row] * direction(row / rows, row % rows);
    for (int i = 0; i < c.size; ++i) load.segment<3>(3 * c.node[i]) -= c.weight[i] * force;
    path_.tools[c.tool].tip_load += c.at_tip(force);
  }
  displace(patch, next);
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
  const int rows = rows_of_contact();
  force_size_ = 3 * nodes;
  node_force_.head(force_size_).setZero();
  std::ranges::fill(forces, outcome);
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (!(lambda_[rows * k] > 0)) continue;
    const Contact& c = contacts_[k];
    ContactForce& result = forces[c.tool];
    ++result.contacts;
    for (int row = 0; row < rows; ++row) {
      const double size = lambda_[rows * k + row];
      const Vec3 d = direction(k, row);
      result.force += size * c.at_tip(d);
      // The tip's normals pass through its centre; and the device does not render the part that a pivot
      // carries.
      if ((row > 0 || c.part != Contact::kTip) && !path_.tools[c.tool].pivots)
        result.torque += c.arm.cross(size * d);
      for (int i = 0; i < c.size; ++i) node_force_.segment<3>(3 * c.node[i]) -= size * c.weight[i] * d;
    }
  }
}

/// True if a contact bears so much that its own compliance lets the surface pass it: no place is left for
/// what cannot give way.
bool ContactSolver::is_passed() const noexcept {
  constexpr double kPassed = 0.01;  // of the tool radius; of tissue it is less than a millionth
  const int rows = rows_of_contact();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (lambda_[rows * k] * contact_compliance_ > kPassed * contacts_[k].radius) return true;
  }
  return false;
}

void ContactSolver::node_forces_of(int tool, Eigen::Ref<Eigen::VectorXd> forces) const noexcept {
  const int rows = rows_of_contact();
  forces.setZero();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    const Contact& c = contacts_[k];
    if (c.tool != tool || !(lambda_[rows * k] > 0)) continue;
    for (int row = 0; row < rows; ++row) {
      for (int i = 0; i < c.size; ++i)
        forces.segment<3>(3 * c.node[i]) -= lambda_[rows * k + row] * c.weight[i] * direction(k, row);
    }
  }
}

std::size_t ContactSolver::bytes() const {
  return coulomb_.bytes() + complementarity_.bytes() + delassus_.bytes() + response_.bytes() +
         second_.curvature.bytes() + second_.compliance.bytes() + second_.bent.bytes() +
         second_.toward.bytes() + second_.system.bytes() + second_.jacobian.bytes() + second_.spread.bytes();
}

}  // namespace palpate
