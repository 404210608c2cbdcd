// Newton steps of ContactSolver on the features that touch, and the tangent dF/dp.
//
// With y = (nodes, tip), z the forces in the rows of the contacts (lambda, and with friction the components
// of t across the normal) and w(y) their gaps and slips, a solved state obeys u = C A z with A = W^T (n,
// across), and w = -eps z or what friction says. Write B = dw/dy, S = d(A z)/dy at fixed z, and C~ = (I - C
// S)^-1 C for the compliance that this curvature leaves. Without friction A = B^T, and S is symmetric.
//   Newton    u+ = C~ (A z+ - S u),   z+ and w+ = (w - B u - B C~ S u) + (B C~ A + eps) z+ in contact
//   tangent   moving the tool by dP moves the tip coordinate by E dP:
//             dw = B (E + C~ S E) dP + (B C~ A + eps) dz, and dz as contact then says;
//             du = C~ (A dz + S E dP),   dF = E^T (A dz + S (E dP + du))
#include "common/contact/contact_solver.h"
#include "common/contact/dense_solve.h"

namespace palpate {

/// C over the nodes considered; and I - C S over the loaded ones, as elsewhere it is C S to their right and
/// I.
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
  const Eigen::Index first = 3 * unloaded_, loaded = size - first;
  auto system = system_.topLeftCorner(loaded, loaded);
  system.setIdentity();
  system.noalias() -=
      compliance.bottomRightCorner(loaded, loaded) * curvature_.block(first, first, loaded, loaded);
}

/// C~ A, then C~ of `loads` (3 x nodes, k <= 3), in the columns of `response_`; B C~ A + eps; and the sign of
/// the determinant of I - C S.
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
  const Eigen::Index first = 3 * unloaded_, loaded = size - first, columns = n + loads.cols();
  auto at_loads = response_.block(first, 0, loaded, columns);
  system_sign_ = gauss_solve(system_.topLeftCorner(loaded, loaded), at_loads);
  if (system_sign_ == 0) return false;
  if (first > 0) {
    auto bent = bent_.topLeftCorner(loaded, columns);
    bent.noalias() = curvature_.block(first, first, loaded, loaded) * at_loads;
    response_.topLeftCorner(first, columns).noalias() += compliance.topRightCorner(first, loaded) * bent;
  }
  auto delassus = delassus_.topLeftCorner(n, n);
  delassus.noalias() = jacobian * response;
  for (Eigen::Index row = 0; row < n; ++row)
    delassus(row, row) += row % rows == 0 ? contact_compliance_ : friction_compliance_;
  return true;
}

/// Forces of a Newton step without friction, in the rows of the contacts, with the active set of the plain
/// step: contacts that would pull leave it, and those that would be passed enter it. The Delassus operator
/// need not be positive definite: a force may push nodes aside harder than the tissue alone holds them, if
/// the contacts do. False where no active set is found, and where the state would be a saddle of the energy:
/// K - S (K = C^-1) has r negative directions more there than B C~ A, and the determinants of I - C S and of
/// B C~ A then differ in sign for an odd r (inertia of the KKT matrix, Nocedal and Wright 2006,
/// theorem 16.3).
bool ContactSolver::solve_on_active_set(const Eigen::Ref<const Eigen::VectorXd>& gap,
                                        Eigen::Ref<Eigen::VectorXd> force) noexcept {
  constexpr int kExchanges = 4;
  const auto n = gap.size();
  const auto delassus = delassus_.topLeftCorner(n, n);
  active_.clear();
  for (int k = 0; k < n; ++k) {
    if (lambda_[k] > 0) active_.push_back(k);
  }
  for (int exchange = 0; exchange < kExchanges; ++exchange) {
    const auto size = static_cast<Eigen::Index>(active_.size());
    if (size > system_.rows()) return false;
    auto matrix = system_.topLeftCorner(size, size);  // whose own values have been used
    auto solution = rhs_.col(2).head(size);
    for (Eigen::Index j = 0; j < size; ++j) {
      solution[j] = -gap[active_[j]];
      for (Eigen::Index i = 0; i < size; ++i) matrix(i, j) = delassus(active_[i], active_[j]);
    }
    if (gauss_solve(matrix, solution) * system_sign_ <= 0) return false;
    force.setZero();
    for (Eigen::Index i = 0; i < size; ++i) force[active_[i]] = solution[i];
    auto slack = slack_.head(n);
    slack = gap;
    slack.noalias() += delassus * force;
    bool settled = true;
    active_.clear();
    for (int k = 0; k < n; ++k) {
      const bool was_active = force[k] != 0, active = was_active ? force[k] > 0 : slack[k] < 0;
      if (active) active_.push_back(k);
      settled &= active == was_active;
    }
    if (settled) return true;
  }
  return false;
}

/// False where there are no such forces, or where they are those of a state that is not stable.
bool ContactSolver::solve_newton_contacts(const Eigen::Ref<const Eigen::VectorXd>& gap,
                                          Eigen::Ref<Eigen::VectorXd> force) noexcept {
  if (friction_ > 0) return solve_contacts(gap, force);
  return solve_on_active_set(gap, force) || (system_sign_ > 0 && solve_contacts(gap, force));
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
  if (!solve_newton_contacts(gap, lambda)) return false;
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
    return gauss_solve(delassus_.topLeftCorner(n, n), change) != 0;
  }
  auto force = gap_.head(n), slack = slack_.head(n);
  for (Eigen::Index i = 0; i < n; i += 3) {
    const int k = considered_[static_cast<std::size_t>(i / 3)];
    force.segment<3>(i) = lambda_.segment<3>(3 * k);
    slack.segment<3>(i) = friction_compliance_ * force.segment<3>(i);
    slack.segment<2>(i + 1) += frames_[k].rightCols<2>().transpose() * travel(contacts_[k]);
    slack[i] = 0;
  }
  return coulomb_.differentiate(delassus_.topLeftCorner(n, n), force, slack, friction_, change);
}

Mat3 ContactSolver::tangent(const ContactPatch& patch) noexcept {
  if (considered_.empty()) return Mat3::Zero();
  const Mat3 k = tangent_of_considered(patch);
  if (!k.allFinite()) return Mat3::Zero();
  return friction_ > 0 ? k : Mat3(0.5 * (k + k.transpose()));
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
