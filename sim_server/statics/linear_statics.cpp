#include "sim_server/statics/linear_statics.h"

#include <cassert>
#include <cmath>

#include "common/clock.h"
#include "common/error.h"
#include "common/log.h"
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

/// The store in which a set-up finds what was computed before, and keeps what it computes: what was
/// condensed, where there is that, else the cache, else nowhere.
class StoredMatrices {
 public:
  explicit StoredMatrices(const ModelInputs& inputs) : inputs_(inputs) {}

  bool any() const { return inputs_.condensed != nullptr || inputs_.cache != nullptr; }
  bool of_any_build() const { return inputs_.condensed != nullptr; }
  const char* name() const { return of_any_build() ? "what was condensed" : "the set-up cache"; }
  Fingerprint fingerprint() const {
    return Fingerprint(of_any_build() ? Fingerprint::For::kAnyBuild : Fingerprint::For::kThisBuild);
  }
  std::optional<MappedMatrix> find(const Digest& key, const std::string& what) const {
    return of_any_build() ? inputs_.condensed->find(key, what, inputs_.scene.source)
                          : inputs_.cache->find(key);
  }
  void keep(const Digest& key, Time begin, const Eigen::Ref<const Eigen::MatrixXd>& matrix) const {
    const double seconds = to_seconds(now() - begin);
    if (of_any_build()) return inputs_.condensed->keep(key, seconds, matrix);
    inputs_.cache->keep(key, seconds, matrix);
  }

 private:
  const ModelInputs& inputs_;
};

/// Returns the digits of a sum that are the same in every build.
std::string in_any_build(double sum) {
  return fmt::format("{:.7e}", sum);
}

/// Adds K and, for modes, the masses: to the last bit, or to what every build agrees on, which is the pattern
/// of K, and sum_ij |K_ij| v_i v_j and sum_ij K_ij w_i w_j for two vectors v, w = v - 1 without an order. The
/// second tells a body from its mirror image, and one that was turned.
void add(const SparseMatrix& k, Fingerprint& fingerprint, bool of_any_build) {
  fingerprint.add(values(k.outerIndexPtr(), k.outerSize() + 1));
  fingerprint.add(values(k.innerIndexPtr(), k.nonZeros()));
  if (!of_any_build) return fingerprint.add(values(k.valuePtr(), k.nonZeros()));
  for (const std::uint64_t seed : {0x9e3779b97f4a7c15U, 0xbf58476d1ce4e5b9U}) {
    const auto at = [seed](Eigen::Index i) {  // a multiplicative hash: within [0.5, 1.5)
      return 0.5 + 0x1p-32 * static_cast<double>((static_cast<std::uint64_t>(i) + 1) * seed >> 32U);
    };
    double sizes = 0, signs = 0;
    for (Eigen::Index column = 0; column < k.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(k, column); entry; ++entry) {
        sizes += std::abs(entry.value()) * at(entry.row()) * at(column);
        signs += entry.value() * (at(entry.row()) - 1) * (at(column) - 1);
      }
    }
    fingerprint.add(std::span<const char>(in_any_build(sizes) + in_any_build(signs)));
  }
}

/// Returns the key of all that rows and columns of K^-1 follow from, and how they are stored.
Digest key_of_compliance(const SparseMatrix& k, std::span<const int> rows,
                         const SurfaceCompliance& compliance, const StoredMatrices& stored) {
  constexpr int kLayout = 1;  // of tiles in a file
  Fingerprint fingerprint = stored.fingerprint();
  add(k, fingerprint, stored.of_any_build());
  fingerprint.add(rows);
  if (const double tolerance = compliance.tolerance(); tolerance > 0) {
    fingerprint.add(std::span<const double>(&tolerance, 1));
    fingerprint.add(std::span<const int>(compliance.tile_begins()));
    fingerprint.add(std::span<const int>(&kLayout, 1));
  }
  return fingerprint.digest();
}

/// Returns the key of all that modes of vibration follow from.
Digest key_of_modes(const SparseMatrix& k, const Eigen::VectorXd& masses, int count,
                    const StoredMatrices& stored) {
  Fingerprint fingerprint = stored.fingerprint();
  add(k, fingerprint, stored.of_any_build());
  if (stored.of_any_build()) {
    fingerprint.add(std::span<const char>(in_any_build(masses.sum()) + in_any_build(masses.squaredNorm())));
  } else {
    fingerprint.add(values(masses.data(), masses.size()));
  }
  fingerprint.add(std::span<const int>(&count, 1));
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

const FactoredMatrix& LinearStatics::factor(FactorUse use) const {
  if (factor_ && (use == FactorUse::kInverse || factor_use_ == FactorUse::kInverseAndSolve)) return *factor_;
  factor_.reset();
  inputs_.progress(name_of(Stage::kFactor), 0);
  const std::string& where = inputs_.scene.source;
  if (inputs_.condensed == nullptr) {
    factor_ = std::make_unique<SparseCholesky>(stiffness.lower(), where);
    factor_use_ = FactorUse::kInverseAndSolve;
  } else if (inputs_.condensed->make_factor()) {
    factor_ = inputs_.condensed->make_factor()(stiffness.lower(), rows_of(compliant_vertices(inputs_).order),
                                               use, where);
    factor_use_ = use;
  } else {
    fail("--condensed: {} needs a factor of its stiffness besides, as its supports move; leave it out",
         where);
  }
  return *factor_;
}

/// Returns the rows of K of these surface vertices, which are free, three each.
std::vector<int> LinearStatics::rows_of(std::span<const int> vertices) const {
  std::vector<int> rows;
  for (const int vertex : vertices) {
    const int first = dofs.first[inputs_.surface.vertices[vertex]];
    assert(first >= 0);
    rows.insert(rows.end(), {first, first + 1, first + 2});
  }
  return rows;
}

std::optional<MovingSupports> LinearStatics::supports(Following following) const {
  const auto flexibility = [this](const Eigen::MatrixXd& forces) { return factor().solve(forces); };
  const auto responses = support_responses(inputs_, solid, dofs, flexibility, following);
  if (responses.empty()) return {};
  return MovingSupports(inputs_, responses);
}

VibrationModes LinearStatics::modes(int count, const std::string& where,
                                    const Eigen::VectorXd& weights) const {
  const auto find = [&] {
    const FactoredMatrix& of_stiffness = factor();
    inputs_.progress(name_of(Stage::kModes), 0);
    return vibration_modes(of_stiffness, weights, count, where);
  };
  const StoredMatrices stored(inputs_);
  if (!stored.any()) return find();
  const Digest key = key_of_modes(stiffness.lower(), weights, count, stored);
  if (const auto found = stored.find(key, fmt::format("{} modes of vibration", count))) {
    const auto matrix = found->matrix();  // the frequencies above the shapes
    if (matrix.rows() == dofs.count + 1 && matrix.cols() == count)
      return {matrix.row(0).transpose(), matrix.bottomRows(dofs.count), found->note_of_saved(stored.name())};
  }
  const Time begin = now();
  VibrationModes found = find();
  Eigen::MatrixXd matrix(dofs.count + 1, count);
  matrix << found.frequencies.transpose(), found.shapes;
  stored.keep(key, begin, matrix);
  return found;
}

void LinearStatics::fill(SurfaceCompliance& compliance) const {
  const std::vector<int> rows = rows_of(compliance.vertices());
  const StoredMatrices stored(inputs_);
  if (!stored.any()) return compliance.compute(factor(FactorUse::kInverse), rows, inputs_.progress);
  const Digest key = key_of_compliance(stiffness.lower(), rows, compliance, stored);
  const std::string what = fmt::format("compliance of {} nodes", compliance.vertices().size());
  if (auto found = stored.find(key, what); found && compliance.take(std::move(*found), stored.name())) return;
  const Time begin = now();
  compliance.compute(factor(FactorUse::kInverse), rows, inputs_.progress);
  try {
    compliance.pass_to([&](const auto& matrix) { stored.keep(key, begin, matrix); });
    compliance.was_stored_in(stored.name());
  } catch (const Error& error) {
    if (stored.of_any_build()) throw;
    log::warning("set-up cache: nothing kept: {}", error.what());
  }
}

}  // namespace palpate::sim
