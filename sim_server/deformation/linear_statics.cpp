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

void add(const SparseMatrix& k, Fingerprint& fingerprint) {
  fingerprint.add(values(k.outerIndexPtr(), k.outerSize() + 1));
  fingerprint.add(values(k.innerIndexPtr(), k.nonZeros()));
  fingerprint.add(values(k.valuePtr(), k.nonZeros()));
}

/// Of all that rows and columns of K^-1 follow from.
Digest key_of_compliance(const SparseMatrix& k, std::span<const int> rows) {
  Fingerprint fingerprint;
  add(k, fingerprint);
  fingerprint.add(rows);
  return fingerprint.digest();
}

#ifdef PALPATE_WITH_SPECTRA
/// Of all that modes of vibration follow from.
Digest key_of_modes(const SparseMatrix& k, const Eigen::VectorXd& masses, int count) {
  Fingerprint fingerprint;
  add(k, fingerprint);
  fingerprint.add(values(masses.data(), masses.size()));
  fingerprint.add(std::span<const int>(&count, 1));
  return fingerprint.digest();
}
#endif

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

VibrationModes LinearStatics::modes(int count, const std::string& where) const {
#ifndef PALPATE_WITH_SPECTRA
  fail(
      "{}: this build finds none of the {} modes of vibration asked for; configure it with "
      "-DPALPATE_SPECTRA=ON",
      where, count);
#else
  const Eigen::VectorXd weights = masses();
  const auto find = [&] {
    const SparseCholesky& of_stiffness = factor();
    inputs_.progress(name_of(Stage::kModes), 0);
    return vibration_modes(of_stiffness, weights, count, where);
  };
  if (inputs_.cache == nullptr) return find();
  const Digest key = key_of_modes(stiffness.lower(), weights, count);
  if (const auto kept = inputs_.cache->find(key)) {
    const auto matrix = kept->matrix();  // the frequencies above the shapes
    if (matrix.rows() == dofs.count + 1 && matrix.cols() == count)
      return {matrix.row(0).transpose(), matrix.bottomRows(dofs.count), note_of_saved(*kept)};
  }
  const Time begin = now();
  VibrationModes found = find();
  Eigen::MatrixXd matrix(dofs.count + 1, count);
  matrix << found.frequencies.transpose(), found.shapes;
  const std::string what = fmt::format("{} modes, {}", count, inputs_.scene.mesh_file.filename().string());
  inputs_.cache->keep({.key = key, .seconds = to_seconds(now() - begin), .what = what}, matrix);
  return found;
#endif
}

void LinearStatics::fill(SurfaceCompliance& compliance) const {
  std::vector<int> rows;  // of K, for each of the compliance
  for (const int vertex : compliance.vertices()) {
    const int first = dofs.first[inputs_.surface.vertices[vertex]];
    rows.insert(rows.end(), {first, first + 1, first + 2});
  }
  if (inputs_.cache == nullptr) return compute(compliance, rows);
  const Digest key = key_of_compliance(stiffness.lower(), rows);
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
