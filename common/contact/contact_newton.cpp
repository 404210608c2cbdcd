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
namespace {
// Of what moves: a gap that wide is not closed; nor, after Newton's step, which leaves less.
constexpr double kNearby = 2, kNearbyNewton = 0.5;
}  // namespace

/// Calls `visit` with the place among the nodes considered of each node that a row may not be zero for, and
/// of the tip: those of a contact are its own.
template <class Visit>
void ContactSolver::each_slot(Eigen::Index row, const Visit& visit) const {
  if (row >= static_cast<Eigen::Index>(second_.considered.size())) {
    for (int slot = 0; slot < static_cast<int>(second_.nodes.size()); ++slot) visit(slot);
    return;
  }
  const Contact& c = contacts_[second_.considered[static_cast<std::size_t>(row)]];
  for (int i = 0; i < c.size; ++i) visit(second_.slot_of_node[c.node[i]]);
  visit(static_cast<int>(tip_of(c.tool)));
}

/// Calls `visit` with the first row and column of each block (3 x 3) of S that is not zero, among those of
/// the loaded nodes.
template <class Visit>
void ContactSolver::each_block_of_curvature(const Visit& visit) const {
  for (Eigen::Index j = 3 * second_.unloaded; j < second_.curvature.cols(); j += 3) {
    for (Eigen::Index i = 3 * second_.unloaded; i < second_.curvature.rows(); i += 3) {
      if (const Mat3 block = second_.curvature.block<3, 3>(i, j); !block.isZero(0)) visit(i, j, block);
    }
  }
}

/// C over the nodes considered; and I - C S over the loaded ones, as elsewhere it is C S to their right and
/// I.
void ContactSolver::assemble_system(const ContactPatch& patch) noexcept {
  const auto count = static_cast<Eigen::Index>(second_.nodes.size()), size = 3 * count;
  second_.compliance.shape(size, size);
  second_.compliance.setZero();
  const auto tips = static_cast<Eigen::Index>(path_.tools.size());
  for (Eigen::Index j = 0; j + tips < count; ++j) {
    for (Eigen::Index i = 0; i + tips < count; ++i) {
      second_.compliance.block<3, 3>(3 * i, 3 * j) =
          patch.compliance.block<3, 3>(3 * second_.nodes[i], 3 * second_.nodes[j]);
    }
  }
  second_.compliance.bottomRightCorner(3 * tips, 3 * tips).diagonal().setConstant(patch.tool_compliance);
  const Eigen::Index first = 3 * second_.unloaded, loaded = size - first;
  second_.system.shape(loaded, loaded);
  second_.system.setIdentity();
  each_block_of_curvature([&](Eigen::Index i, Eigen::Index j, const Mat3& block) {
    second_.system.middleCols<3>(j - first) -=
        second_.compliance.block(first, i, loaded, 3).lazyProduct(block);
  });
}

/// C A, or C B^T, column by column, over the rows from `first` on.
void ContactSolver::spread_over(Eigen::Index first, bool forces,
                                Eigen::Ref<Eigen::MatrixXd> moved) const noexcept {
  const bool by_spread = forces && !second_.friction_nodes.empty();
  moved.setZero();
  for (Eigen::Index column = 0; column < moved.cols(); ++column) {
    each_slot(column, [&](int slot) {
      const Vec3 load = by_spread ? Vec3(second_.spread.block<3, 1>(3 * slot, column))
                                  : Vec3(second_.jacobian.block<1, 3>(column, 3 * slot).transpose());
      if (load.isZero(0)) return;
      moved.col(column) += second_.compliance.block(first, 3 * slot, moved.rows(), 3).lazyProduct(load);
    });
  }
}

/// Rows of B of the columns of `response_`.
void ContactSolver::find_gap_changes(Eigen::Index from, Eigen::Index to) noexcept {
  for (Eigen::Index row = from; row < to; ++row) {
    second_.gap_changes.clear();
    each_slot(row, [&](int slot) {
      const Vec3 by = second_.jacobian.block<1, 3>(row, 3 * slot).transpose();
      if (!by.isZero(0)) second_.gap_changes.push_back({3 * slot, by});
    });
    for (Eigen::Index column = 0; column < delassus_.cols(); ++column) {
      const auto moved = response_.col(column);
      double change = 0;
      for (const GapChange& entry : second_.gap_changes)
        change += entry.by[0] * moved[entry.at] +
                  (entry.by[1] * moved[entry.at + 1] + entry.by[2] * moved[entry.at + 2]);
      delassus_(row, column) = change;
    }
  }
}

/// C~ of the forces of the contacts, A, then of `loads` (3 x nodes, k <= 3), over the loaded nodes, in the
/// columns of `response_`; B of that, and eps, in `delassus_` (n x n + k); and the sign of the determinant of
/// I - C S. With the compliance that the curvature adds over the loaded nodes alone: C~ = C + C S C~.
bool ContactSolver::respond(const ContactPatch& patch,
                            const Eigen::Ref<const Eigen::MatrixXd>& loads) noexcept {
  const auto unknowns =
                 3.0 * static_cast<double>(second_.nodes.size() - static_cast<std::size_t>(second_.unloaded)),
             right = static_cast<double>(second_.rows.size()) + 3;
  if (!work_.spend(unknowns * unknowns * (unknowns / 3 + right + 30))) return false;
  assemble_system(patch);
  const auto n = static_cast<Eigen::Index>(second_.rows.size()), size = loads.rows(),
             rows = second_.jacobian.rows();
  const Eigen::Index first = 3 * second_.unloaded, loaded = size - first, columns = n + loads.cols();
  response_.shape(size, columns);
  spread_over(0, true, response_.leftCols(n));
  response_.rightCols(loads.cols()).noalias() = second_.compliance * loads;
  const auto contacts = static_cast<Eigen::Index>(second_.considered.size());
  delassus_.shape(rows, columns);
  find_gap_changes(0, contacts);
  second_.toward.shape(loaded, contacts);  // C B^T: so the rows of contacts stay symmetric
  if (rows == contacts) {
    second_.toward = response_.bottomLeftCorner(loaded, contacts);
  } else {
    spread_over(first, false, second_.toward);
  }
  auto at_loads = response_.bottomRows(loaded);
  second_.system_sign = gauss_solve(second_.system, at_loads);
  if (second_.system_sign == 0) return false;
  second_.bent.shape(loaded, columns);
  second_.bent.setZero();
  each_block_of_curvature([&](Eigen::Index i, Eigen::Index j, const Mat3& block) {
    second_.bent.middleRows<3>(i - first) += block.lazyProduct(at_loads.middleRows<3>(j - first));
  });
  delassus_.topRows(contacts).noalias() += second_.toward.transpose() * second_.bent;
  if (rows > contacts) {
    response_.topRows(first).noalias() += second_.compliance.topRightCorner(first, loaded) * second_.bent;
    find_gap_changes(contacts, rows);
    delassus_.topLeftCorner(n, contacts) += second_.turning;
  }
  for (Eigen::Index row = 0; row < n; ++row)
    delassus_(row, row) += row < contacts ? contact_compliance_ : friction_compliance_;
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
  constexpr int kExchanges = 4;  // of the active set in an iteration; the next iteration goes on from there
  const auto n = gap.size();
  second_.active.clear();
  for (int k = 0; k < n; ++k) {
    if (lambda_[second_.considered[static_cast<std::size_t>(k)]] > 0) second_.active.push_back(k);
  }
  for (int exchange = 0; exchange < kExchanges; ++exchange) {
    const auto size = static_cast<Eigen::Index>(second_.active.size());
    if (static_cast<std::size_t>(size * size) * sizeof(double) > second_.system.bytes()) return false;
    second_.system.shape(size, size);  // whose own values have been used
    auto solution = second_.rhs.col(2).head(size);
    for (Eigen::Index j = 0; j < size; ++j) {
      solution[j] = -gap[second_.active[j]];
      for (Eigen::Index i = 0; i < size; ++i)
        second_.system(i, j) = delassus_(second_.active[i], second_.active[j]);
    }
    if (gauss_solve(second_.system, solution) * second_.system_sign <= 0) return false;
    force.setZero();
    for (Eigen::Index i = 0; i < size; ++i) force[second_.active[i]] = solution[i];
    auto slack = slack_.head(n);
    slack = gap;
    slack.noalias() += delassus_.leftCols(n) * force;
    bool settled = true;
    second_.active.clear();
    for (int k = 0; k < n; ++k) {
      const bool was_active = force[k] != 0, active = was_active ? force[k] > 0 : slack[k] < 0;
      if (active) second_.active.push_back(k);
      settled &= active == was_active;
    }
    if (settled) return true;
  }
  return false;
}

/// False where there are no such forces, or where they are those of a state that is not stable.
bool ContactSolver::solve_newton_contacts(const Eigen::Ref<const Eigen::VectorXd>& gap,
                                          Eigen::Ref<Eigen::VectorXd> force) noexcept {
  const bool friction = !second_.friction_nodes.empty();
  if (!friction && solve_on_active_set(gap, force)) return true;
  if (!friction && second_.system_sign <= 0) return false;
  for (Eigen::Index row = 0; row < force.size(); ++row)
    force[row] = lambda_[second_.rows[static_cast<std::size_t>(row)]];
  return solve_contacts(gap, force, friction);
}

/// The contacts that a Newton step may close or open where things move by `change` (m): those with a force,
/// and those whose gap is small; without friction, that which the plain step leaves.
void ContactSolver::consider_near(double change) noexcept {
  second_.considered.clear();
  const auto n = static_cast<Eigen::Index>(contacts_.size());
  if (!path_.has_friction) {
    auto slack = slack_.head(n);
    slack = gap_.head(n);
    slack.noalias() += delassus_ * lambda_.head(n);
  }
  for (int k = 0; k < n; ++k) {
    const bool near = path_.has_friction ? lambda_[k] > 0 || contacts_[k].distance - contacts_[k].radius <
                                                                 kNearbyNewton * change
                                         : lambda_[k] > 0 || slack_[k] < kNearby * change;
    if (near) second_.considered.push_back(k);
  }
  consider();
}

bool ContactSolver::newton_step(const ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u,
                                double change, Eigen::Ref<Eigen::VectorXd> next) noexcept {
  consider_near(change);
  if (second_.considered.empty()) return false;
  if (!differentiate_considered(patch)) return false;
  const auto n = static_cast<Eigen::Index>(second_.rows.size()),
             size = 3 * static_cast<Eigen::Index>(second_.nodes.size());
  const Eigen::Index loaded = size - 3 * second_.unloaded;
  auto local = second_.moved.col(0).head(size), load = second_.moved.col(1).head(size);
  for (std::size_t i = 0; i < second_.nodes.size(); ++i) {
    local.segment<3>(3 * static_cast<Eigen::Index>(i)) = u.segment<3>(3 * second_.nodes[i]);
  }
  load.noalias() = second_.curvature * local;
  if (!respond(patch, load)) return false;
  auto gap = second_.rhs.col(0).head(second_.jacobian.rows()), lambda = second_.rhs.col(1).head(n);
  gap.tail(gap.size() - n).setZero();
  for (Eigen::Index row = 0; row < n; ++row)  // w - A^T u, which `gap_` holds
    gap[row] = gap_[second_.rows[static_cast<std::size_t>(row)]];
  gap -= delassus_.col(n);  // B C~ S u
  if (!second_.friction_nodes.empty()) {
    const auto contacts = static_cast<Eigen::Index>(second_.considered.size());
    for (Eigen::Index row = contacts; row < n; ++row)
      gap[row] += along(second_.rows[static_cast<std::size_t>(row)], patch.nodes(), u);
    gap.tail(gap.size() - contacts).noalias() -= second_.jacobian.bottomRows(gap.size() - contacts) * local;
  }
  if (!solve_newton_contacts(gap, lambda)) return false;
  auto forces = lambda_.head(rows());
  forces.setZero();
  for (Eigen::Index row = 0; row < n; ++row)
    forces[second_.rows[static_cast<std::size_t>(row)]] = lambda[row];
  store(forces);
  // Force at the new geometry, to first order: A z+ + S (u+ - u).
  auto moved = second_.moved.col(2).head(loaded);  // u+ - u of the loaded nodes
  moved = -response_.col(n).tail(loaded) - local.tail(loaded);
  moved.noalias() += response_.bottomLeftCorner(loaded, n) * lambda;
  load.noalias() = second_.curvature.rightCols(loaded) * moved;
  if (!second_.friction_nodes.empty()) {
    load.noalias() += second_.spread * lambda;
  } else {
    load.noalias() += second_.jacobian.transpose() * lambda;
  }
  node_force_.head(3 * patch.nodes()).setZero();
  for (Eigen::Index i = 0; i < tip_of(0); ++i)
    node_force_.segment<3>(3 * second_.nodes[i]) = load.segment<3>(3 * i);
  for (std::size_t t = 0; t < path_.tools.size(); ++t)
    path_.tools[t].tip_load = load.segment<3>(3 * tip_of(static_cast<int>(t)));
  displace(patch, next);
  return next.allFinite();
}

/// Contact forces that follow where gaps and slips are about to change by `change`, which they overwrite.
bool ContactSolver::differentiate_forces(
    Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept {
  const auto n = static_cast<Eigen::Index>(second_.rows.size());
  if (second_.friction_nodes.empty()) {
    change = -change;
    return gauss_solve(delassus_.leftCols(n), change) != 0;
  }
  auto force = gap_.head(n), slack = slack_.head(n);
  for (Eigen::Index i = 0; i < n; ++i) force[i] = lambda_[second_.rows[static_cast<std::size_t>(i)]];
  const auto contacts = static_cast<Eigen::Index>(second_.considered.size());
  slack.head(contacts).setZero();
  for (Eigen::Index i = contacts; i < n; ++i) {
    const int row = second_.rows[static_cast<std::size_t>(i)];
    slack[i] = friction_compliance_ * force[i] + direction(row).dot(travel(row));
  }
  return coulomb_.differentiate(delassus_.leftCols(n), force, slack, friction_considered(), change);
}

Mat3 ContactSolver::tangent(const ContactPatch& patch, int tool) noexcept {
  second_.has_load_change = false;
  second_.considered.clear();
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (contacts_[k].tool == tool && lambda_[k] > 0) second_.considered.push_back(k);
  }
  consider();
  if (second_.considered.empty()) return Mat3::Zero();
  const Mat3 k = tangent_of_considered(patch, tool);
  if (!k.allFinite()) return Mat3::Zero();
  second_.has_load_change = second_.friction_nodes.empty() && !k.isZero(0);
  return !second_.friction_nodes.empty() ? k : Mat3(0.5 * (k + k.transpose()));
}

Mat3 ContactSolver::tangent_of_considered(const ContactPatch& patch, int tool) noexcept {
  if (!differentiate_considered(patch)) return Mat3::Zero();
  const auto n = static_cast<Eigen::Index>(second_.rows.size()),
             size = 3 * static_cast<Eigen::Index>(second_.nodes.size());
  auto moved = second_.moved.topRows(size);  // E + C~ S E: how the geometry follows the tool at fixed forces
  if (!respond(patch, second_.curvature.middleCols<3>(3 * tip_of(tool)))) return Mat3::Zero();
  moved = response_.rightCols<3>();
  moved.middleRows<3>(3 * tip_of(tool)) += Mat3::Identity();
  auto change = second_.rhs.topRows(second_.jacobian.rows());
  change.noalias() = second_.jacobian * moved;
  if (!differentiate_forces(change)) return Mat3::Zero();
  const auto force_change = change.topRows(n);
  moved.noalias() += response_.leftCols(n) * force_change;
  auto loads = second_.load_change.topRows(size);
  loads.noalias() = second_.curvature * moved;
  if (!second_.friction_nodes.empty()) {
    loads.noalias() += second_.spread * force_change;
  } else {
    loads.noalias() += second_.jacobian.transpose() * force_change;
  }
  return loads.middleRows<3>(3 * tip_of(tool));
}

}  // namespace palpate
