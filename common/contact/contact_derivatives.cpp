// Second-order work of ContactSolver on the features that touch: Newton steps, and the tangent dF/dp.
//
// With y = (nodes, tip) and gap_k(y), a solved state obeys u = C sum_k lambda_k J_k^T and gap_k = -eps
// lambda_k. Write S = sum_k lambda_k Hess(gap_k) for the curvature of the gaps and C~ = (I - C S)^-1 C for
// the compliance it leaves.
//   Newton    u+ = C~ (J^T lambda+ - S u),   0 <= lambda+ _|_ (gap - J u - J C~ S u) + (J C~ J^T + eps)
//   lambda+ >= 0 tangent   moving the tool by dP moves the tip coordinate by E dP:
//             (J C~ J^T + eps) dlambda = -J (E + C~ S E) dP,     du = C~ (J^T dlambda + S E dP)
//             dF = E^T (J^T dlambda + S (E dP + du))
#include <algorithm>

#include "common/contact/contact_solver.h"
#include "common/contact/dense_solve.h"
#include "common/contact/simplex_distance.h"

namespace palpate {

Mat3 ContactSolver::tangent(const ContactPatch& patch) noexcept {
  if (considered_.empty()) return Mat3::Zero();
  const Mat3 k = tangent_of_considered(patch);
  return k.allFinite() ? Mat3(0.5 * (k + k.transpose())) : Mat3::Zero();
}

void ContactSolver::collect_nodes(int tip) noexcept {
  nodes_.clear();
  std::fill_n(slot_of_node_.begin(), tip + 1, -1);
  const auto add = [&](int node) {
    if (slot_of_node_[node] >= 0) return;
    slot_of_node_[node] = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
  };
  for (const int k : considered_) {
    for (int i = 0; i < contacts_[k].size; ++i) add(contacts_[k].node[i]);
  }
  add(tip);
}

void ContactSolver::differentiate_gaps(int tip) noexcept {
  const auto n = static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  auto curvature = curvature_.topLeftCorner(size, size);
  auto jacobian = jacobian_.topLeftCorner(n, size);
  curvature.setZero();
  jacobian.setZero();
  for (Eigen::Index row = 0; row < n; ++row) {
    const Contact& c = contacts_[considered_[row]];
    std::array<Vec3, 3> x;
    std::array<int, 4> slot;
    for (int i = 0; i < c.size; ++i) {
      x[i] = deformed_[c.node[i]];
      slot[i] = slot_of_node_[c.node[i]];
      jacobian.block<1, 3>(row, 3 * slot[i]) = -c.weight[i] * c.normal.transpose();
    }
    slot[c.size] = slot_of_node_[tip];
    jacobian.block<1, 3>(row, 3 * slot[c.size]) = c.normal.transpose();
    const double force = lambda_[considered_[row]];
    if (force == 0) continue;
    const SimplexHessian h =
        distance_hessian({x.data(), static_cast<std::size_t>(c.size)},
                         {c.weight.data(), static_cast<std::size_t>(c.size)}, c.normal, c.distance);
    for (int i = 0; i <= c.size; ++i) {
      for (int j = 0; j <= c.size; ++j) {
        curvature.block<3, 3>(3 * slot[i], 3 * slot[j]) += force * h.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

bool ContactSolver::compute_effective_compliance(const ContactPatch& patch) noexcept {
  const auto count = static_cast<Eigen::Index>(nodes_.size()), size = 3 * count;
  auto effective = effective_.topLeftCorner(size, size);
  effective.setZero();
  for (Eigen::Index j = 0; j + 1 < count; ++j) {
    for (Eigen::Index i = 0; i + 1 < count; ++i) {
      effective.block<3, 3>(3 * i, 3 * j) = patch.compliance.block<3, 3>(3 * nodes_[i], 3 * nodes_[j]);
    }
  }
  effective.bottomRightCorner<3, 3>().diagonal().setConstant(patch.tool_compliance);
  auto system = system_.topLeftCorner(size, size);
  system.setIdentity();
  system.noalias() -= effective * curvature_.topLeftCorner(size, size);
  return gauss_solve(system, effective);
}

bool ContactSolver::prepare_considered(const ContactPatch& patch) noexcept {
  collect_nodes(patch.nodes());
  differentiate_gaps(patch.nodes());
  if (!compute_effective_compliance(patch)) return false;
  const auto n = static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  const auto jacobian = jacobian_.topLeftCorner(n, size);
  auto response = response_.topLeftCorner(size, n);  // C~ J^T; the columns of the solve are no longer needed
  response.noalias() = effective_.topLeftCorner(size, size) * jacobian.transpose();
  auto delassus = delassus_.topLeftCorner(n, n);
  delassus.noalias() = jacobian * response;
  delassus.diagonal().array() += kContactCompliance;
  return true;
}

bool ContactSolver::newton_step(const ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u,
                                Eigen::Ref<Eigen::VectorXd> next) noexcept {
  considered_.clear();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) considered_.push_back(k);
  if (considered_.empty() || !prepare_considered(patch)) return false;
  const auto n = static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  const auto jacobian = jacobian_.topLeftCorner(n, size);
  auto local = moved_.col(0).head(size), load = moved_.col(1).head(size), bent = moved_.col(2).head(size);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    local.segment<3>(3 * static_cast<Eigen::Index>(i)) = u.segment<3>(3 * nodes_[i]);
  }
  load.noalias() = curvature_.topLeftCorner(size, size) * local;
  bent.noalias() = effective_.topLeftCorner(size, size) * load;  // C~ S u
  auto gap = rhs_.col(0).head(n), lambda = rhs_.col(1).head(n);
  gap = gap_.head(n);  // which is gap - J u already
  gap.noalias() -= jacobian * bent;
  if (!complementarity_.solve(delassus_.topLeftCorner(n, n), gap, lambda)) return false;
  // Force at the new geometry, to first order: J^T lambda+ + S (u+ - u).
  const auto response = response_.topLeftCorner(size, n);
  bent = -bent - local;  // becomes u+ - u
  bent.noalias() += response * lambda;
  load.noalias() = curvature_.topLeftCorner(size, size) * bent;
  load.noalias() += jacobian.transpose() * lambda;
  next.setZero();
  const auto rows = 3 * static_cast<Eigen::Index>(patch.nodes());
  for (Eigen::Index i = 0; i + 1 < static_cast<Eigen::Index>(nodes_.size()); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      next.head(rows) += load[3 * i + axis] * patch.compliance.col(3 * nodes_[i] + axis).head(rows);
    }
  }
  next.tail<3>() = patch.tool_compliance * load.tail<3>();
  return next.allFinite();
}

Mat3 ContactSolver::tangent_of_considered(const ContactPatch& patch) noexcept {
  if (!prepare_considered(patch)) return Mat3::Zero();
  const auto n = static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  const auto jacobian = jacobian_.topLeftCorner(n, size);
  const auto curvature = curvature_.topLeftCorner(size, size);
  auto moved = moved_.topRows(size);  // E + C~ S E: how the geometry follows the tool at fixed lambda
  moved.noalias() = effective_.topLeftCorner(size, size) * curvature.rightCols<3>();
  moved.bottomRows<3>() += Mat3::Identity();
  auto force_change = rhs_.topRows(n);
  force_change.noalias() = -jacobian * moved;
  if (!gauss_solve(delassus_.topLeftCorner(n, n), force_change)) return Mat3::Zero();
  moved.noalias() += response_.topLeftCorner(size, n) * force_change;
  Mat3 k = jacobian.rightCols<3>().transpose() * force_change;
  k.noalias() += curvature.bottomRows<3>() * moved;
  return k;
}

}  // namespace palpate
