#include "sim_server/simulation/mesh_resolution.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::sim {
namespace {

struct Row {
  double elements_per_radius, percent;
};
// Measured (tests/studies/RESULTS.md), of linear elements.
constexpr std::array kLinear{Row{0.4, 189}, Row{0.63, 147}, Row{1, 104}, Row{1.4, 71},
                             Row{2, 51},    Row{2.9, 38},   Row{4, 29}};
// Measured as well, of quadratic elements.
constexpr std::array kQuadratic{Row{0.4, 53},  Row{0.63, 35}, Row{1, 15},
                                Row{1.4, 7.8}, Row{2, 3.5},   Row{2.9, 2.1}};

double interpolated(std::span<const Row> table, double elements) noexcept {
  const auto above =
      std::ranges::find_if(table, [&](const Row& row) { return row.elements_per_radius > elements; });
  if (above == table.begin()) return table.front().percent;
  if (above == table.end()) return table.back().percent;
  const Row &a = *(above - 1), &b = *above;
  const double fraction =
      std::log(elements / a.elements_per_radius) / std::log(b.elements_per_radius / a.elements_per_radius);
  return a.percent * std::pow(b.percent / a.percent, fraction);
}

}  // namespace

MeshResolution::MeshResolution(const Surface& surface, std::span<const Vec3> rest, double radius)
    : fineness_(rest.size(), 0) {
  std::vector<double> lengths(rest.size(), 0);
  std::vector<int> edges(rest.size(), 0);
  for (const Triangle& t : surface.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      for (const int vertex : {a, b}) {
        lengths[vertex] += (rest[a] - rest[b]).norm();
        ++edges[vertex];
      }
    }
  }
  const double per_edge = std::sqrt(surface.per_face);  // pieces that the edge of an element is cut into
  for (std::size_t k = 0; k < rest.size(); ++k) {
    if (edges[k] > 0 && lengths[k] > 0) fineness_[k] = radius * edges[k] / (per_edge * lengths[k]);
  }
}

MeshResolution::MeshResolution(const Surface& surface, std::span<const Vec3> rest, double radius,
                               const TetMesh& mesh)
    : MeshResolution(surface, rest, radius) {
  set_inside(surface, mesh, radius);
}

void MeshResolution::set_inside(const Surface& surface, const TetMesh& mesh, double radius) {
  std::vector<double> lengths(mesh.vertices.size(), 0);
  std::vector<int> edges(mesh.vertices.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const auto& [a, b] : kEdges) {
      const double length = (mesh.vertices[t[a]] - mesh.vertices[t[b]]).norm();
      for (const int vertex : {t[a], t[b]}) {
        lengths[vertex] += length;
        ++edges[vertex];
      }
    }
  }
  for (std::size_t k = 0; k < fineness_.size(); ++k) {
    const int node = surface.vertices[k];
    if (fineness_[k] == 0 && lengths[node] > 0) fineness_[k] = radius * edges[node] / lengths[node];
  }
}

MeshResolution::Sums MeshResolution::sums_of(std::span<const VertexLoad> loads) const noexcept {
  Sums sums;
  for (const VertexLoad& load : loads) {
    const double weight = load.force.norm();
    if (!std::isfinite(weight) || fineness_[load.vertex] == 0) continue;  // that of a copy is not known
    sums.elements += weight * fineness_[load.vertex];
    sums.weight += weight;
  }
  return sums;
}

std::optional<double> MeshResolution::of(std::span<const VertexLoad> loads) const noexcept {
  const Sums sums = sums_of(loads);
  if (sums.weight == 0) return {};
  return sums.elements / sums.weight;
}

std::optional<double> MeshResolution::finest(std::span<const Triangle> touchable) const {
  std::optional<double> most;
  for (const Triangle& t : touchable) {
    for (const int vertex : t) most = std::max(most.value_or(0), fineness_[vertex]);
  }
  return most;
}

void MeshResolution::add(std::span<const VertexLoad> loads) noexcept {
  const Sums sums = sums_of(loads);
  all_.elements += sums.elements;
  all_.weight += sums.weight;
}

std::optional<double> MeshResolution::elements_per_radius() const noexcept {
  if (all_.weight == 0) return {};
  return all_.elements / all_.weight;
}

std::optional<double> estimated_mesh_error(ElementKind element, double elements_per_radius) noexcept {
  switch (element) {
    case ElementKind::kLinear:
      return interpolated(kLinear, elements_per_radius);
    case ElementKind::kQuadratic:
      return interpolated(kQuadratic, elements_per_radius);
    case ElementKind::kNodalPressure:
      break;
  }
  return {};
}

}  // namespace palpate::sim
