#include "sim_server/deformation/quasi_static.h"

#include <algorithm>

#include "common/error.h"
#include "sim_server/elasticity/sparse_cholesky.h"

namespace palpate::sim {
namespace {
constexpr double kMostBytes = 4e9;  // of compliance
constexpr Eigen::Index kColumnsAtOnce =
    48;  // right-hand sides per solve: fills the BLAS, keeps progress alive

SparseCholesky factor_stiffness(const ModelInputs& inputs, const FreeDofs& dofs) {
  inputs.progress("assembling the stiffness matrix", 0);
  const SparseMatrix stiffness = assemble_stiffness(inputs.mesh, *inputs.scene.material, dofs);
  inputs.progress("factoring the stiffness matrix", 0);
  return {stiffness, inputs.scene.source};
}
}  // namespace

QuasiStatic::QuasiStatic(const ModelInputs& inputs) : row_(inputs.surface.vertices.size(), -1) {
  const Scene& scene = inputs.scene;
  if (!scene.material) fail("{}: model \"quasi_static\" needs a [material] section", scene.source);
  if (inputs.fixed.empty()) {
    fail(
        "{}: no fixed nodes, so nothing holds the body; add [[fixed]] with a box or a surface tag that "
        "contains some",
        scene.source);
  }
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  positions_ = rest_;
  precompute(inputs);
}

void QuasiStatic::precompute(const ModelInputs& inputs) {
  const FreeDofs dofs(static_cast<int>(inputs.mesh.vertices.size()), inputs.fixed);
  std::vector<int> dof_of_row;
  for (const int vertex : inputs.reachable) {
    const int first = dofs.first[inputs.surface.vertices[vertex]];
    if (first < 0) continue;
    row_[vertex] = static_cast<int>(dof_of_row.size());
    reachable_.push_back(vertex);
    for (int axis = 0; axis < 3; ++axis) dof_of_row.push_back(first + axis);
  }
  if (reachable_.empty()) {
    fail("{}: every vertex the tool can reach is fixed; make the [[fixed]] regions smaller",
         inputs.scene.source);
  }
  const double bytes = static_cast<double>(dof_of_row.size() * dof_of_row.size() * sizeof(double));
  if (bytes > kMostBytes) {
    fail(
        "{}: the compliance of {} reachable surface nodes would take {:.1f} GB; give [[tool]] a `reach` box "
        "around "
        "the part it touches",
        inputs.scene.source, reachable_.size(), bytes / 1e9);
  }
  const SparseCholesky factor = factor_stiffness(inputs, dofs);
  const auto rows = static_cast<Eigen::Index>(dof_of_row.size());
  compliance_.resize(rows, rows);
  for (Eigen::Index from = 0; from < rows; from += kColumnsAtOnce) {
    inputs.progress("computing compliance", static_cast<double>(from) / static_cast<double>(rows));
    const Eigen::Index count = std::min(kColumnsAtOnce, rows - from);
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(dofs.count, count);
    for (Eigen::Index c = 0; c < count; ++c) load(dof_of_row[from + c], c) = 1;
    const Eigen::MatrixXd moved = factor.solve(load);
    for (Eigen::Index c = 0; c < count; ++c) {
      for (Eigen::Index r = 0; r < rows; ++r) compliance_(r, from + c) = moved(dof_of_row[r], c);
    }
  }
  // Equal by theory; make it so to the last bit, for contact and for Cholesky.
  for (Eigen::Index c = 0; c < rows; ++c) {
    for (Eigen::Index r = 0; r < c; ++r) {
      const double mean = 0.5 * (compliance_(r, c) + compliance_(c, r));
      compliance_(r, c) = compliance_(c, r) = mean;
    }
  }
  held_compliance_ = compliance_.diagonal().minCoeff();
  if (MovingSupports supports(inputs, dofs, factor); supports.any()) supports_ = std::move(supports);
  inputs.progress("computing compliance", 1);
}

FreeMotion QuasiStatic::free_motion(double dt) noexcept {
  return supports_ ? supports_->advance(dt) : FreeMotion{rest_};
}

void QuasiStatic::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  const auto m = static_cast<Eigen::Index>(vertices.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i < m; ++i) {
      const int row = row_[vertices[i]], column = row_[vertices[j]];
      auto block = patch.compliance.block<3, 3>(3 * i, 3 * j);
      if (row < 0 || column < 0) {
        block = (i == j ? held_compliance_ : 0.0) * Mat3::Identity();
      } else {
        block = compliance_.block<3, 3>(row, column);
      }
    }
  }
}

std::span<const Vec3> QuasiStatic::apply(std::span<const NodalLoad> loads) noexcept {
  const std::span<const Vec3> free = supports_ ? supports_->positions() : rest_;
  std::copy(free.begin(), free.end(), positions_.begin());
  for (const NodalLoad& load : loads) {
    const int column = row_[load.vertex];
    if (column < 0) {
      positions_[load.vertex] += held_compliance_ * load.force;
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double* moved = compliance_.col(column + axis).data();
      for (std::size_t k = 0; k < reachable_.size(); ++k) {
        positions_[reachable_[k]] += load.force[axis] * Eigen::Map<const Vec3>(moved + 3 * k);
      }
    }
  }
  return positions_;
}

std::vector<MemoryPart> QuasiStatic::memory() const {
  std::vector<MemoryPart> parts{{"compliance", static_cast<std::size_t>(compliance_.size()) * sizeof(double)},
                                {"positions", (rest_.size() + positions_.size()) * sizeof(Vec3) +
                                                  (row_.size() + reachable_.size()) * sizeof(int)}};
  if (supports_) parts.push_back({"moving supports", supports_->bytes()});
  return parts;
}

}  // namespace palpate::sim
