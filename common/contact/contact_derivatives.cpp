// How the rows of ContactSolver's contacts, and their forces, change with the places of nodes and tip: B =
// dw/dy, the directions A that forces act along, and S = d(A z)/dy. What these are for stands in
// contact_newton.cpp. A direction d across the normal turns with it and no more: dd = -n (d . dn).
#include <algorithm>

#include "common/contact/contact_solver.h"
#include "common/contact/simplex_distance.h"

namespace palpate {

namespace {

/// Second derivative of the gap of a contact whose corners are at `x`.
SimplexHessian hessian_of(const Contact& c, bool pivots, std::span<const Vec3> x, WeightGradient* weights) {
  const SlidingPoint sliding{c.axis, c.fraction, pivots};
  return distance_hessian(x, {c.weight.data(), x.size()}, c.normal, c.distance, weights,
                          c.part == Contact::kShaft ? &sliding : nullptr);
}

}  // namespace

/// The nodes of the contacts considered: first those that no contact with a force is on, for which there is
/// no curvature; the tips last.
void ContactSolver::collect_nodes(int nodes) noexcept {
  enum Mark : int { kUnseen = -1, kLoaded = -2 };  // of a node that is not numbered yet
  second_.nodes.clear();
  const int tools = static_cast<int>(path_.tools.size());
  std::fill_n(second_.slot_of_node.begin(), nodes + tools, kUnseen);
  const auto for_each_node = [&](auto&& visit) {
    for (const int k : second_.considered) {
      for (int i = 0; i < contacts_[k].size; ++i) visit(k, contacts_[k].node[i]);
    }
  };
  const auto add = [&](int node) {
    second_.slot_of_node[node] = static_cast<int>(second_.nodes.size());
    second_.nodes.push_back(node);
  };
  for_each_node([&](int k, int node) {
    if (lambda_[k] != 0) second_.slot_of_node[node] = kLoaded;
  });
  for_each_node([&](int, int node) {
    if (second_.slot_of_node[node] == kUnseen) add(node);
  });
  second_.unloaded = static_cast<int>(second_.nodes.size());
  for_each_node([&](int, int node) {
    if (second_.slot_of_node[node] == kLoaded) add(node);
  });
  for (int t = 0; t < tools; ++t) add(nodes + t);
}

void ContactSolver::differentiate_contacts(int nodes) noexcept {
  const auto n = static_cast<Eigen::Index>(second_.rows.size()),
             contacts = static_cast<Eigen::Index>(second_.considered.size()),
             size = 3 * static_cast<Eigen::Index>(second_.nodes.size());
  second_.curvature.shape(size, size);
  second_.curvature.setZero();
  second_.jacobian.shape(n + static_cast<Eigen::Index>(second_.friction_nodes.size()), size);
  second_.jacobian.setZero();
  for (Eigen::Index row = 0; row < n; ++row) {
    const Contact& c = contact_of(second_.rows[static_cast<std::size_t>(row)]);
    const Vec3 d = direction(second_.rows[static_cast<std::size_t>(row)]);
    for (int i = 0; i < c.size; ++i)
      second_.jacobian.block<1, 3>(row, 3 * second_.slot_of_node[c.node[i]]) = -c.weight[i] * d.transpose();
    second_.jacobian.block<1, 3>(row, 3 * second_.slot_of_node[nodes + c.tool]) = c.at_tip(d).transpose();
  }
  const bool friction = n > contacts;
  if (friction) {
    second_.spread.shape(size, n);
    second_.spread = second_.jacobian.topRows(n).transpose();
    second_.turning.shape(n, contacts);
    second_.turning.setZero();
  }
  for (Eigen::Index row = 0; row < contacts; ++row) {
    const int k = second_.considered[static_cast<std::size_t>(row)];
    const Contact& c = contacts_[k];
    std::array<Vec3, 3> x;
    std::array<int, 4> slot;
    for (int i = 0; i < c.size; ++i) {
      x[i] = deformed_[c.node[i]];
      slot[i] = second_.slot_of_node[c.node[i]];
    }
    slot[c.size] = second_.slot_of_node[nodes + c.tool];
    const double force = lambda_[k];
    WeightGradient weights;
    SimplexHessian h;
    if (force != 0)
      h = hessian_of(c, path_.tools[c.tool].pivots, {x.data(), static_cast<std::size_t>(c.size)},
                     friction ? &weights : nullptr);
    if (friction && c.friction > 0)
      differentiate_friction(static_cast<int>(row), force != 0 ? &h : nullptr, weights, slot);
    for (int i = 0; force != 0 && i <= c.size; ++i) {
      for (int j = 0; j <= c.size; ++j) {
        second_.curvature.block<3, 3>(3 * slot[i], 3 * slot[j]) += force * h.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

/// False where more is near the tool than there is room for.
bool ContactSolver::differentiate_considered(const ContactPatch& patch) noexcept {
  collect_nodes(patch.nodes());
  if (static_cast<int>(second_.nodes.size()) > most_nodes_ + static_cast<int>(path_.tools.size()) ||
      static_cast<int>(second_.considered.size()) > most_contacts_ ||
      static_cast<int>(second_.friction_nodes.size()) > most_nodes_)
    return false;
  differentiate_contacts(patch.nodes());
  return true;
}

}  // namespace palpate
