#include "sim_server/contact/joint_grip.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace palpate::sim {
JointGrip::JointGrip(std::span<const ToolContact> tools) {
  int most = 0;
  for (const ToolContact& tool : tools) most += tool.max_held();
  holders_.reserve(tools.size());
  vertices_.reserve(static_cast<std::size_t>(most));
  loads_.reserve(static_cast<std::size_t>(most));
  patch_.reserve(most, 1);
  factor_.reserve(3 * most, 3 * most);
  misfit_.resize(3 * most);
}

void JointGrip::settle(std::span<const ToolContact> tools, Tissue& tissue) {
  gather(tools, tissue);
  if (holders_.size() < 2) return;
  const double fits = Grip::kFits * tools[holders_.front().tool].radius();
  for (int round = 0; round < Grip::kMaxRounds; ++round) {
    put_loads(tissue);
    if (misfit(tools, tissue) <= fits) return;
    if ((round == 0 || !tissue.traits.constant_compliance) && !factor(tissue)) return;
    auto change = misfit_.head(3 * static_cast<Eigen::Index>(vertices_.size()));
    const auto lower = factor_.triangularView<Eigen::Lower>();
    lower.solveInPlace(change);
    lower.adjoint().solveInPlace(change);
    for (std::size_t i = 0; i < loads_.size(); ++i)
      loads_[i].force += change.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
}

/// The vertices of all grips, with the loads that are on them.
void JointGrip::gather(std::span<const ToolContact> tools, const Tissue& tissue) {
  holders_.clear();
  vertices_.clear();
  loads_.clear();
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (!tools[t].placed() || !tools[t].holds()) continue;
    holders_.push_back({t, static_cast<Eigen::Index>(vertices_.size())});
    const std::span<const int> held = tools[t].held_vertices();
    const std::span<const VertexLoad> own = tissue.loads_of(t);
    const bool same = std::ranges::equal(own, held, {}, &VertexLoad::vertex);
    for (std::size_t i = 0; i < held.size(); ++i) {
      vertices_.push_back(held[i]);
      loads_.push_back({held[i], same ? own[i].force : Vec3(Vec3::Zero())});
    }
  }
}

void JointGrip::put_loads(Tissue& tissue) {
  for (std::size_t k = 0; k < holders_.size(); ++k) {
    const auto first = static_cast<std::size_t>(holders_[k].first),
               end =
                   k + 1 < holders_.size() ? static_cast<std::size_t>(holders_[k + 1].first) : loads_.size();
    tissue.replace_loads(holders_[k].tool, std::span(loads_).subspan(first, end - first));
  }
  tissue.apply_all_loads();
}

/// Finds what is missing to the place of each vertex, into `misfit_`; returns the largest component, m.
double JointGrip::misfit(std::span<const ToolContact> tools, const Tissue& tissue) {
  double largest = 0;
  for (const Holder& holder : holders_) {
    const ToolContact& tool = tools[holder.tool];
    const std::span<const VertexLoad> own =
        std::span(loads_).subspan(static_cast<std::size_t>(holder.first), tool.held_vertices().size());
    const Vec3 tip = tool.place() - patch_.tool_compliance * sum_of(own);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Vec3 missing =
          tip + tool.held_offset(i) - tissue.positions[own[i].vertex] - contact_compliance_ * own[i].force;
      misfit_.segment<3>(3 * (holder.first + static_cast<Eigen::Index>(i))) = missing;
      largest = std::max(largest, missing.cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

/// The compliance of all vertices under the loads of now, as its Cholesky factor.
bool JointGrip::factor(const Tissue& tissue) {
  tissue.model->compliance(vertices_, patch_);
  const auto m = static_cast<Eigen::Index>(vertices_.size());
  factor_.shape(3 * m, 3 * m);
  factor_ = patch_.compliance.topLeftCorner(3 * m, 3 * m);
  contact_compliance_ = ContactSolver::contact_compliance(patch_, static_cast<int>(m));
  for (std::size_t k = 0; k < holders_.size(); ++k) {
    const Eigen::Index first = holders_[k].first, end = k + 1 < holders_.size() ? holders_[k + 1].first : m;
    for (Eigen::Index j = first; j < end; ++j) {
      for (Eigen::Index i = first; i < end; ++i)
        factor_.block<3, 3>(3 * i, 3 * j).diagonal().array() += patch_.tool_compliance;
    }
  }
  factor_.diagonal().array() += contact_compliance_;
  Eigen::Ref<Eigen::MatrixXd> in_place(factor_);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
}

}  // namespace palpate::sim
