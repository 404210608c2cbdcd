#include "sim_server/mesh/cracks.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "common/contact/simplex_distance.h"

namespace palpate::sim {
namespace {

constexpr double kOfAnEdge = 1e-6;
constexpr double kFacing = -0.999;  // cosine of the angle between the normals
constexpr int kMostCells = 64;      // along an axis: faces are put into boxes of a grid

struct OuterFace {
  std::array<Vec3, 3> x;
  Vec3 normal, middle;  // not of unit length: twice the area
  double edge;          // the shortest
};

OuterFace outer_face_of(const TetMesh& mesh, const Triangle& t) {
  OuterFace face;
  face.x = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  const auto& [a, b, c] = face.x;
  face.normal = (b - a).cross(c - a);
  face.middle = (a + b + c) / 3;
  face.edge = std::min({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return face;
}

/// Boxes of equal size, each with the faces whose own box meets it.
class FaceGrid {
 public:
  FaceGrid(std::span<const OuterFace> faces, double margin) : margin_(margin) {
    Eigen::AlignedBox3d all;
    for (const OuterFace& face : faces) all.extend(box_of(face));
    low_ = all.min();
    cell_ = std::max(all.sizes().maxCoeff() / kMostCells, 1e-300);
    for (int i = 0; i < static_cast<int>(faces.size()); ++i) {
      const Eigen::AlignedBox3d box = box_of(faces[i]);
      const Eigen::Vector3i first = cell(box.min()), last = cell(box.max());
      for (int x = first[0]; x <= last[0]; ++x) {
        for (int y = first[1]; y <= last[1]; ++y) {
          for (int z = first[2]; z <= last[2]; ++z) faces_[key({x, y, z})].push_back(i);
        }
      }
    }
  }
  std::span<const int> at(const Vec3& p) const {
    const auto found = faces_.find(key(cell(p)));
    return found == faces_.end() ? std::span<const int>() : std::span<const int>(found->second);
  }

 private:
  Eigen::AlignedBox3d box_of(const OuterFace& face) const {
    Eigen::AlignedBox3d box;
    for (const Vec3& x : face.x) box.extend(x);
    return {box.min().array() - margin_, box.max().array() + margin_};
  }
  Eigen::Vector3i cell(const Vec3& p) const { return ((p - low_) / cell_).array().floor().cast<int>(); }
  static int key(const Eigen::Vector3i& c) {
    constexpr int kStride = kMostCells + 2;
    return (c[0] * kStride + c[1]) * kStride + c[2];
  }

  double margin_, cell_ = 1;
  Vec3 low_;
  std::unordered_map<int, std::vector<int>> faces_;
};

/// True if `other` faces `face`, and lies on its middle.
bool lies_on(const OuterFace& other, const OuterFace& face, double same_place) {
  if (other.normal.dot(face.normal) > kFacing * other.normal.norm() * face.normal.norm()) return false;
  const auto weight = closest_point(face.middle, other.x[0], other.x[1], other.x[2]).weight;
  const Vec3 nearest = weight[0] * other.x[0] + weight[1] * other.x[1] + weight[2] * other.x[2];
  return (nearest - face.middle).norm() <= std::max(same_place, kOfAnEdge * std::min(face.edge, other.edge));
}

}  // namespace

Cracks find_cracks(const TetMesh& mesh, std::span<const Triangle> outer_faces, double same_place) {
  std::vector<OuterFace> faces;
  faces.reserve(outer_faces.size());
  double shortest = std::numeric_limits<double>::max();
  for (const Triangle& t : outer_faces) {
    faces.push_back(outer_face_of(mesh, t));
    shortest = std::min(shortest, faces.back().edge);
  }
  Cracks found;
  if (faces.empty()) return found;
  const FaceGrid grid(faces, std::max(same_place, kOfAnEdge * shortest));
  for (int i = 0; i < static_cast<int>(faces.size()); ++i) {
    const OuterFace& face = faces[i];
    const bool covered = std::ranges::any_of(
        grid.at(face.middle), [&](int j) { return j != i && lies_on(faces[j], face, same_place); });
    if (!covered) continue;
    if (++found.faces == 1) found.place = face.middle;
    found.area += face.normal.norm() / 4;  // each side counts half
  }
  return found;
}

}  // namespace palpate::sim
