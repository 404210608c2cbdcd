#include "sim_server/simulation/tool_coupling.h"

#include <Eigen/LU>

namespace palpate::sim {
namespace {

constexpr double kLittle = 1e-3;       // N: what the tissue is asked about on top of its loads
constexpr double kMostFeedback = 0.9;  // norm; from 1 on, the series of what tools do to each other diverges

double weight_of(std::span<const VertexLoad> loads) noexcept {
  double sum = 0;
  for (const VertexLoad& load : loads) sum += load.force.norm();
  return sum;
}

}  // namespace

ToolCoupling::ToolCoupling(std::size_t tools, std::size_t vertices, std::size_t most_loads)
    : surface_(vertices), moved_(vertices), others_(tools), relative_(tools, Mat3::Identity()) {
  loads_.reserve(most_loads);
}

void ToolCoupling::update(Tissue& tissue, std::span<const ToolContact> tools,
                          std::span<const Vec3> velocities) {
  find_compliance(tissue, tools);
  for (std::size_t i = 0; i < tools.size(); ++i) {
    others_[i] = others_of(i, tools, velocities);
    const Mat3 feedback = others_[i].compliance * tools[i].force().tangent;
    if (!(feedback.norm() <= kMostFeedback) || !others_[i].v_W.allFinite() ||
        !others_[i].compliance.allFinite()) {
      others_[i] = {};
      relative_[i].setIdentity();
      continue;
    }
    relative_[i] = (Mat3::Identity() - feedback).inverse();
  }
}

OtherTools ToolCoupling::others_of(std::size_t tool, std::span<const ToolContact> tools,
                                   std::span<const Vec3> velocities) const {
  const auto own = static_cast<Eigen::Index>(3 * tool), n = compliance_.rows();
  const Matrix by_own = compliance_.middleCols<3>(own), to_own = compliance_.middleRows<3>(own);
  Matrix system = Matrix::Identity(n, n), forces(n, 4);  // I - K_o G_oo; K_o G_oi, -K_o v_o
  forces.setZero();
  for (std::size_t k = 0; k < tools.size(); ++k) {
    if (k == tool) continue;
    const auto row = static_cast<Eigen::Index>(3 * k);
    const Mat3& tangent = tools[k].force().tangent;
    for (std::size_t j = 0; j < tools.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(3 * j);
      if (j != tool) system.block<3, 3>(row, column) -= tangent * compliance_.block<3, 3>(row, column);
    }
    forces.block<3, 3>(row, 0) = tangent * by_own.middleRows<3>(row);
    forces.block<3, 1>(row, 3) = -tangent * velocities[k];
  }
  const Matrix moved = to_own * system.partialPivLu().solve(forces);
  const Mat3 compliance = moved.leftCols<3>();
  return {moved.col(3), 0.5 * (compliance + compliance.transpose())};
}

/// The loads of all tools, and a force more on one of them, if it is one.
void ToolCoupling::load(const Tissue& tissue, std::size_t tools, std::size_t pressed, const Vec3& force) {
  loads_.clear();
  for (std::size_t k = 0; k < tools; ++k) {
    const std::span<const VertexLoad> own = tissue.loads_of(k);
    const double all = weight_of(own);
    for (const VertexLoad& load : own) {
      const double fraction = all > 0 ? load.force.norm() / all : 1 / static_cast<double>(own.size());
      loads_.push_back({load.vertex, k == pressed ? Vec3(load.force + fraction * force) : load.force});
    }
  }
}

void ToolCoupling::find_compliance(Tissue& tissue, std::span<const ToolContact> tools) {
  const auto n = static_cast<Eigen::Index>(3 * tools.size());
  compliance_.setZero(n, n);
  load(tissue, tools.size(), tools.size(), Vec3::Zero());
  tissue.positions = tissue.model->apply(loads_);
  surface_.assign(tissue.positions.begin(), tissue.positions.end());
  for (std::size_t k = 0; k < tools.size(); ++k) {
    if (tissue.loads_of(k).empty()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      load(tissue, tools.size(), k, kLittle * Vec3::Unit(axis));
      const std::span<const Vec3> there = tissue.model->apply(loads_);
      for (std::size_t v = 0; v < moved_.size(); ++v) moved_[v] = (there[v] - surface_[v]) / kLittle;
      tissue.positions = there;
      for (std::size_t i = 0; i < tools.size(); ++i) {
        if (i == k || !tools[i].placed()) continue;
        compliance_.block<3, 1>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * k) + axis) =
            tools[i].surface_velocity(tools[i].place(), tissue, moved_, tissue.loads_of(i));
      }
    }
  }
  tissue.apply_loads(0);
}

}  // namespace palpate::sim
