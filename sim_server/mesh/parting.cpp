// How faces are parted: parts of CutMesh.
#include <algorithm>
#include <cassert>

#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

CutMesh::CutMesh(TetMesh& mesh, std::vector<char> removable, Surface& surface, std::span<const int> held)
    : CutMesh(mesh, std::move(removable), surface) {
  separated_ = &mesh;
  add_spares(held, surface);
}

/// Adds spare vertices at the places of those of which they may become copies.
void CutMesh::add_spares(std::span<const int> held, Surface& surface) {
  std::vector<char> may_split(mesh_->vertices.size());
  for (std::size_t t = 0; t < removable_.size(); ++t) {
    if (removable_[t] == 0) continue;
    for (const int v : mesh_->tetrahedra[t]) may_split[static_cast<std::size_t>(v)] = 1;
  }
  next_spare_ = static_cast<int>(mesh_->vertices.size());
  for (std::size_t v = 0; v < may_split.size(); ++v) {
    if (may_split[v] == 0) continue;
    const auto spare = static_cast<int>(mesh_->vertices.size());
    separated_->vertices.push_back(Vec3(mesh_->vertices[v]));
    number_.push_back(static_cast<int>(surface.vertices.size()));
    surface.vertices.push_back(spare);
  }
  spares_end_ = static_cast<int>(mesh_->vertices.size());
  uses_.resize(surface.vertices.size(), 0);
  held_.resize(mesh_->vertices.size(), 0);
  for (const int v : held) held_[static_cast<std::size_t>(v)] = 1;
  around_first_.back() = 0;  // where those of the last vertex ended
  around_first_.resize(mesh_->vertices.size(), 0);
  around_end_.resize(mesh_->vertices.size(), 0);
}

int CutMesh::across(int face) const {
  const int other = neighbours_[static_cast<std::size_t>(face / 4)][static_cast<std::size_t>(face % 4)];
  return other < 0 || !remains(other) ? -1 : facing(other, face / 4);
}

bool CutMesh::can_part(int face) const {
  const int other = across(face);
  return other >= 0 && remains(face / 4) && is_removable(face / 4) && is_removable(other / 4);
}

bool CutMesh::is_free(int vertex) const {
  const auto fixed = [this](int t) { return remains(t) && !is_removable(t); };
  return held_[static_cast<std::size_t>(vertex)] == 0 && std::ranges::none_of(around(vertex), fixed);
}

bool CutMesh::on_cut(int vertex) const {
  return std::ranges::any_of(around(vertex), [&](int t) {
    const Tetrahedron& corners = mesh_->tetrahedra[static_cast<std::size_t>(t)];
    for (int k = 0; k < 4; ++k) {
      const auto face = static_cast<std::size_t>(4 * t + k);
      if (corners[static_cast<std::size_t>(k)] != vertex && slot_[face] >= 0 && inner_[face] != 0)
        return true;
    }
    return false;
  });
}

Parting CutMesh::part(std::span<const int> faces, Surface& surface) {
  assert(separated_ != nullptr);
  Parting parting;
  std::vector<int> corners;
  for (const int face : faces) {
    const int other = across(face);
    if (other < 0) continue;  // it was named by both of its sides
    for (const int side : {face, other}) {
      neighbours_[static_cast<std::size_t>(side / 4)][static_cast<std::size_t>(side % 4)] = -1;
      add_triangle(side, surface);
      parting.tetrahedra.push_back(side / 4);
    }
    for (int k = 0; k < 4; ++k) {
      if (k != face % 4)
        corners.push_back(mesh_->tetrahedra[static_cast<std::size_t>(face / 4)][static_cast<std::size_t>(k)]);
    }
  }
  for (std::vector<int>* const list : {&corners, &parting.tetrahedra}) {
    std::ranges::sort(*list);
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  Changed changed;
  for (const int v : corners) {
    if (is_free(v)) split(v, surface, parting, changed);
  }
  parting.changed.assign(changed.begin(), changed.end());
  return parting;
}

/// Returns what is left around a vertex, by what hangs together by faces that have it; each ascending, and so
/// their first ones.
std::vector<std::vector<int>> CutMesh::fans_around(int vertex) const {
  std::vector<int> waiting;
  std::ranges::copy_if(around(vertex), std::back_inserter(waiting), [this](int t) { return remains(t); });
  std::ranges::sort(waiting);
  std::vector<std::vector<int>> fans;
  while (!waiting.empty()) {
    std::vector<int>& fan = fans.emplace_back(1, waiting.front());
    waiting.erase(waiting.begin());
    for (std::size_t next = 0; next < fan.size(); ++next) {
      const int t = fan[next];
      const std::array<int, 4> others = neighbours(t);
      for (std::size_t k = 0; k < 4; ++k) {
        if (mesh_->tetrahedra[static_cast<std::size_t>(t)][k] == vertex) continue;  // a face without it
        const auto found = std::ranges::find(waiting, others[k]);
        if (found == waiting.end()) continue;
        fan.push_back(*found);
        waiting.erase(found);
      }
    }
    std::ranges::sort(fan);
  }
  return fans;
}

void CutMesh::split(int vertex, Surface& surface, Parting& parting, Changed& changed) {
  std::vector<std::vector<int>> fans = fans_around(vertex);
  if (fans.size() < 2) return;
  fans.erase(std::ranges::max_element(fans, {}, [](const auto& fan) { return fan.size(); }));
  for (const std::vector<int>& fan : fans) {
    if (next_spare_ == spares_end_) {
      parting.ran_out = true;
      return;
    }
    const Split split{vertex, next_spare_++};
    give(fan, split, surface, changed);
    parting.splits.push_back(split);
  }
}

/// These tetrahedra have the copy from now on.
void CutMesh::give(const std::vector<int>& fan, const Split& split, Surface& surface, Changed& changed) {
  const auto v = static_cast<std::size_t>(split.vertex), copy = static_cast<std::size_t>(split.copy);
  separated_->vertices[copy] = mesh_->vertices[v];
  const auto end = around_.begin() + around_end_[v];
  const auto moved = std::stable_partition(around_.begin() + around_first_[v], end,
                                           [&](int t) { return !std::ranges::binary_search(fan, t); });
  around_first_[copy] = static_cast<int>(moved - around_.begin());
  around_end_[copy] = std::exchange(around_end_[v], around_first_[copy]);
  for (const int t : fan) {
    Tetrahedron& corners = separated_->tetrahedra[static_cast<std::size_t>(t)];
    changed.emplace(t, corners);
    std::ranges::replace(corners, split.vertex, split.copy);
    for (std::size_t k = 0; k < 4; ++k) {
      const int slot = slot_[4 * static_cast<std::size_t>(t) + k];
      if (slot < 0 || corners[k] == split.copy) continue;
      std::ranges::replace(surface.triangles[static_cast<std::size_t>(slot)], number_[v], number_[copy]);
      --uses_[static_cast<std::size_t>(number_[v])];
      ++uses_[static_cast<std::size_t>(number_[copy])];
    }
  }
}

double CutMesh::cut_area_around(int vertex) const {
  double area = 0;
  for (const int t : around(vertex)) {
    for (int k = 0; k < 4; ++k) {
      const auto face = static_cast<std::size_t>(4 * t + k);
      if (slot_[face] >= 0 && inner_[face] != 0) area += area_of(4 * t + k);
    }
  }
  return area;
}

void CutMesh::move_vertex(int vertex, const Vec3& x) {
  cut_area_ -= cut_area_around(vertex);
  separated_->vertices[static_cast<std::size_t>(vertex)] = x;
  cut_area_ += cut_area_around(vertex);
}

}  // namespace palpate::sim
