#include "sim_server/deformation/surface_compliance.h"

#include <algorithm>

#include "common/error.h"
#include "common/parallel.h"

namespace palpate::sim {
namespace {

constexpr double kMostComplianceBytes = 4e9;  // of compliance, however many are free
constexpr std::size_t kMostCalls = 16;        // between two reports of progress: enough to keep cores busy
constexpr std::size_t kTile = 64;             // rows and columns that stay in the cache

/// Equal by theory to its transpose; makes it so to the last bit, for contact and for Cholesky.
void symmetrise(Eigen::Ref<Eigen::MatrixXd> m) {
  const auto n = static_cast<std::size_t>(m.rows());
  parallel_blocks(n, kTile, [&](std::size_t begin, std::size_t end) {
    const auto row = static_cast<Eigen::Index>(begin), rows = static_cast<Eigen::Index>(end - begin);
    for (Eigen::Index column = 0; column <= row; column += kTile) {
      const Eigen::Index columns = std::min<Eigen::Index>(kTile, m.cols() - column);
      auto below = m.block(row, column, rows, columns), above = m.block(column, row, columns, rows);
      const Eigen::MatrixXd mean = 0.5 * (below + above.transpose());
      below = mean;
      above = mean.transpose();
    }
  });
}

}  // namespace

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

SurfaceCompliance::SurfaceCompliance(const ModelInputs& inputs)
    : source_(inputs.scene.source),
      row_(inputs.surface.vertices.size(), -1),
      held_compliance_(1 / held_stiffness(inputs.scene)) {
  require_held_tissue(inputs);
  for (const int vertex : inputs.reachable) {
    if (std::binary_search(inputs.fixed.begin(), inputs.fixed.end(), inputs.surface.vertices[vertex]))
      continue;
    row_[vertex] = static_cast<int>(3 * vertices_.size());
    vertices_.push_back(vertex);
  }
  moved_.resize(static_cast<Eigen::Index>(3 * vertices_.size()));
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
  if (bytes > kMostComplianceBytes)
    fail("{}: {} would take {}, and a scene is given no more than {} for it; {}", source_, what,
         bytes_text(bytes), bytes_text(kMostComplianceBytes), remedy);
  require_memory(bytes, free, source_, what, remedy);
}

void SurfaceCompliance::compute(const std::function<void(Eigen::Ref<Eigen::MatrixXd>)>& make) {
  allocate();
  make(compliance_);
}

void SurfaceCompliance::allocate() {
  const auto rows = static_cast<Eigen::Index>(3 * vertices_.size());
  require_room(free_memory());
  computed_.resize(rows, rows);
  new (&compliance_) Eigen::Map<Eigen::MatrixXd>(computed_.data(), rows, rows);
}

bool SurfaceCompliance::take(MappedMatrix&& kept, std::string_view source) {
  const auto rows = static_cast<Eigen::Index>(3 * vertices_.size());
  const auto matrix = kept.matrix();
  if (matrix.rows() != rows || matrix.cols() != rows) return false;
  new (&compliance_) Eigen::Map<Eigen::MatrixXd>(const_cast<double*>(matrix.data()), rows, rows);
  kept_ = std::move(kept);
  note_ = note_of_saved(*kept_, source);
  return true;
}

std::string SurfaceCompliance::detail() const {
  return fmt::format("{} nodes{}{}", vertices_.size(), note_.empty() ? "" : ", ", note_);
}

void SurfaceCompliance::compute(std::size_t at_once, const Respond& respond, const Progress& progress,
                                std::size_t calls_per_report) {
  const std::size_t rows = 3 * vertices_.size(),
                    report = std::clamp<std::size_t>(calls_per_report, 1, kMostCalls) * at_once;
  allocate();
  for (std::size_t from = 0; from < rows; from += report) {
    progress(name_of(Stage::kCompliance), static_cast<double>(from) / static_cast<double>(rows));
    parallel_blocks(std::min(report, rows - from), at_once, [&](std::size_t begin, std::size_t end) {
      const auto first = static_cast<Eigen::Index>(from + begin);
      respond(first, compliance_.middleCols(first, static_cast<Eigen::Index>(end - begin)));
    });
  }
  symmetrise(compliance_);
}

void SurfaceCompliance::add(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weights) {
  Eigen::MatrixXd here(compliance_.rows(), shapes.cols());
  for (std::size_t k = 0; k < vertices_.size(); ++k)
    here.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = shapes.middleRows<3>(3 * vertices_[k]);
  const Eigen::MatrixXd weighted = weights.asDiagonal() * here.transpose();
  parallel_blocks(static_cast<std::size_t>(here.rows()), kTile, [&](std::size_t begin, std::size_t end) {
    const auto from = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
    compliance_.middleCols(from, count).noalias() += here * weighted.middleCols(from, count);
  });
  symmetrise(compliance_);
}

/// How one vertex moves per force on another, m/N.
Mat3 SurfaceCompliance::block(int vertex, int other) const noexcept {
  const int row = row_[vertex], column = row_[other];
  if (row >= 0 && column >= 0) return compliance_.block<3, 3>(row, column);
  return (vertex == other ? held_compliance_ : 0.0) * Mat3::Identity();
}

void SurfaceCompliance::fill(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  const auto m = static_cast<Eigen::Index>(vertices.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i < m; ++i)
      patch.compliance.block<3, 3>(3 * i, 3 * j) = block(vertices[i], vertices[j]);
  }
}

void SurfaceCompliance::begin(ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  for (int i = 0; i < patch.nodes(); ++i)
    patch.compliance.block<3, 3>(3 * i, 3 * i) = block(patch.vertices[i], patch.vertices[i]);
}

void SurfaceCompliance::fill(int node, ContactPatch& patch) const noexcept {
  const int vertex = patch.vertices[node], column = row_[vertex];
  for (int axis = 0; axis < 3; ++axis) {
    double* const to = patch.compliance.col(3 * node + axis).data();
    const double* const from = column < 0 ? nullptr : compliance_.col(column + axis).data();
    for (int i = 0; i < patch.nodes(); ++i) {
      const int row = row_[patch.vertices[i]];
      Eigen::Map<Vec3> moved(to + 3 * i);
      if (from != nullptr && row >= 0) {
        moved = Eigen::Map<const Vec3>(from + row);
      } else {
        moved = (patch.vertices[i] == vertex ? held_compliance_ : 0.0) * Vec3::Unit(axis);
      }
    }
  }
}

Mat3 SurfaceCompliance::of_loads(std::span<const NodalLoad> loads) const noexcept {
  const Vec3 sum = sum_of(loads);
  Mat3 yields = Mat3::Zero();
  for (const NodalLoad& a : loads) {
    for (const NodalLoad& b : loads)
      yields += share_of(a, sum) * share_of(b, sum) * block(a.vertex, b.vertex);
  }
  return yields;
}

void SurfaceCompliance::move(std::span<const NodalLoad> loads, std::span<Vec3> positions) noexcept {
  moved_.setZero();
  for (const NodalLoad& load : loads) {
    const int column = row_[load.vertex];
    if (column < 0) {
      positions[load.vertex] += held_compliance_ * load.force;
    } else {
      moved_.noalias() += compliance_.middleCols<3>(column) * load.force;
    }
  }
  for (std::size_t k = 0; k < vertices_.size(); ++k)
    positions[vertices_[k]] += moved_.segment<3>(3 * static_cast<Eigen::Index>(k));
}

}  // namespace palpate::sim
