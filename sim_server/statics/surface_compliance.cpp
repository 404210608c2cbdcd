#include "sim_server/statics/surface_compliance.h"

#include <algorithm>
#include <numeric>

#include "common/error.h"
#include "common/parallel.h"

namespace palpate::sim {
namespace {

constexpr double kMostComplianceBytes = 4e9;  // of compliance, however many are free
constexpr std::size_t kMostCalls = 16;        // between two reports of progress: enough to keep cores busy
constexpr std::size_t kCache = 64;            // rows and columns that stay in the cache
constexpr int kTile = 128;                    // nodes: fewer numbers in all than with 64 or 256, up to
constexpr std::size_t kMany = 8000;           // nodes in all; from there on twice as many in a tile

/// Equal by theory to its transpose; makes it so to the last bit, for contact and for Cholesky.
void symmetrise(Eigen::Ref<Eigen::MatrixXd> m) {
  const auto n = static_cast<std::size_t>(m.rows());
  parallel_blocks(n, kCache, [&](std::size_t begin, std::size_t end) {
    const auto row = static_cast<Eigen::Index>(begin), rows = static_cast<Eigen::Index>(end - begin);
    for (Eigen::Index column = 0; column <= row; column += kCache) {
      const Eigen::Index columns = std::min<Eigen::Index>(kCache, m.cols() - column);
      auto below = m.block(row, column, rows, columns), above = m.block(column, row, columns, rows);
      const Eigen::MatrixXd mean = 0.5 * (below + above.transpose());
      below = mean;
      above = mean.transpose();
    }
  });
}

/// Returns the vertices that can be reached and are free.
std::vector<int> free_vertices(const ModelInputs& inputs) {
  std::vector<int> free;
  for (const int vertex : inputs.reachable) {
    if (!std::ranges::binary_search(inputs.fixed, inputs.surface.vertices[vertex])) free.push_back(vertex);
  }
  return free;
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

PointTiles compliant_vertices(const ModelInputs& inputs) {
  std::vector<int> free = free_vertices(inputs);
  const auto& settings = inputs.scene.deformation.of<ComplianceTolerance>();
  if (settings.of(free.size()) == 0) {
    const auto count = static_cast<int>(free.size());
    return {std::move(free), {0, count}};
  }
  std::vector<Vec3> points;
  for (const int vertex : free) points.push_back(inputs.mesh.vertices[inputs.surface.vertices[vertex]]);
  PointTiles tiles = tiles_of(points, points.size() < kMany ? kTile : 2 * kTile);
  for (int& point : tiles.order) point = free[point];
  return tiles;
}

SurfaceCompliance::SurfaceCompliance(const ModelInputs& inputs)
    : source_(inputs.scene.source), held_compliance_(1 / held_stiffness(inputs.scene)) {
  require_held_tissue(inputs);
  rows_ = compliant_vertices(inputs);
  row_.assign(inputs.surface.vertices.size(), -1);
  for (std::size_t k = 0; k < vertices().size(); ++k) row_[vertices()[k]] = static_cast<int>(3 * k);
  if (vertices().empty()) {
    fail("{}: every vertex the tool can reach is fixed; make the [[fixed]] regions smaller",
         inputs.scene.source);
  }
  const auto& settings = inputs.scene.deformation.of<ComplianceTolerance>();
  tolerance_ = settings.of(vertices().size());
  expected_bytes_ = settings.bytes(vertices().size());
  if (tolerance_ > 0) tiles_.emplace(rows_.begins, tolerance_);
  moved_.resize(size());
  loads_.reserve(tolerance_ > 0 ? kMaxTools * vertices().size() : 0);
  require_room(expected_bytes_, inputs.free_bytes);
}

void SurfaceCompliance::require_room(double bytes, double free) const {
  const std::string what = fmt::format("the compliance of {} reachable surface nodes", vertices().size());
  std::string remedy = "give [[tool]] a `reach` box around the part it touches";
  if (tolerance_ == 0) remedy += ", or [deformation] a `compliance_tolerance` of 1e-4";
  if (bytes > kMostComplianceBytes)
    fail("{}: {} would take {}, and a scene is given no more than {} for it; {}", source_, what,
         bytes_text(bytes), bytes_text(kMostComplianceBytes), remedy);
  require_memory(bytes, free, source_, what, remedy);
}

void SurfaceCompliance::allocate() {
  require_room(expected_bytes_, free_memory());
  computed_.resize(size(), size());
  new (&compliance_) Eigen::Map<Eigen::MatrixXd>(computed_.data(), size(), size());
}

bool SurfaceCompliance::take(MappedMatrix&& stored, std::string_view source) {
  const auto matrix = stored.matrix();
  if (tiles_) {
    if (!tiles_->unpack(matrix)) return false;
    note_ = stored.note_of_saved(source);
    return true;
  }
  if (matrix.rows() != size() || matrix.cols() != size()) return false;
  new (&compliance_) Eigen::Map<Eigen::MatrixXd>(const_cast<double*>(matrix.data()), size(), size());
  stored_ = std::move(stored);
  note_ = stored_->note_of_saved(source);
  return true;
}

void SurfaceCompliance::pass_to(
    const std::function<void(const Eigen::Ref<const Eigen::MatrixXd>&)>& keep) const {
  if (!tiles_) return keep(compliance_);
  require_memory(static_cast<double>(tiles_->bytes()), free_memory(), source_,
                 fmt::format("a copy of the compliance of {} nodes, to be kept,", vertices().size()),
                 "without it, every start computes it anew");
  keep(tiles_->packed());
}

std::string SurfaceCompliance::detail() const {
  std::string text = fmt::format("{} nodes", vertices().size());
  if (tiles_)
    text += fmt::format(" in {} tiles of rank {} at most, to {:g}, where a dense matrix takes {}",
                        tiles_->tiles(), tiles_->largest_rank(), tolerance_,
                        bytes_text(ComplianceTolerance{0}.bytes(vertices().size())));
  return text + (note_.empty() ? "" : ", " + note_);
}

std::size_t SurfaceCompliance::bytes() const {
  return tiles_ ? tiles_->bytes() : static_cast<std::size_t>(compliance_.size()) * sizeof(double);
}

void SurfaceCompliance::compute(const FactoredMatrix& inverse_of, std::span<const int> unknowns,
                                const Progress& progress) {
  const double free = free_memory();
  const auto report_step = [&](double fraction) {
    if (tiles_) require_room(static_cast<double>(tiles_->bytes()), free);
    progress(name_of(Stage::kCompliance), fraction);
  };
  if (!tiles_) {
    allocate();
    return inverse_of.inverse_block(unknowns, compliance_, report_step);
  }
  std::vector<int> begins;
  for (const int node : rows_.begins) begins.push_back(3 * node);
  const auto take = [this](int tile, std::span<const int> with, const Eigen::MatrixXd& rows) {
    tiles_->take(tile, with, rows);
  };
  inverse_of.inverse_rows(unknowns, begins, take, report_step);
}

void SurfaceCompliance::compute(std::size_t at_once, const Respond& respond, const Progress& progress,
                                std::size_t calls_per_report) {
  const auto rows = static_cast<std::size_t>(size());
  const std::size_t report = std::clamp<std::size_t>(calls_per_report, 1, kMostCalls) * at_once;
  if (tiles_) return compute_tiles(at_once, report, respond, progress);
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

void SurfaceCompliance::compute_tiles(std::size_t at_once, std::size_t report, const Respond& respond,
                                      const Progress& progress) {
  const double free = free_memory();
  std::vector<int> all(static_cast<std::size_t>(tiles_->tiles()));
  std::iota(all.begin(), all.end(), 0);
  for (const int tile : all) {
    require_room(static_cast<double>(tiles_->bytes()), free);
    const Eigen::Index begin = 3 * rows_.begins[tile];
    const auto width = static_cast<std::size_t>(3 * rows_.begins[tile + 1] - begin);
    Eigen::MatrixXd columns(size(), static_cast<Eigen::Index>(width));
    for (std::size_t from = 0; from < width; from += report) {
      progress(name_of(Stage::kCompliance),
               static_cast<double>(begin + static_cast<Eigen::Index>(from)) / static_cast<double>(size()));
      parallel_blocks(std::min(report, width - from), at_once, [&](std::size_t first, std::size_t end) {
        const auto at = static_cast<Eigen::Index>(from + first);
        respond(begin + at, columns.middleCols(at, static_cast<Eigen::Index>(end - first)));
      });
    }
    columns.transposeInPlace();
    tiles_->take(tile, std::span<const int>(all).subspan(static_cast<std::size_t>(tile)), columns);
  }
}

void SurfaceCompliance::add(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& weights) {
  Eigen::MatrixXd own(size(), shapes.cols());
  for (std::size_t k = 0; k < vertices().size(); ++k)
    own.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = shapes.middleRows<3>(3 * vertices()[k]);
  if (tiles_) return tiles_->add(own, weights);
  const Eigen::MatrixXd weighted = weights.asDiagonal() * own.transpose();
  parallel_blocks(static_cast<std::size_t>(own.rows()), kCache, [&](std::size_t begin, std::size_t end) {
    const auto from = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
    compliance_.middleCols(from, count).noalias() += own * weighted.middleCols(from, count);
  });
  symmetrise(compliance_);
}

/// Returns how one vertex moves per force on another, m/N.
Mat3 SurfaceCompliance::block(int vertex, int other) const noexcept {
  const int row = row_[vertex], column = row_[other];
  if (row < 0 || column < 0) return (vertex == other ? held_compliance_ : 0.0) * Mat3::Identity();
  return tiles_ ? tiles_->block(row / 3, column / 3) : compliance_.block<3, 3>(row, column);
}

void SurfaceCompliance::fill(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  const auto m = static_cast<Eigen::Index>(vertices.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = j; i < m; ++i) {
      const Mat3 moved = block(vertices[i], vertices[j]);
      patch.compliance.block<3, 3>(3 * i, 3 * j) = moved;
      patch.compliance.block<3, 3>(3 * j, 3 * i) = moved.transpose();
    }
  }
}

void SurfaceCompliance::begin(ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  for (int i = 0; i < patch.nodes(); ++i)
    patch.compliance.block<3, 3>(3 * i, 3 * i) = block(patch.vertices[i], patch.vertices[i]);
}

void SurfaceCompliance::fill(int node, ContactPatch& patch) const noexcept {
  for (int i = 0; i < patch.nodes(); ++i)
    patch.compliance.block<3, 3>(3 * i, 3 * node) = block(patch.vertices[i], patch.vertices[node]);
}

Mat3 SurfaceCompliance::of_loads(std::span<const VertexLoad> loads) const noexcept {
  const Vec3 sum = sum_of(loads);
  Mat3 yields = Mat3::Zero();
  for (const VertexLoad& a : loads) {
    for (const VertexLoad& b : loads)
      yields += fraction_of(a, sum) * fraction_of(b, sum) * block(a.vertex, b.vertex);
  }
  return yields;
}

void SurfaceCompliance::move(std::span<const VertexLoad> loads, std::span<Vec3> positions) noexcept {
  moved_.setZero();
  loads_.clear();
  for (const VertexLoad& load : loads) {
    const int column = row_[load.vertex];
    if (column < 0) {
      positions[load.vertex] += held_compliance_ * load.force;
    } else if (!tiles_) {
      moved_.noalias() += compliance_.middleCols<3>(column) * load.force;
    } else {
      loads_.push_back({column / 3, load.force});
    }
  }
  if (tiles_) tiles_->add_product(loads_, moved_);
  for (std::size_t k = 0; k < vertices().size(); ++k)
    positions[vertices()[k]] += moved_.segment<3>(3 * static_cast<Eigen::Index>(k));
}

}  // namespace palpate::sim
