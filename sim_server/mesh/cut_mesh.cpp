#include "sim_server/mesh/cut_mesh.h"

#include <algorithm>
#include <map>

namespace palpate::sim {
namespace {

Triangle corners_of_face(const TetMesh& mesh, int face) {
  const Tetrahedron& t = mesh.tetrahedra[static_cast<std::size_t>(face / 4)];
  const Triangle& corner = kOutwardFaces[static_cast<std::size_t>(face % 4)];
  return {t[corner[0]], t[corner[1]], t[corner[2]]};
}

Triangle ascending(Triangle t) {
  std::ranges::sort(t);
  return t;
}

/// The vertices of a surface with those of what may be removed, ascending.
std::vector<int> all_vertices(const Surface& surface, const TetMesh& mesh, std::span<const char> removable) {
  std::vector<int> all = surface.vertices;
  for (std::size_t t = 0; t < removable.size(); ++t) {
    if (removable[t] != 0) all.insert(all.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
  }
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

/// The face of `other` that is towards `tetrahedron`.
int CutMesh::facing(int other, int tetrahedron) const {
  const auto& back = neighbours_[static_cast<std::size_t>(other)];
  return 4 * other + static_cast<int>(std::ranges::find(back, tetrahedron) - back.begin());
}

CutMesh::CutMesh(const TetMesh& mesh, std::vector<char> removable, Surface& surface)
    : mesh_(&mesh),
      neighbours_(face_neighbours(mesh)),
      remaining_(mesh.tetrahedra.size(), 1),
      removable_(std::move(removable)),
      inner_(4 * mesh.tetrahedra.size()),
      count_(mesh.tetrahedra.size()),
      around_first_(mesh.vertices.size() + 1),
      number_(mesh.vertices.size(), -1),
      slot_(4 * mesh.tetrahedra.size(), -1) {
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int v : t) ++around_first_[static_cast<std::size_t>(v) + 1];
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) around_first_[v + 1] += around_first_[v];
  around_.resize(4 * mesh.tetrahedra.size());
  around_end_.assign(around_first_.begin() + 1, around_first_.end());
  std::vector<int> next = around_first_;
  std::map<Triangle, int> outer;
  for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
    for (const int v : mesh.tetrahedra[static_cast<std::size_t>(t)]) around_[next[v]++] = t;
    for (int k = 0; k < 4; ++k) {
      const bool inside = neighbours_[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] >= 0;
      inner_[static_cast<std::size_t>(4 * t + k)] = inside ? 1 : 0;
      if (!inside) outer.emplace(ascending(corners_of_face(mesh, 4 * t + k)), 4 * t + k);
    }
  }
  const std::vector<int> before = surface.vertices;
  surface.vertices = all_vertices(surface, mesh, removable_);
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    number_[static_cast<std::size_t>(surface.vertices[v])] = static_cast<int>(v);
  uses_.assign(surface.vertices.size(), 0);
  for (Triangle& triangle : surface.triangles) {
    Triangle of_mesh;
    for (std::size_t i = 0; i < 3; ++i) of_mesh[i] = before[static_cast<std::size_t>(triangle[i])];
    const int face = outer.at(ascending(of_mesh));
    slot_[static_cast<std::size_t>(face)] = static_cast<int>(faces_.size());
    faces_.push_back(face);
    for (std::size_t i = 0; i < 3; ++i) {
      triangle[i] = number_[static_cast<std::size_t>(of_mesh[i])];
      ++uses_[static_cast<std::size_t>(triangle[i])];
    }
  }
}

std::span<const int> CutMesh::around(int vertex) const {
  const auto v = static_cast<std::size_t>(vertex);
  return std::span(around_).subspan(static_cast<std::size_t>(around_first_[v]),
                                    static_cast<std::size_t>(around_end_[v] - around_first_[v]));
}

std::array<int, 4> CutMesh::neighbours(int tetrahedron) const {
  std::array<int, 4> across = neighbours_[static_cast<std::size_t>(tetrahedron)];
  for (int& other : across) {
    if (other >= 0 && !remains(other)) other = -1;
  }
  return across;
}

Vec3 CutMesh::centre_of_face(int face) const {
  Vec3 sum = Vec3::Zero();
  for (const int v : corners_of_face(*mesh_, face)) sum += mesh_->vertices[static_cast<std::size_t>(v)];
  return sum / 3;
}

double CutMesh::area_of(int face) const {
  const auto [a, b, c] = corners_of_face(*mesh_, face);
  const Vec3& x = mesh_->vertices[static_cast<std::size_t>(a)];
  return 0.5 * (mesh_->vertices[static_cast<std::size_t>(b)] - x)
                   .cross(mesh_->vertices[static_cast<std::size_t>(c)] - x)
                   .norm();
}

void CutMesh::add_triangle(int face, Surface& surface) {
  Triangle triangle = corners_of_face(*mesh_, face);
  for (int& corner : triangle) {
    corner = number_[static_cast<std::size_t>(corner)];
    ++uses_[static_cast<std::size_t>(corner)];
  }
  slot_[static_cast<std::size_t>(face)] = static_cast<int>(faces_.size());
  faces_.push_back(face);
  surface.triangles.push_back(triangle);
  cut_area_ += area_of(face);
}

void CutMesh::drop_triangle(int face, Surface& surface) {
  int& place = slot_[static_cast<std::size_t>(face)];
  const auto slot = static_cast<std::size_t>(place);
  if (inner_[static_cast<std::size_t>(face)] != 0) cut_area_ -= area_of(face);
  for (const int corner : surface.triangles[slot]) --uses_[static_cast<std::size_t>(corner)];
  faces_[slot] = faces_.back();
  slot_[static_cast<std::size_t>(faces_[slot])] = place;
  surface.triangles[slot] = surface.triangles.back();
  place = -1;
  faces_.pop_back();
  surface.triangles.pop_back();
}

void CutMesh::remove(std::span<const int> tetrahedra, Surface& surface) {
  for (const int t : tetrahedra) remaining_[static_cast<std::size_t>(t)] = 0;
  count_ -= tetrahedra.size();
  for (const int t : tetrahedra) {
    const std::array<int, 4>& across = neighbours_[static_cast<std::size_t>(t)];
    for (int k = 0; k < 4; ++k) {
      const int face = 4 * t + k, other = across[static_cast<std::size_t>(k)];
      if (slot_[static_cast<std::size_t>(face)] >= 0) drop_triangle(face, surface);
      if (other < 0 || !remains(other)) continue;
      add_triangle(facing(other, t), surface);
    }
  }
}

std::size_t CutMesh::bytes() const {
  return neighbours_.size() * sizeof(neighbours_[0]) + remaining_.size() + removable_.size() + inner_.size() +
         (around_.size() + around_first_.size() + around_end_.size() + number_.size() + faces_.size() +
          slot_.size() + uses_.size()) *
             sizeof(int);
}

}  // namespace palpate::sim
