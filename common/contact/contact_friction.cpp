// Friction of ContactSolver: it acts at the nodes of the features that touch, across the sum N of the normal
// forces that a node bears, and is bounded by mu |N|.
#include <algorithm>

#include "common/contact/contact_solver.h"

namespace palpate {

/// Finds the nodes at which friction acts, and how the contacts press on them. False: there is room for some
/// of them only.
bool ContactSolver::find_friction_nodes(const ContactPatch& patch) noexcept {
  FrictionNodes& f = friction_nodes_;
  f.places.clear();
  f.shares.clear();
  if (!path_.has_friction || contacts_.empty()) return true;
  bool complete = true;
  const auto slot_of = [&](int tool, int node) {
    return static_cast<std::size_t>(tool * patch.nodes() + node);
  };
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    const Contact& c = contacts_[k];
    for (int i = 0; c.friction > 0 && i < c.size; ++i) {
      int& place = f.at_node[slot_of(c.tool, c.node[i])];
      if (place < 0) {
        if (f.places.size() == f.places.capacity()) {
          complete = false;
          continue;
        }
        place = static_cast<int>(f.places.size());
        f.places.push_back(c);
        f.places.back().node = {c.node[i], -1, -1};
      }
      f.shares.push_back({k, place, c.weight[i]});
    }
  }
  for (const Contact& c : f.places) f.at_node[slot_of(c.tool, c.node[0])] = -1;
  auto force = lambda_.head(static_cast<Eigen::Index>(contacts_.size()));
  recall(force);
  average_contacts(force);
  return complete;
}

/// Gives each node of friction the mean normal, arm and lever of its contacts. They count by the force that
/// they press on the node with, or by their shares of it where nothing presses yet.
void ContactSolver::average_contacts(const Eigen::Ref<const Eigen::VectorXd>& force) noexcept {
  constexpr double kLeast = 1e-14;  // of the largest force: rounding
  // Of it too: what presses less has no derivative that holds for as far as a Newton step goes.
  constexpr double kFaint = 1e-3;
  const double largest = force.maxCoeff(), least = largest > 0 ? kLeast * largest : 1;
  FrictionNodes& f = friction_nodes_;
  f.pressing.assign(f.places.size(), 0);
  for (Contact& place : f.places) {
    place.part = Contact::kTip;
    place.size = 1;
    place.weight = {1, 0, 0};
    place.normal.setZero();
    place.arm.setZero();
    place.fraction = 1;
  }
  for (const FrictionPlaces::Share& s : f.shares) {
    const Contact& c = contacts_[s.contact];
    Contact& place = f.places[s.place];
    double& total = f.pressing[s.place];
    const double presses = s.share * (force[s.contact] + least);
    total += presses;
    if (total == 0) continue;
    place.normal += presses * c.normal;
    place.arm += presses / total * (c.arm - place.arm);
    place.fraction += presses / total * (c.fraction - place.fraction);
    if (c.fraction != 1) place.axis = c.axis;
  }
  f.frames.clear();
  for (std::size_t i = 0; i < f.places.size(); ++i) {
    Vec3& normal = f.places[i].normal;
    const double pressing = normal.norm();
    f.pressing[i] = pressing > kFaint * largest && largest > 0 ? pressing : 0;
    normal = pressing > 0 ? Vec3(normal / pressing) : Vec3::UnitX();
    const Vec3 across = normal.unitOrthogonal();
    f.frames.emplace_back() << normal, across, normal.cross(across);
  }
  for (FrictionPlaces::Share& s : f.shares)
    s.share *= std::max(0.0, f.places[s.place].normal.dot(contacts_[s.contact].normal));
}

/// Differentiates the force N that a contact presses on its nodes with, by the places of nodes and tip and by
/// the force of the contact: fills rows of B across N, and those of |N| below all others, a column of A, and
/// parts of S. `slot`: of its nodes, then of the tip. With N = sum of w lambda n on a node,
///   d|N| = N . dN / |N|,   d(N / |N|) = (1 - n n^T) dN / |N|,   dN = sum of w n dlambda + lambda d(w n).
/// Forces that grow in proportion turn nothing, so no constant term is left.
void ContactSolver::differentiate_friction(int considered, const SimplexHessian* h,
                                           const WeightGradient& weights,
                                           std::span<const int> slot) noexcept {
  const int k = second_.considered[considered];
  const Contact& c = contacts_[k];
  const auto all = static_cast<Eigen::Index>(contacts_.size()),
             contacts = static_cast<Eigen::Index>(second_.considered.size()),
             n = static_cast<Eigen::Index>(second_.rows.size());
  for (const FrictionPlaces::Share& s : second_.shares) {
    if (s.contact != considered) continue;
    const int node = second_.friction_nodes[s.place];
    const double pressing = friction_nodes_.pressing[node];
    if (!(pressing > 0)) continue;
    const Contact& place = friction_nodes_.places[node];
    const auto across = friction_nodes_.frames[node].rightCols<2>();
    const auto corner = std::ranges::find(c.node, place.node[0]) - c.node.begin();
    const Eigen::Index row = contacts + 2 * s.place, place_row = all + 2 * node;
    const Eigen::Vector2d force = lambda_.segment<2>(place_row),
                          turn = c.weight[corner] / pressing * (across.transpose() * c.normal);
    const double passed = place.normal.dot(travel(place_row));
    const Vec3 tip = place.at_tip(place.normal);
    second_.turning.block<2, 1>(row, considered) = -passed * turn;
    second_.spread.block<3, 1>(3 * slot[corner], considered) += force.dot(turn) * place.normal;
    second_.spread.block<3, 1>(3 * slot[c.size], considered) -= force.dot(turn) * tip;
    for (int j = 0; h != nullptr && j <= c.size; ++j) {
      Mat3 change = lambda_[k] * c.normal * weights.block<1, 3>(corner, 3 * j);
      for (int i = 0; i < c.size; ++i)  // dn, as d gap / dx_i = -b_i n and the b_i sum to one
        change -= lambda_[k] * c.weight[corner] * h->block<3, 3>(3 * i, 3 * j);
      const Eigen::Matrix<double, 2, 3> turns = across.transpose() * change / pressing;
      second_.jacobian.block<2, 3>(row, 3 * slot[j]) -= passed * turns;
      second_.jacobian.block<1, 3>(n + s.place, 3 * slot[j]) += place.normal.transpose() * change;
      second_.curvature.block<3, 3>(3 * slot[corner], 3 * slot[j]) +=
          place.normal * (force.transpose() * turns);
      second_.curvature.block<3, 3>(3 * slot[c.size], 3 * slot[j]) -= tip * (force.transpose() * turns);
    }
  }
}

}  // namespace palpate
