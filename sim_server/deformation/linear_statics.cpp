#include "sim_server/deformation/linear_statics.h"

#include "common/error.h"
#include "sim_server/mesh/loose_parts.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kColumnsAtOnce =
    48;  // right-hand sides per solve: fills the BLAS, keeps progress alive

Solid solid_of(const ModelInputs& inputs) {
  require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kStiffness), 0);
  return {inputs.mesh, *inputs.scene.material};
}

SparseCholesky factor_stiffness(const ModelInputs& inputs, const Solid& solid, const FreeDofs& dofs) {
  StiffnessMatrix stiffness = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), stiffness);
  inputs.progress(name_of(Stage::kFactor), 0);
  return {stiffness.lower(), inputs.scene.source};
}

}  // namespace

void require_no_loose_part(const ModelInputs& inputs) {
  const std::vector<LoosePart> loose = loose_parts(inputs.mesh, inputs.fixed);
  if (!loose.empty())
    fail("{}: {}; a [[fixed]] that holds three of their vertices, not in one line, would hold them",
         inputs.scene.source, to_text(loose.front()));
}

LinearStatics::LinearStatics(const ModelInputs& inputs)
    : solid(solid_of(inputs)),
      dofs(solid.nodes(), inputs.fixed),
      factor(factor_stiffness(inputs, solid, dofs)) {}

std::optional<MovingSupports> LinearStatics::supports(const ModelInputs& inputs, Following following) const {
  const auto flexibility = [this](const Eigen::MatrixXd& forces) { return factor.solve(forces); };
  const auto responses = support_responses(inputs, solid, dofs, flexibility, following);
  if (responses.empty()) return {};
  return MovingSupports(inputs, responses);
}

void LinearStatics::fill(SurfaceCompliance& compliance, const ModelInputs& inputs) const {
  const auto dof = [&](Eigen::Index row) {
    return dofs.first[inputs.surface.vertices[compliance.vertices()[row / 3]]] + row % 3;
  };
  const auto respond = [&](Eigen::Index from, Eigen::Ref<Eigen::MatrixXd> columns) {
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(dofs.count, columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c) load(dof(from + c), c) = 1;
    const Eigen::MatrixXd moved = factor.solve(load);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      for (Eigen::Index r = 0; r < columns.rows(); ++r) columns(r, c) = moved(dof(r), c);
    }
  };
  compliance.compute(kColumnsAtOnce, respond, inputs.progress);
}

}  // namespace palpate::sim
