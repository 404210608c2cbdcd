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
    if (lambda_[rows_of_contact() * k] != 0) second_.slot_of_node[node] = kLoaded;
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
  const int rows = rows_of_contact();
  const auto n = rows * static_cast<Eigen::Index>(second_.considered.size()),
             size = 3 * static_cast<Eigen::Index>(second_.nodes.size());
  second_.curvature.shape(size, size);
  second_.curvature.setZero();
  second_.jacobian.shape(n, size);
  second_.jacobian.setZero();
  if (rows > 1) {
    second_.spread.shape(size, n);
    second_.spread.setZero();
  }
  for (Eigen::Index row = 0; row < n; row += rows) {
    const int k = second_.considered[static_cast<std::size_t>(row / rows)];
    const Contact& c = contacts_[k];
    std::array<Vec3, 3> x;
    std::array<int, 4> slot;
    for (int i = 0; i < c.size; ++i) {
      x[i] = deformed_[c.node[i]];
      slot[i] = second_.slot_of_node[c.node[i]];
      second_.jacobian.block<1, 3>(row, 3 * slot[i]) = -c.weight[i] * c.normal.transpose();
    }
    slot[c.size] = second_.slot_of_node[nodes + c.tool];
    second_.jacobian.block<1, 3>(row, 3 * slot[c.size]) = c.at_tip(c.normal).transpose();
    if (rows > 1) {
      differentiate_friction(k, row, {slot.data(), static_cast<std::size_t>(c.size) + 1});
      continue;
    }
    const double force = lambda_[k];
    if (force == 0) continue;
    const SimplexHessian h =
        hessian_of(c, path_.tools[c.tool].pivots, {x.data(), static_cast<std::size_t>(c.size)}, nullptr);
    for (int i = 0; i <= c.size; ++i) {
      for (int j = 0; j <= c.size; ++j) {
        second_.curvature.block<3, 3>(3 * slot[i], 3 * slot[j]) += force * h.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

/// What a contact with friction adds to A, to the rows of B across the normal, and to S. `slot`: of its
/// nodes, then of the tip.
void ContactSolver::differentiate_friction(int contact, Eigen::Index row,
                                           std::span<const int> slot) noexcept {
  const Contact& c = contacts_[contact];
  const Mat3& frame = frames_[contact];
  std::array<Vec3, 3> x, moved;
  for (int i = 0; i < c.size; ++i) {
    x[i] = deformed_[c.node[i]];
    moved[i] = x[i] - path_.was[c.node[i]];
  }
  WeightGradient weights;
  const SimplexHessian h =
      hessian_of(c, path_.tools[c.tool].pivots, {x.data(), static_cast<std::size_t>(c.size)}, &weights);
  // dn, as d gap / dx_i = -b_i n and the b_i sum to one.
  Eigen::Matrix<double, 3, 12> turn = Eigen::Matrix<double, 3, 12>::Zero();
  for (int i = 0; i < c.size; ++i) turn -= h.middleRows<3>(3 * i);
  Mat3 lever;  // M^T, where the tip's motion moves the tool at the contact by M
  for (int axis = 0; axis < 3; ++axis) lever.col(axis) = c.at_tip(Vec3::Unit(axis));
  const Vec3 force = frame * lambda_.segment<3>(3 * contact);
  // d travel - (normal . travel) dn, without what the nodes and the tip themselves do; and d force.
  Eigen::Matrix<double, 3, 12> slip = -c.normal.dot(travel(c)) * turn, bend;
  for (int i = 0; i < c.size; ++i) slip -= moved[i] * weights.row(i);
  bend =
      lambda_[3 * contact] * turn - c.normal * ((force - lambda_[3 * contact] * c.normal).transpose() * turn);
  for (int j = 0; j <= c.size; ++j) {
    // M is symmetric.
    const Mat3 fraction = j == c.size ? lever : Mat3(-c.weight[j] * Mat3::Identity());
    const int at = 3 * slot[j];
    second_.spread.block<3, 3>(at, row) = fraction * frame;
    second_.jacobian.block<2, 3>(row + 1, at) =
        frame.rightCols<2>().transpose() * (fraction + slip.middleCols<3>(3 * j));
    for (int i = 0; i <= c.size; ++i) {
      Mat3 block = bend.middleCols<3>(3 * j);
      if (i == c.size) {
        block = lever * block;
      } else {
        block *= -c.weight[i];
      }
      if (i < c.size) block -= force * weights.row(i).segment<3>(3 * j);
      second_.curvature.block<3, 3>(3 * slot[i], at) += block;
    }
  }
}

/// False where more is near the tool than there is room for.
bool ContactSolver::differentiate_considered(const ContactPatch& patch) noexcept {
  collect_nodes(patch.nodes());
  if (static_cast<int>(second_.nodes.size()) > most_nodes_ + static_cast<int>(path_.tools.size()) ||
      static_cast<int>(second_.considered.size()) > most_contacts_)
    return false;
  differentiate_contacts(patch.nodes());
  return true;
}

}  // namespace palpate
