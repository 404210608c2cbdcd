#include "sim_server/elasticity/tensors.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "sim_server/elasticity/element.h"

namespace palpate::sim {
namespace {

// Of fewer edges, a helper takes as long as it saves; parts are so small that who is early does more of them.
constexpr std::size_t kEdgesOfMany = 40'000, kEdgesPerPart = 5'000, kMostParts = 16;

/// A place on the curve that visits the cells of a grid octant by octant (Morton 1966): the bits of the three
/// cell numbers in turn. `x`: in units of the box of all, 0 to 1.
std::uint64_t on_the_curve(const Vec3& x) {
  constexpr int kBits = 20;
  std::uint64_t place = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (const double coordinate : x) {
      const auto cell = static_cast<std::uint64_t>(coordinate * ((1 << kBits) - 1));
      place = place << 1 | (cell >> bit & 1);
    }
  }
  return place;
}

void sort_each_once(auto& list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

void add_remaining_around(const Tetrahedron& corners, const CutMesh& remaining, std::vector<int>& around) {
  for (const int v : corners) {
    for (const int other : remaining.around(v)) {
      if (remaining.remains(other)) around.push_back(other);
    }
  }
}

}  // namespace

ElasticTensors::ElasticTensors(const TetMesh& mesh, const Material& material, const std::vector<int>& fixed,
                               std::vector<double> mass_factors)
    : mass_factors_(std::move(mass_factors)) {
  number(mesh, fixed);
  find_edges(mesh);
  vertex_tensors_.assign(6 * mass_.size(), 0);
  edge_tensors_.assign(9 * neighbour_.size() + 1, 0);  // a product reads one beyond
  const auto all = [](int, int) { return true; };
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) add(mesh, e, material, all);
}

void ElasticTensors::note_touched(const Tetrahedron& corners, Touched& touched) const {
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const auto [before, after] = std::minmax(place_[corners[a]], place_[corners[b]]);
      if (before >= 0) touched.emplace_back(after, before);
    }
  }
}

void ElasticTensors::remove(std::span<const int> removed, const CutMesh& remaining,
                            const Material& material) {
  Touched touched;
  std::vector<int> around;
  for (const int t : removed) {
    const Tetrahedron& corners = remaining.mesh().tetrahedra[static_cast<std::size_t>(t)];
    note_touched(corners, touched);
    add_remaining_around(corners, remaining, around);
  }
  sum_anew(touched, around, remaining, material);
}

void ElasticTensors::part(const Parting& parting, std::span<const int> reshaped, const CutMesh& remaining,
                          const Material& material) {
  for (const Split& split : parting.splits) append(split.copy, remaining);
  Touched touched;
  std::vector<int> around;
  const auto note = [&](const Tetrahedron& corners) {
    note_touched(corners, touched);
    add_remaining_around(corners, remaining, around);
  };
  for (const auto& [t, before] : parting.changed) {
    note(before);
    note(remaining.mesh().tetrahedra[static_cast<std::size_t>(t)]);
  }
  for (const int t : reshaped) note(remaining.mesh().tetrahedra[static_cast<std::size_t>(t)]);
  if (!parting.splits.empty()) find_later_edges();
  sum_anew(touched, around, remaining, material);
}

/// A vertex that had no tetrahedron gets the last place, with an edge to each that is before it.
void ElasticTensors::append(int vertex, const CutMesh& remaining) {
  const int place = place_[static_cast<std::size_t>(vertex)] = static_cast<int>(mass_.size());
  std::vector<int> before;
  for (const int t : remaining.around(vertex)) {
    for (const int other : remaining.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      const int at = place_[static_cast<std::size_t>(other)];
      if (at >= 0 && at < place) before.push_back(at);
    }
  }
  sort_each_once(before);
  Part& last = parts_.back();
  for (const int at : before) {
    if (at >= last.begin) continue;
    const auto place_of = std::ranges::lower_bound(last.reaches, at);  // they are looked up by parts
    if (place_of == last.reaches.end() || *place_of != at) last.reaches.insert(place_of, at);
  }
  neighbour_.insert(neighbour_.end(), before.begin(), before.end());
  first_edge_.push_back(static_cast<int>(neighbour_.size()));
  edge_tensors_.resize(9 * neighbour_.size() + 1, 0);  // a product reads one beyond
  vertex_tensors_.resize(vertex_tensors_.size() + 6, 0);
  mass_.push_back(1);  // stays, as any would, where none of its tetrahedra is left by now
  if (!added_.empty()) added_.push_back(0);
}

/// Sums the tensors of what is `touched` anew, over the tetrahedra `around` it.
void ElasticTensors::sum_anew(Touched& touched, std::vector<int>& around, const CutMesh& remaining,
                              const Material& material) {
  sort_each_once(touched);
  sort_each_once(around);
  std::vector<double> mass_before;
  for (const auto& [i, j] : touched) {
    if (i != j) {
      std::fill_n(edge_tensor(i, j), 9, 0.0);
      continue;
    }
    std::fill_n(vertex_tensors_.begin() + 6 * std::ptrdiff_t{i}, 6, 0.0);
    mass_before.push_back(mass_[i]);
    mass_[i] = 0;
  }
  const auto is_touched = [&](int i, int j) { return std::ranges::binary_search(touched, std::pair(i, j)); };
  for (const int t : around) add(remaining.mesh(), static_cast<std::size_t>(t), material, is_touched);
  std::size_t k = 0;
  for (const auto& [i, j] : touched) {
    if (i != j) continue;
    mass_[i] = mass_[i] == 0 ? mass_before[k] : mass_[i] + (added_.empty() ? 0 : added_[i]);
    ++k;
  }
}

void ElasticTensors::add_mass(int place, double kg) {
  added_.resize(mass_.size(), 0);
  added_[static_cast<std::size_t>(place)] += kg;
  mass_[static_cast<std::size_t>(place)] += kg;
}

void ElasticTensors::number(const TetMesh& mesh, const std::vector<int>& fixed) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& x : mesh.vertices) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  std::vector<std::pair<std::uint64_t, int>> order;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (!std::ranges::binary_search(fixed, v))
      order.emplace_back(on_the_curve((mesh.vertices[v] - low) / (high - low).maxCoeff()), v);
  }
  std::ranges::sort(order);
  place_.assign(mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) place_[order[i].second] = static_cast<int>(i);
  mass_.assign(order.size(), 0);
}

void ElasticTensors::find_edges(const TetMesh& mesh) {
  std::vector<std::pair<int, int>> edges;  // the later end first
  edges.reserve(6 * mesh.tetrahedra.size());
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        const auto [before, after] = std::minmax(place_[t[i]], place_[t[j]]);
        if (before >= 0) edges.emplace_back(after, before);
      }
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  first_edge_.assign(mass_.size() + 1, 0);
  for (const auto& [after, before] : edges) {
    ++first_edge_[after + 1];
    neighbour_.push_back(before);
  }
  for (std::size_t i = 1; i < first_edge_.size(); ++i) first_edge_[i] += first_edge_[i - 1];
  distribute();
}

/// About as many edges for each part, and two, four, eight ... parts, so that as many cores end together.
void ElasticTensors::distribute() {
  const std::size_t edges = neighbour_.size(),
                    count = edges < kEdgesOfMany
                                ? 1
                                : std::min(std::bit_floor(edges / kEdgesPerPart), kMostParts);
  for (std::size_t p = 0; p < count; ++p) {
    const auto first = std::ranges::lower_bound(first_edge_, static_cast<int>(edges * p / count));
    parts_.push_back({static_cast<int>(first - first_edge_.begin()), {}});
  }
  for (std::size_t p = 1; p < count; ++p) {
    for (int e = first_edge_[parts_[p].begin]; e < first_edge_[end_of_part(p)]; ++e) {
      if (neighbour_[e] < parts_[p].begin) parts_[p].reaches.push_back(neighbour_[e]);
    }
    sort_each_once(parts_[p].reaches);
  }
  find_later_edges();
}

/// Ascending, as edges are.
void ElasticTensors::find_later_edges() {
  if (parts_.size() == 1) return;
  first_later_.assign(mass_.size() + 1, 0);
  for (const int before : neighbour_) ++first_later_[before + 1];
  for (std::size_t i = 1; i < first_later_.size(); ++i) first_later_[i] += first_later_[i - 1];
  later_edges_.resize(neighbour_.size());
  std::vector<int> next(first_later_.begin(), first_later_.end() - 1);
  for (int row = 0; row < vertices(); ++row) {
    for (int e = first_edge_[row]; e < first_edge_[row + 1]; ++e)
      later_edges_[next[neighbour_[e]]++] = {row, e};
  }
}

/// Returns the tensor of an edge that there is, j < i.
double* ElasticTensors::edge_tensor(int i, int j) {
  const auto from = neighbour_.begin() + first_edge_[i], to = neighbour_.begin() + first_edge_[i + 1];
  return edge_tensors_.data() + 9 * (std::lower_bound(from, to, j) - neighbour_.begin());
}

/// Adds what a tetrahedron gives to the tensors of the places that are `wanted`: (i, i) of a vertex, with its
/// mass, and (i, j), j < i, of an edge.
template <class Wanted>
void ElasticTensors::add(const TetMesh& mesh, std::size_t tetrahedron, const Material& material,
                         const Wanted& wanted) {
  const Tetrahedron& t = mesh.tetrahedra[tetrahedron];
  const double stiffness = mesh.stiffness.empty() ? 1 : mesh.stiffness[tetrahedron];
  const auto& x = mesh.vertices;
  const LinearTetrahedron element({x[t[0]], x[t[1]], x[t[2]], x[t[3]]});
  const Moduli moduli = LinearLaw::moduli(material);
  const double mass =
      material.density * element.volume * (mass_factors_.empty() ? 1 : mass_factors_[tetrahedron]);
  using Tensor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  for (int a = 0; a < 4; ++a) {
    const int i = place_[t[a]];
    if (i < 0) continue;
    if (wanted(i, i)) mass_[i] += mass / 4;
    for (int b = 0; b < 4; ++b) {
      const int j = place_[t[b]];
      if (j < 0 || j > i || !wanted(i, j)) continue;
      const Mat3 block =
          stiffness * element.volume * stiffness_per_volume(moduli, element.gradient[a], element.gradient[b]);
      if (j < i) {
        Eigen::Map<Tensor>(edge_tensor(i, j)) += block;
        continue;
      }
      double* own = vertex_tensors_.data() + 6 * std::ptrdiff_t{i};
      for (int r = 0; r < 3; ++r) {
        for (int c = r; c < 3; ++c) *own++ += block(r, c);
      }
    }
  }
}

void ElasticTensors::multiply(const double* x, double* y) const noexcept {
  const TensorsInPlace k{first_edge_.data(), neighbour_.data(), vertex_tensors_.data(), edge_tensors_.data()};
  product_of_rows(0, vertices(), k, x, y, nullptr);
}

void ElasticTensors::multiply_part(std::size_t p, const double* x, double* y, Ahead& ahead) const noexcept {
  const TensorsInPlace k{first_edge_.data(), neighbour_.data(), vertex_tensors_.data(), edge_tensors_.data()};
  product_of_separate_rows(parts_[p].begin, end_of_part(p), k, x, y, ahead[p].data());
}

void ElasticTensors::gather_part(std::size_t p, double* y, Ahead& ahead) const noexcept {
  const auto [begin, end] = rows_of_part(p);
  for (std::size_t after = p + 1; after < parts_.size(); ++after) {
    const std::vector<int>& reaches = parts_[after].reaches;
    double* const from = ahead[after].data();
    for (auto row = std::ranges::lower_bound(reaches, begin); row != reaches.end() && *row < end; ++row) {
      for (int i = kNumbersPerVertex * *row; i < kNumbersPerVertex * *row + 3; ++i)
        y[i] += std::exchange(from[i], 0);
    }
  }
}

void ElasticTensors::add_product(int place, const Vec3& x, double* y) const noexcept {
  using Block = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  const auto row = [y](int i) { return Eigen::Map<Vec3>(y + std::ptrdiff_t{kNumbersPerVertex} * i); };
  const auto edge = [this](int e) { return Block(edge_tensors_.data() + 9 * std::ptrdiff_t{e}); };
  const double* const k = vertex_tensors_.data() + 6 * std::ptrdiff_t{place};
  row(place) += Vec3(k[0] * x[0] + k[1] * x[1] + k[2] * x[2], k[1] * x[0] + k[3] * x[1] + k[4] * x[2],
                     k[2] * x[0] + k[4] * x[1] + k[5] * x[2]);
  for (int e = first_edge_[place]; e < first_edge_[place + 1]; ++e)
    row(neighbour_[e]).noalias() += edge(e).transpose() * x;
  for (int l = first_later_[place]; l < first_later_[place + 1]; ++l)
    row(later_edges_[l].row).noalias() += edge(later_edges_[l].edge) * x;
}

ElasticTensors::Ahead ElasticTensors::room_ahead() const {
  Ahead ahead;
  for (const Part& part : parts_)
    ahead.emplace_back(kNumbersPerVertex * static_cast<std::size_t>(part.begin), 0);
  return ahead;
}

void ElasticTensors::multiply_wide(const double* x, double* y) const noexcept {
  const TensorsInPlace k{first_edge_.data(), neighbour_.data(), vertex_tensors_.data(), edge_tensors_.data()};
  product_of_eight(vertices(), k, x, y);
}

std::size_t ElasticTensors::bytes() const {
  return (first_edge_.size() + neighbour_.size() + first_later_.size()) * sizeof(int) +
         later_edges_.size() * sizeof(LaterEdge) +
         (vertex_tensors_.size() + edge_tensors_.size()) * sizeof(double);
}

}  // namespace palpate::sim
