#include "sim_server/deformation/linear_statics.h"

#include "common/clock.h"
#include "common/error.h"
#include "sim_server/mesh/loose_parts.h"

namespace palpate::sim {
namespace {

Solid solid_of(const ModelInputs& inputs) {
  require_no_loose_part(inputs);
  inputs.progress(name_of(Stage::kStiffness), 0);
  return {inputs.mesh, *inputs.scene.material};
}

StiffnessMatrix stiffness_of(const Solid& solid, const FreeDofs& dofs) {
  StiffnessMatrix stiffness = solid.stiffness_matrix(dofs);
  solid.add_stiffness(solid.rest(), stiffness);
  return stiffness;
}

template <class T>
std::span<const T> values(const T* first, Eigen::Index count) {
  return {first, static_cast<std::size_t>(count)};
}

/// Of all that rows and columns of K^-1 follow from.
Digest key_of(const SparseMatrix& k, std::span<const int> rows) {
  Fingerprint fingerprint;
  fingerprint.add(values(k.outerIndexPtr(), k.outerSize() + 1));
  fingerprint.add(values(k.innerIndexPtr(), k.nonZeros()));
  fingerprint.add(values(k.valuePtr(), k.nonZeros()));
  fingerprint.add(rows);
  return fingerprint.digest();
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
      stiffness(stiffness_of(solid, dofs)),
      inputs_(inputs) {}

const SparseCholesky& LinearStatics::factor() const {
  if (factor_) return *factor_;
  inputs_.progress(name_of(Stage::kFactor), 0);
  return factor_.emplace(stiffness.lower(), inputs_.scene.source);
}

std::optional<MovingSupports> LinearStatics::supports(Following following) const {
  const auto flexibility = [this](const Eigen::MatrixXd& forces) { return factor().solve(forces); };
  const auto responses = support_responses(inputs_, solid, dofs, flexibility, following);
  if (responses.empty()) return {};
  return MovingSupports(inputs_, responses);
}

void LinearStatics::fill(SurfaceCompliance& compliance) const {
  std::vector<int> rows;  // of K, for each of the compliance
  for (const int vertex : compliance.vertices()) {
    const int first = dofs.first[inputs_.surface.vertices[vertex]];
    rows.insert(rows.end(), {first, first + 1, first + 2});
  }
  if (inputs_.cache == nullptr) return compute(compliance, rows);
  const Digest key = key_of(stiffness.lower(), rows);
  if (auto kept = inputs_.cache->find(key); kept && compliance.take(std::move(*kept))) return;
  const Time begin = now();
  compute(compliance, rows);
  const std::string what = fmt::format("compliance of {} nodes, {}", compliance.vertices().size(),
                                       inputs_.scene.mesh_file.filename().string());
  inputs_.cache->keep({.key = key, .seconds = to_seconds(now() - begin), .what = what}, compliance.matrix());
  compliance.was_kept();
}

void LinearStatics::compute(SurfaceCompliance& compliance, std::span<const int> rows) const {
  const SparseCholesky& of_stiffness = factor();
  compliance.compute([&](Eigen::Ref<Eigen::MatrixXd> w) {
    of_stiffness.inverse_block(rows, w,
                               [&](double share) { inputs_.progress(name_of(Stage::kCompliance), share); });
  });
}

}  // namespace palpate::sim
