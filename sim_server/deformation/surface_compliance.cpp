#include "sim_server/deformation/surface_compliance.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::sim {
namespace {

constexpr double kMostBytes = 4e9;  // of compliance, however many are free

void require_held_tissue(const ModelInputs& inputs) {
  const Scene& scene = inputs.scene;
  if (!scene.material)
    fail("{}: model \"{}\" needs a [material] section", scene.source, scene.deformation.model);
  if (inputs.fixed.empty()) {
    fail(
        "{}: no fixed nodes, so nothing holds the body; add [[fixed]] with a box or a surface tag that "
        "contains some",
        scene.source);
  }
}

}  // namespace

SurfaceCompliance::SurfaceCompliance(const ModelInputs& inputs)
    : source_(inputs.scene.source), row_(inputs.surface.vertices.size(), -1) {
  require_held_tissue(inputs);
  for (const int vertex : inputs.reachable) {
    if (std::binary_search(inputs.fixed.begin(), inputs.fixed.end(), inputs.surface.vertices[vertex]))
      continue;
    row_[vertex] = static_cast<int>(3 * vertices_.size());
    vertices_.push_back(vertex);
  }
  if (vertices_.empty()) {
    fail("{}: every vertex the tool can reach is fixed; make the [[fixed]] regions smaller",
         inputs.scene.source);
  }
  require_room(inputs.free_bytes);
}

void SurfaceCompliance::require_room(double free) const {
  const double rows = 3 * static_cast<double>(vertices_.size()), bytes = rows * rows * sizeof(double);
  const std::string what = fmt::format("the compliance of {} reachable surface nodes", vertices_.size());
  const std::string remedy = "give [[tool]] a `reach` box around the part it touches";
  if (bytes > kMostBytes)
    fail("{}: {} would take {}, and {} are the most; {}", source_, what, bytes_text(bytes),
         bytes_text(kMostBytes), remedy);
  require_memory(bytes, free, source_, what, remedy);
}

void SurfaceCompliance::compute(Eigen::Index at_once, const Respond& respond, const Progress& progress) {
  const auto rows = static_cast<Eigen::Index>(3 * vertices_.size());
  require_room(free_memory());
  compliance_.resize(rows, rows);
  for (Eigen::Index from = 0; from < rows; from += at_once) {
    progress("computing compliance", static_cast<double>(from) / static_cast<double>(rows));
    respond(from, compliance_.middleCols(from, std::min(at_once, rows - from)));
  }
  // Equal by theory; make it so to the last bit, for contact and for Cholesky.
  for (Eigen::Index c = 0; c < rows; ++c) {
    for (Eigen::Index r = 0; r < c; ++r) {
      const double mean = 0.5 * (compliance_(r, c) + compliance_(c, r));
      compliance_(r, c) = compliance_(c, r) = mean;
    }
  }
  held_compliance_ = compliance_.diagonal().minCoeff();
}

void SurfaceCompliance::fill(std::span<const int> vertices, ContactPatch& patch) const noexcept {
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

void SurfaceCompliance::move(std::span<const NodalLoad> loads, std::span<Vec3> positions) const noexcept {
  for (const NodalLoad& load : loads) {
    const int column = row_[load.vertex];
    if (column < 0) {
      positions[load.vertex] += held_compliance_ * load.force;
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double* moved = compliance_.col(column + axis).data();
      for (std::size_t k = 0; k < vertices_.size(); ++k) {
        positions[vertices_[k]] += load.force[axis] * Eigen::Map<const Vec3>(moved + 3 * k);
      }
    }
  }
}

}  // namespace palpate::sim
