#include "sim_server/deformation/quasi_static.h"

#include <algorithm>

#include "sim_server/elasticity/sparse_cholesky.h"

namespace palpate::sim {
namespace {
constexpr std::size_t kColumnsAtOnce =
    48;  // right-hand sides per solve: fills the BLAS, keeps progress alive

Solid solid_of(const ModelInputs& inputs) {
  inputs.progress("assembling the stiffness matrix", 0);
  return {inputs.mesh, *inputs.scene.material};
}

SparseCholesky factor_stiffness(const ModelInputs& inputs, const Solid& solid, const FreeDofs& dofs) {
  StiffnessMatrix stiffness = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), stiffness);
  inputs.progress("factoring the stiffness matrix", 0);
  return {stiffness.lower(), inputs.scene.source};
}
}  // namespace

QuasiStatic::QuasiStatic(const ModelInputs& inputs) : compliance_(inputs) {
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  positions_ = rest_;
  const Solid solid = solid_of(inputs);
  const FreeDofs dofs(static_cast<int>(inputs.mesh.vertices.size()), inputs.fixed, solid.edges());
  const SparseCholesky factor = factor_stiffness(inputs, solid, dofs);
  const auto dof = [&](Eigen::Index row) {
    return dofs.first[inputs.surface.vertices[compliance_.vertices()[row / 3]]] + row % 3;
  };
  const auto respond = [&](Eigen::Index from, Eigen::Ref<Eigen::MatrixXd> columns) {
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(dofs.count, columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c) load(dof(from + c), c) = 1;
    const Eigen::MatrixXd moved = factor.solve(load);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      for (Eigen::Index r = 0; r < columns.rows(); ++r) columns(r, c) = moved(dof(r), c);
    }
  };
  compliance_.compute(kColumnsAtOnce, respond, inputs.progress);
  if (MovingSupports supports(inputs, solid, dofs, factor); supports.any()) supports_ = std::move(supports);
  inputs.progress("computing compliance", 1);
}

FreeMotion QuasiStatic::free_motion(double dt) noexcept {
  return supports_ ? supports_->advance(dt) : FreeMotion{rest_};
}

void QuasiStatic::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  compliance_.fill(vertices, patch);
}

std::span<const Vec3> QuasiStatic::apply(std::span<const NodalLoad> loads) noexcept {
  const std::span<const Vec3> free = supports_ ? supports_->positions() : rest_;
  std::copy(free.begin(), free.end(), positions_.begin());
  compliance_.move(loads, positions_);
  return positions_;
}

std::vector<MemoryPart> QuasiStatic::memory() const {
  std::vector<MemoryPart> parts{
      {"compliance", compliance_.bytes()},
      {"positions", (rest_.size() + positions_.size()) * sizeof(Vec3) + compliance_.index_bytes()}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  return parts;
}

}  // namespace palpate::sim
