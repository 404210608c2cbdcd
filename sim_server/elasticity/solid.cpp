#include "sim_server/elasticity/solid.h"

#include <algorithm>
#include <numeric>

#include "common/error.h"
#include "sim_server/elasticity/element.h"
#include "sim_server/elasticity/solid_element.h"

namespace palpate::sim {

TetMesh with_nodes(TetMesh mesh, ElementKind element) {
  if (element == ElementKind::kQuadratic) add_mid_edges(mesh);
  return mesh;
}

Solid::Solid(const TetMesh& mesh, const Material& material)
    : material_(material), rest_(mesh.vertices), stiffness_(mesh.stiffness) {
  const bool quadratic = material.element == ElementKind::kQuadratic;
  if (quadratic == mesh.mid_edges.empty() && !mesh.tetrahedra.empty())
    fail("mesh: {} vertices in the middle of edges, of elements that are{} quadratic", mesh.mid_edges.size(),
         quadratic ? "" : " not");
  if (quadratic) {
    build_quadratic(mesh);
  } else {
    build_linear(mesh);
  }
  for (std::size_t p = 0; p < points(); ++p) weight_[p] *= stiffness_of(p);
  if (averages() && !stiffness_.empty()) fail("mesh: of several stiffnesses, whose pressure is not averaged");
  if (averages()) gather_patches();
}

Solid::Scratch::Scratch(const Solid& solid)
    : forces_(kElementsOfBatch * static_cast<std::size_t>(solid.corners_)),
      blocks_(kElementsOfBatch * blocks_of(solid.corners_)) {
  if (!solid.averages()) return;
  dilation_.resize(solid.elements());
  nodal_dilation_.resize(solid.rest_.size());
}

std::size_t Solid::Scratch::bytes() const {
  return (dilation_.size() + nodal_dilation_.size()) * sizeof(double) + forces_.size() * sizeof(Vec3) +
         blocks_.size() * sizeof(Mat3);
}

double Solid::Scratch::mean_dilation(const int* nodes) const {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += nodal_dilation_[nodes[i]];
  return sum / 4;
}

void Solid::build_linear(const TetMesh& mesh) {
  for (const Tetrahedron& t : mesh.tetrahedra) {
    element_nodes_.insert(element_nodes_.end(), t.begin(), t.end());
    const LinearTetrahedron element({rest_[t[0]], rest_[t[1]], rest_[t[2]], rest_[t[3]]});
    weight_.push_back(element.volume);
    gradient_.insert(gradient_.end(), element.gradient.begin(), element.gradient.end());
  }
}

void Solid::build_quadratic(const TetMesh& mesh) {
  constexpr double kNear = 0.5854101966249685, kFar = 0.1381966011250105;  // barycentric, of the four points
  corners_ = 10;
  points_ = 4;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    element_nodes_.insert(element_nodes_.end(), t.begin(), t.end());
    for (const auto& [a, b] : kEdges) element_nodes_.push_back(mesh.middle(t[a], t[b]));
    const LinearTetrahedron element({rest_[t[0]], rest_[t[1]], rest_[t[2]], rest_[t[3]]});
    const auto& g = element.gradient;
    for (int q = 0; q < 4; ++q) {
      weight_.push_back(element.volume / 4);
      const auto l = [q](int i) { return i == q ? kNear : kFar; };
      for (int i = 0; i < 4; ++i) gradient_.push_back((4 * l(i) - 1) * g[i]);  // of l (2 l - 1)
      for (const auto& [a, b] : kEdges) gradient_.push_back(4 * (l(a) * g[b] + l(b) * g[a]));
    }
  }
}

void Solid::gather_patches() {
  std::vector<int> count(rest_.size() + 1, 0);
  for (const int node : element_nodes_) ++count[static_cast<std::size_t>(node) + 1];
  std::partial_sum(count.begin(), count.end(), count.begin());
  around_first_ = count;
  around_.resize(element_nodes_.size());
  nodal_volume_.assign(rest_.size(), 0);
  for (std::size_t k = 0; k < element_nodes_.size(); ++k) {
    const int node = element_nodes_[k];
    around_[count[node]++] = static_cast<int>(k / 4);
    nodal_volume_[node] += weight_[k / 4] / 4;
  }
}

void Solid::remove(std::size_t e) {
  for (int q = 0; q < points_; ++q) weight_[Element(*this, e).point(q)] = 0;
}

void Solid::reshape(const TetMesh& mesh, std::span<const int> tetrahedra) {
  for (const int t : tetrahedra) {
    const auto e = static_cast<std::size_t>(t);
    const Tetrahedron& corners = mesh.tetrahedra[e];
    std::array<Vec3, 4> places;
    for (std::size_t i = 0; i < 4; ++i)
      places[i] = rest_[static_cast<std::size_t>(corners[i])] =
          mesh.vertices[static_cast<std::size_t>(corners[i])];
    const LinearTetrahedron element(places);
    std::ranges::copy(corners, element_nodes_.begin() + static_cast<std::ptrdiff_t>(4 * e));
    std::ranges::copy(element.gradient, gradient_.begin() + static_cast<std::ptrdiff_t>(4 * e));
    weight_[e] = element.volume * stiffness_of(e);
  }
}

std::vector<double> Solid::masses() const {
  std::vector<double> masses(rest_.size(), 0);
  for (std::size_t e = 0; e < elements(); ++e) {
    double mass = 0;
    for (int q = 0; q < points_; ++q) mass += material_.density * volume_of(Element(*this, e).point(q));
    for (int i = 0; i < corners_; ++i) {
      const double fraction = corners_ == 4 ? 0.25 : i < 4 ? 1.0 / 36 : 4.0 / 27;
      masses[element_nodes_[e * static_cast<std::size_t>(corners_) + static_cast<std::size_t>(i)]] +=
          fraction * mass;
    }
  }
  return masses;
}

void Solid::add_body_forces(const Vec3& per_volume, std::span<Vec3> f) const {
  const auto points = static_cast<std::size_t>(points_);
  for (std::size_t e = 0; e < elements(); ++e) {
    double volume = 0;
    for (std::size_t q = 0; q < points; ++q) volume += volume_of(e * points + q);
    const std::span<const int> nodes = element(e);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      f[nodes[i]] += (corners_ == 4 ? 0.25 : i < 4 ? -0.05 : 0.2) * volume * per_volume;
  }
}

StiffnessMatrix Solid::stiffness_matrix(const FreeDofs& dofs) const {
  std::vector<int> groups, first{0};
  if (!averages()) {
    for (std::size_t k = static_cast<std::size_t>(corners_); k <= element_nodes_.size();
         k += static_cast<std::size_t>(corners_))
      first.push_back(static_cast<int>(k));
    return {dofs, element_nodes_, first};
  }
  for (std::size_t a = 0; a < rest_.size(); ++a) {
    const auto begin = static_cast<long>(groups.size());
    for (int k = around_first_[a]; k < around_first_[a + 1]; ++k)
      groups.insert(groups.end(), element_nodes_.begin() + 4 * around_[k],
                    element_nodes_.begin() + 4 * around_[k] + 4);
    std::sort(groups.begin() + begin, groups.end());
    groups.erase(std::unique(groups.begin() + begin, groups.end()), groups.end());
    first.push_back(static_cast<int>(groups.size()));
  }
  return {dofs, groups, first};
}

void Solid::evaluate(std::span<const Vec3> x, std::span<State> at_points, const Viscosity& viscosity) const {
  Scratch scratch(*this);
  evaluate(x, at_points, viscosity, scratch);
}

double Solid::energy(std::span<const Vec3> x) const {
  Scratch scratch(*this);
  return energy(x, scratch);
}

void Solid::forces(std::span<const Vec3> x, std::span<Vec3> f, const Viscosity& viscosity) const {
  Scratch scratch(*this);
  forces(x, f, viscosity, scratch);
}

void Solid::add_stiffness(std::span<const Vec3> x, StiffnessMatrix& k, const Viscosity& viscosity) const {
  Scratch scratch(*this);
  add_stiffness(x, k, viscosity, scratch);
}

std::size_t Solid::bytes() const {
  return (rest_.size() + gradient_.size()) * sizeof(Vec3) +
         (weight_.size() + stiffness_.size() + nodal_volume_.size()) * sizeof(double) +
         (element_nodes_.size() + around_.size() + around_first_.size()) * sizeof(int);
}

}  // namespace palpate::sim
