#include "sim_server/deformation/hand_over.h"

#include <fmt/core.h>

#include "common/error.h"
#include "common/memory_budget.h"

namespace palpate::sim {

HandOver::HandOver(CuttableBody& after, const CuttableBody& before, const std::vector<int>& places)
    : after_(after), force_(after.motion.state.u.size()) {
  const std::vector<int>& now = after.tensors.places();
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (now[v] >= 0 && places[v] < 0) joining_.push_back({static_cast<int>(v), 3 * now[v]});
  }
  const auto size = static_cast<Eigen::Index>(3 * joining_.size());
  require_memory(2.0 * sizeof(double) * static_cast<double>(size * size), free_memory(), "[cutting.growth]",
                 fmt::format("{} vertices that join what is in motion", joining_.size()),
                 "a smaller `reach` takes less");
  Eigen::MatrixXd stiffness(size, size);
  std::vector<double> x(force_.size(), 0);
  for (Eigen::Index k = 0; k < size; ++k) {
    double& moved = x[static_cast<std::size_t>(joining_[static_cast<std::size_t>(k / 3)].number + k % 3)];
    moved = 1;
    after.static_force(x, {}, force_);
    moved = 0;
    for (std::size_t i = 0; i < joining_.size(); ++i)
      stiffness.block<3, 1>(3 * static_cast<Eigen::Index>(i), k) =
          -Eigen::Map<const Vec3>(force_.data() + joining_[i].number);
  }
  stiffness_.compute(stiffness);
  if (size > 0 && stiffness_.info() != Eigen::Success) fail("what would join is held by nothing");
  overlaps_ = after.rest->overlap_with(*before.rest);
}

/// Of all that is in motion in both.
std::vector<double> HandOver::shared(const CuttableBody& before, const std::vector<double>& of_before) const {
  const std::vector<int>&was = before.tensors.places(), &now = after_.tensors.places();
  std::vector<double> x(after_.motion.state.u.size(), 0);
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (was[v] >= 0 && now[v] >= 0)
      Eigen::Map<Vec3>(x.data() + 3 * now[v]) = Eigen::Map<const Vec3>(of_before.data() + 3 * was[v]);
  }
  return x;
}

/// Vertices that join go to where these loads balance, and so do the modes of the rest.
void HandOver::balance(std::vector<double>& x, std::span<const NodalLoad> loads) {
  after_.static_force(x, loads, force_);
  Eigen::VectorXd moved(static_cast<Eigen::Index>(3 * joining_.size()));
  for (std::size_t i = 0; i < joining_.size(); ++i)
    moved.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Vec3>(force_.data() + joining_[i].number);
  if (moved.size() > 0) stiffness_.solveInPlace(moved);
  for (std::size_t i = 0; i < joining_.size(); ++i)
    Eigen::Map<Vec3>(x.data() + joining_[i].number) = moved.segment<3>(3 * static_cast<Eigen::Index>(i));
  after_.static_force(x, loads, force_);
}

void HandOver::operator()(CuttableBody& before, std::span<const NodalLoad> loads) {
  CondensedRest::Swing swing = before.rest->swing(), balanced, still;
  std::vector<double> v = shared(before, before.motion.state.v), u = shared(before, before.motion.state.u);
  force_.resize(u.size());
  balance(v, {});
  balanced.v = after_.rest->swing().p;
  before.rest->stand_still(before.motion.state.v, {});
  still.v = before.rest->swing().p;
  balance(u, loads);
  balanced.p = after_.rest->swing().p;
  before.rest->stand_still(before.motion.state.u, loads);
  still.p = before.rest->swing().p;
  for (std::size_t part = 0; part < swing.p.size(); ++part) {  // what is besides
    swing.p[part] -= still.p[part];
    swing.v[part] -= still.v[part];
  }
  for (const auto& [vertex, number] : joining_) {
    Eigen::Map<Vec3>(u.data() + number) += before.rest->shape_at(vertex, swing.p);
    Eigen::Map<Vec3>(v.data() + number) += before.rest->shape_at(vertex, swing.v);
  }
  for (std::size_t part = 0; part < overlaps_.size(); ++part) {
    const auto& [was, overlap] = overlaps_[part];
    balanced.p[part] += overlap * swing.p[was];
    balanced.v[part] += overlap * swing.v[was];
  }
  after_.rest->set_swing(balanced);
  after_.motion.state.u = std::move(u);
  after_.motion.state.v = std::move(v);
}

}  // namespace palpate::sim
