// Second-order work of ContactSolver on the features that touch: Newton steps, and the tangent dF/dp.
//
// With y = (nodes, tip), z the forces in the rows of the contacts (lambda, and with friction the components
// of t across the normal) and w(y) their gaps and slips, a solved state obeys u = C A z with A = W^T (n,
// across), and w = -eps z or what friction says. Write B = dw/dy, S = d(A z)/dy at fixed z, and C~ = (I - C
// S)^-1 C for the compliance that this curvature leaves. Without friction A = B^T, and S is symmetric.
//   Newton    u+ = C~ (A z+ - S u),   z+ and w+ = (w - B u - B C~ S u) + (B C~ A + eps) z+ in contact
//   tangent   moving the tool by dP moves the tip coordinate by E dP:
//             dw = B (E + C~ S E) dP + (B C~ A + eps) dz, and dz as contact then says;
//             du = C~ (A dz + S E dP),   dF = E^T (A dz + S (E dP + du))
// A direction d across the normal turns with it and no more: dd = -n (d . dn).
#include <algorithm>

#include "common/contact/contact_solver.h"
#include "common/contact/dense_solve.h"
#include "common/contact/simplex_distance.h"

namespace palpate {

namespace {

/// Second derivative of the gap of a contact whose corners are at `x`.
SimplexHessian hessian_of(const Contact& c, bool pivots, std::span<const Vec3> x, WeightGradient* weights) {
  const SlidingPoint sliding{c.axis, c.share, pivots};
  return distance_hessian(x, {c.weight.data(), x.size()}, c.normal, c.distance, weights,
                          c.part == Contact::kShaft ? &sliding : nullptr);
}

}  // namespace

Mat3 ContactSolver::tangent(const ContactPatch& patch) noexcept {
  if (considered_.empty()) return Mat3::Zero();
  const Mat3 k = tangent_of_considered(patch);
  if (!k.allFinite()) return Mat3::Zero();
  return friction_ > 0 ? k : Mat3(0.5 * (k + k.transpose()));
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

void ContactSolver::differentiate_contacts(int tip) noexcept {
  const int rows = rows_of_contact();
  const auto n = rows * static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  auto curvature = curvature_.topLeftCorner(size, size);
  auto jacobian = jacobian_.topLeftCorner(n, size);
  curvature.setZero();
  jacobian.setZero();
  if (rows > 1) spread_.topLeftCorner(size, n).setZero();
  for (Eigen::Index row = 0; row < n; row += rows) {
    const int k = considered_[static_cast<std::size_t>(row / rows)];
    const Contact& c = contacts_[k];
    std::array<Vec3, 3> x;
    std::array<int, 4> slot;
    for (int i = 0; i < c.size; ++i) {
      x[i] = deformed_[c.node[i]];
      slot[i] = slot_of_node_[c.node[i]];
      jacobian.block<1, 3>(row, 3 * slot[i]) = -c.weight[i] * c.normal.transpose();
    }
    slot[c.size] = slot_of_node_[tip];
    jacobian.block<1, 3>(row, 3 * slot[c.size]) = c.at_tip(c.normal).transpose();
    if (rows > 1) {
      differentiate_friction(k, row, {slot.data(), static_cast<std::size_t>(c.size) + 1});
      continue;
    }
    const double force = lambda_[k];
    if (force == 0) continue;
    const SimplexHessian h = hessian_of(c, pivots_, {x.data(), static_cast<std::size_t>(c.size)}, nullptr);
    for (int i = 0; i <= c.size; ++i) {
      for (int j = 0; j <= c.size; ++j) {
        curvature.block<3, 3>(3 * slot[i], 3 * slot[j]) += force * h.block<3, 3>(3 * i, 3 * j);
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
    moved[i] = x[i] - was_[c.node[i]];
  }
  WeightGradient weights;
  const SimplexHessian h = hessian_of(c, pivots_, {x.data(), static_cast<std::size_t>(c.size)}, &weights);
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
    const Mat3 share = j == c.size ? lever : Mat3(-c.weight[j] * Mat3::Identity());
    const int at = 3 * slot[j];
    spread_.block<3, 3>(at, row) = share * frame;
    jacobian_.block<2, 3>(row + 1, at) =
        frame.rightCols<2>().transpose() * (share + slip.middleCols<3>(3 * j));
    for (int i = 0; i <= c.size; ++i) {
      Mat3 block = bend.middleCols<3>(3 * j);
      if (i == c.size) {
        block = lever * block;
      } else {
        block *= -c.weight[i];
      }
      if (i < c.size) block -= force * weights.row(i).segment<3>(3 * j);
      curvature_.block<3, 3>(3 * slot[i], at) += block;
    }
  }
}

/// C over the nodes considered, and I - C S.
void ContactSolver::assemble_system(const ContactPatch& patch) noexcept {
  const auto count = static_cast<Eigen::Index>(nodes_.size()), size = 3 * count;
  auto compliance = compliance_.topLeftCorner(size, size);
  compliance.setZero();
  for (Eigen::Index j = 0; j + 1 < count; ++j) {
    for (Eigen::Index i = 0; i + 1 < count; ++i) {
      compliance.block<3, 3>(3 * i, 3 * j) = patch.compliance.block<3, 3>(3 * nodes_[i], 3 * nodes_[j]);
    }
  }
  compliance.bottomRightCorner<3, 3>().diagonal().setConstant(patch.tool_compliance);
  auto system = system_.topLeftCorner(size, size);
  system.setIdentity();
  system.noalias() -= compliance * curvature_.topLeftCorner(size, size);
}

void ContactSolver::differentiate_considered(const ContactPatch& patch) noexcept {
  collect_nodes(patch.nodes());
  differentiate_contacts(patch.nodes());
}

/// C~ A, then C~ of `loads` (3 x nodes, k <= 3), in the columns of `response_`; and B C~ A + eps.
bool ContactSolver::respond(const ContactPatch& patch,
                            const Eigen::Ref<const Eigen::MatrixXd>& loads) noexcept {
  assemble_system(patch);
  const int rows = rows_of_contact();
  const auto n = rows * static_cast<Eigen::Index>(considered_.size()), size = loads.rows();
  const auto compliance = compliance_.topLeftCorner(size, size);
  const auto jacobian = jacobian_.topLeftCorner(n, size);
  auto response = response_.topLeftCorner(size, n);  // the columns of the solve are no longer needed
  if (rows > 1) {
    response.noalias() = compliance * spread_.topLeftCorner(size, n);
  } else {
    response.noalias() = compliance * jacobian.transpose();
  }
  response_.block(0, n, size, loads.cols()).noalias() = compliance * loads;
  if (!gauss_solve(system_.topLeftCorner(size, size), response_.topLeftCorner(size, n + loads.cols())))
    return false;
  auto delassus = delassus_.topLeftCorner(n, n);
  delassus.noalias() = jacobian * response;
  for (Eigen::Index row = 0; row < n; ++row)
    delassus(row, row) += row % rows == 0 ? kContactCompliance : kFrictionCompliance;
  return true;
}

bool ContactSolver::newton_step(const ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u,
                                Eigen::Ref<Eigen::VectorXd> next) noexcept {
  considered_.clear();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) considered_.push_back(k);
  if (considered_.empty()) return false;
  differentiate_considered(patch);
  const auto n = rows_of_contact() * static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  const auto jacobian = jacobian_.topLeftCorner(n, size);
  auto local = moved_.col(0).head(size), load = moved_.col(1).head(size), bent = moved_.col(2).head(size);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    local.segment<3>(3 * static_cast<Eigen::Index>(i)) = u.segment<3>(3 * nodes_[i]);
  }
  load.noalias() = curvature_.topLeftCorner(size, size) * local;
  if (!respond(patch, load)) return false;
  bent = response_.col(n).head(size);  // C~ S u
  auto gap = rhs_.col(0).head(n), lambda = rhs_.col(1).head(n);
  gap = gap_.head(n);  // which is w - A^T u already
  gap.noalias() -= jacobian * bent;
  if (friction_ > 0) {
    gap.noalias() += spread_.topLeftCorner(size, n).transpose() * local;
    gap.noalias() -= jacobian * local;
  }
  if (!solve_contacts(gap, lambda)) return false;
  remember(lambda);
  // Force at the new geometry, to first order: A z+ + S (u+ - u).
  const auto response = response_.topLeftCorner(size, n);
  bent = -bent - local;  // becomes u+ - u
  bent.noalias() += response * lambda;
  load.noalias() = curvature_.topLeftCorner(size, size) * bent;
  if (friction_ > 0) {
    load.noalias() += spread_.topLeftCorner(size, n) * lambda;
  } else {
    load.noalias() += jacobian.transpose() * lambda;
  }
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

/// Contact forces that follow where gaps and slips are about to change by `change`, which they overwrite.
bool ContactSolver::differentiate_forces(
    Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept {
  const auto n = change.rows();
  if (friction_ == 0) {
    change = -change;
    return gauss_solve(delassus_.topLeftCorner(n, n), change);
  }
  auto force = gap_.head(n), slack = slack_.head(n);
  for (Eigen::Index i = 0; i < n; i += 3) {
    const int k = considered_[static_cast<std::size_t>(i / 3)];
    force.segment<3>(i) = lambda_.segment<3>(3 * k);
    slack.segment<3>(i) = kFrictionCompliance * force.segment<3>(i);
    slack.segment<2>(i + 1) += frames_[k].rightCols<2>().transpose() * travel(contacts_[k]);
    slack[i] = 0;
  }
  return coulomb_.differentiate(delassus_.topLeftCorner(n, n), force, slack, friction_, change);
}

Mat3 ContactSolver::tangent_of_considered(const ContactPatch& patch) noexcept {
  differentiate_considered(patch);
  const auto n = rows_of_contact() * static_cast<Eigen::Index>(considered_.size()),
             size = 3 * static_cast<Eigen::Index>(nodes_.size());
  const auto jacobian = jacobian_.topLeftCorner(n, size);
  const auto curvature = curvature_.topLeftCorner(size, size);
  auto moved = moved_.topRows(size);  // E + C~ S E: how the geometry follows the tool at fixed forces
  if (!respond(patch, curvature.rightCols<3>())) return Mat3::Zero();
  moved = response_.block(0, n, size, 3);
  moved.bottomRows<3>() += Mat3::Identity();
  auto force_change = rhs_.topRows(n);
  force_change.noalias() = jacobian * moved;
  if (!differentiate_forces(force_change)) return Mat3::Zero();
  moved.noalias() += response_.topLeftCorner(size, n) * force_change;
  Mat3 k;
  if (friction_ > 0) {
    k.noalias() = spread_.block(size - 3, 0, 3, n) * force_change;
  } else {
    k = jacobian.rightCols<3>().transpose() * force_change;
  }
  k.noalias() += curvature.bottomRows<3>() * moved;
  return k;
}

}  // namespace palpate
