#include "common/contact/contact_solver.h"

#include <algorithm>

namespace palpate {
namespace {

constexpr double kLongestMove = 0.2;  // of the tool radius, per iteration
constexpr double kFirstStep = 2.0 / 3;
// How far beyond the radius features are considered: a multiple of what moved last, within shares of the
// radius.
constexpr double kMargin = 4, kMinReach = 1e-3, kMaxReach = 0.05;

/// Displacement difference tip minus surface along the normal: J_k u.
double along(const Contact& c, int tip, const Eigen::Ref<const Eigen::VectorXd>& u) {
  Vec3 relative = u.segment<3>(3 * tip);
  for (int i = 0; i < c.size; ++i) relative -= c.weight[i] * u.segment<3>(3 * c.node[i]);
  return c.normal.dot(relative);
}

}  // namespace

const ContactSolver::Effort ContactSolver::kUsualEffort{};

void ContactPatch::reserve(int max_nodes, int max_triangles) {
  free.reserve(static_cast<std::size_t>(max_nodes));
  triangles.reserve(static_cast<std::size_t>(max_triangles));
  compliance.resize(3 * max_nodes, 3 * max_nodes);
}

ContactSolver::ContactSolver(int max_nodes, int max_triangles)
    : complementarity_(max_triangles),
      response_(3 * (max_nodes + 1), max_triangles),
      delassus_(max_triangles, max_triangles),
      gap_(max_triangles),
      lambda_(max_triangles),
      next_(3 * (max_nodes + 1)),
      way_(3 * (max_nodes + 1)),
      node_force_(3 * max_nodes),
      slot_of_node_(static_cast<std::size_t>(max_nodes + 1)),
      curvature_(3 * (max_nodes + 1), 3 * (max_nodes + 1)),
      effective_(3 * (max_nodes + 1), 3 * (max_nodes + 1)),
      system_(3 * (max_nodes + 1), 3 * (max_nodes + 1)),
      jacobian_(max_triangles, 3 * (max_nodes + 1)),
      moved_(3 * (max_nodes + 1), 3),
      rhs_(max_triangles, 3) {
  contacts_.reserve(static_cast<std::size_t>(max_triangles));
  deformed_.reserve(static_cast<std::size_t>(max_nodes));
  considered_.reserve(static_cast<std::size_t>(max_triangles));
  nodes_.reserve(static_cast<std::size_t>(max_nodes + 1));
}

void ContactSolver::linearise(const ContactPatch& patch, const SphereTool& tool,
                              const Eigen::Ref<const Eigen::VectorXd>& u) {
  const int m = patch.nodes(), n = static_cast<int>(contacts_.size());
  for (int k = 0; k < n; ++k) {
    const Contact& c = contacts_[k];
    auto column = response_.col(k).head(3 * (m + 1));
    column.setZero();
    for (int i = 0; i < c.size; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const double load = -c.weight[i] * c.normal[axis];
        column.head(3 * m) += load * patch.compliance.col(3 * c.node[i] + axis).head(3 * m);
      }
    }
    column.tail<3>() = patch.tool_compliance * c.normal;
    gap_[k] = c.distance - tool.radius - along(c, m, u);
  }
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < n; ++l) delassus_(l, k) = along(contacts_[l], m, response_.col(k).head(3 * (m + 1)));
    delassus_(k, k) += kContactCompliance;
  }
}

ContactForce ContactSolver::solve(const ContactPatch& patch, const SphereTool& tool, const Vec3& p_W,
                                  Eigen::Ref<Eigen::VectorXd> u, const Effort& effort) noexcept {
  const int m = patch.nodes();
  ContactForce result;
  result.converged = false;
  auto next = next_.head(3 * (m + 1)), way = way_.head(3 * (m + 1));
  double change = tool.radius, last_change = tool.radius, step = kFirstStep;
  int newton_failures = 0, plain_left = 0, onward_run = 0;
  bool newton_worked = false;
  while (true) {
    ++result.iterations;
    deformed_.assign(patch.free.begin(), patch.free.end());
    for (int i = 0; i < m; ++i) deformed_[i] += u.segment<3>(3 * i);
    // Features farther than what still moves cannot touch in this iteration; the next one looks again.
    const double reach =
        tool.radius + std::clamp(kMargin * change, kMinReach * tool.radius, kMaxReach * tool.radius);
    find_contacts_on_patch(deformed_, patch.triangles, p_W + u.tail<3>(), reach, contacts_);
    linearise(patch, tool, u);
    solve_linearised(m, next);
    change = (next - u).cwiseAbs().maxCoeff();
    result.converged = change <= effort.tolerance * tool.radius;
    if (result.converged || result.iterations == effort.max_iterations) break;
    // Plain iteration, where Newton fails (ever longer, each time it does): shorter steps where it swings,
    // longer ones where it creeps (towards a snap-through, say), never so long that the surface could pass
    // the tip.
    const bool onward = result.iterations == 1 || way.dot(next - u) > 0;
    onward_run = onward ? onward_run + 1 : 0;
    step = std::clamp(step * (onward ? 1.3 : 0.5), 0.1, onward_run > 6 ? 4.0 : 1.0);
    way = std::min(step, kLongestMove * tool.radius / change) * (next - u);
    if (newton_worked && change > last_change) plain_left = 2 << ++newton_failures;
    last_change = change;
    newton_worked = effort.newton && --plain_left < 0 && newton_step(patch, u, next) &&
                    (next - u).cwiseAbs().maxCoeff() < kLongestMove * tool.radius;
    if (newton_worked) {
      u = next;
    } else {
      u += way;
    }
  }
  u = next;
  collect_result(m, result);
  return result;
}

/// Contact forces of the linearised problem, and the displacements they give.
void ContactSolver::solve_linearised(int nodes, Eigen::Ref<Eigen::VectorXd> next) noexcept {
  const auto n = static_cast<Eigen::Index>(contacts_.size());
  auto lambda = lambda_.head(n);
  complementarity_.solve(delassus_.topLeftCorner(n, n), gap_.head(n), lambda);
  next.setZero();
  for (Eigen::Index k = 0; k < n; ++k) {
    if (lambda[k] > 0) next += lambda[k] * response_.col(k).head(3 * (nodes + 1));
  }
}

void ContactSolver::collect_result(int nodes, ContactForce& result) noexcept {
  force_size_ = 3 * nodes;
  node_force_.head(force_size_).setZero();
  considered_.clear();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (!(lambda_[k] > 0)) continue;
    considered_.push_back(k);
    const Contact& c = contacts_[k];
    result.force += lambda_[k] * c.normal;
    for (int i = 0; i < c.size; ++i)
      node_force_.segment<3>(3 * c.node[i]) -= lambda_[k] * c.weight[i] * c.normal;
  }
  result.contacts = static_cast<int>(considered_.size());
}

std::size_t ContactSolver::bytes() const {
  return sizeof(double) *
         static_cast<std::size_t>(2 * delassus_.size() + response_.size() + curvature_.size() +
                                  effective_.size() + system_.size() + jacobian_.size());
}

}  // namespace palpate
