#include "sim_server/cutting/scalpel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace palpate::sim {
namespace {

// Of the mean edge: how far ahead of the blade and beyond its ends vertices slide; how long its trail is; and
// how far it goes before it is looked at. Of the trail: so far back faces are still parted, that a slide has
// brought there.
constexpr double kAhead = 1, kBeyond = 0.5, kTrail = 1, kLeastMotion = 0.02, kBehind = 0.25;
constexpr double kAlongItself = 1e-3;  // sine of the angle between an edge and its way, which parts nothing
constexpr double kMostSlide = 0.5;     // of an edge
constexpr double kLeastHeight = 0.3;  // of the mean shortest height of tetrahedra, unless it was lower before
constexpr double kSameVolume = 1e-3;  // of what is around a vertex

const Vec3& at(const CutMesh& mesh, std::span<const Vec3> positions, int vertex) {
  return positions[static_cast<std::size_t>(mesh.number_of(vertex))];
}

Vec3 centre_at(const CutMesh& mesh, std::span<const Vec3> positions, int tetrahedron) {
  Vec3 sum = Vec3::Zero();
  for (const int v : mesh.mesh().tetrahedra[static_cast<std::size_t>(tetrahedron)])
    sum += at(mesh, positions, v);
  return 0.25 * sum;
}

/// True if the line from `p` to `q` meets the triangle, on its border too.
bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double from = normal.dot(p - a), to = normal.dot(q - a);
  if ((from >= 0) == (to >= 0)) return false;
  const Vec3 x = p + from / (from - to) * (q - p);
  const double least = -1e-9 * normal.squaredNorm();
  return (b - a).cross(x - a).dot(normal) >= least && (c - b).cross(x - b).dot(normal) >= least &&
         (a - c).cross(x - c).dot(normal) >= least;
}

bool passes_through(const BladeEdge& was, const BladeEdge& is, const Vec3& p, const Vec3& q) {
  return crosses(p, q, was[0], was[1], is[1]) || crosses(p, q, was[0], is[1], is[0]);
}

/// Returns the motion of its middle, m.
Vec3 motion_of(const BladeEdge& was, const BladeEdge& is) {
  return 0.5 * (is[0] + is[1] - was[0] - was[1]);
}

/// The volume around a vertex, m^3, and the lowest of the heights there, m.
std::pair<double, double> shape_around(const CutMesh& mesh, int vertex) {
  double volume = 0, height = 1;
  for (const int t : mesh.around(vertex)) {
    if (!mesh.remains(t)) continue;
    const Tetrahedron& corners = mesh.mesh().tetrahedra[static_cast<std::size_t>(t)];
    const double six = six_volumes(mesh.mesh(), corners);
    volume += six / 6;
    height = std::min(height, six > 0 ? shortest_height(mesh.mesh(), corners) : 0);
  }
  return {volume, height};
}

Triangle corners_of(const CutMesh& mesh, int face) {
  const Tetrahedron& t = mesh.mesh().tetrahedra[static_cast<std::size_t>(face / 4)];
  const Triangle& corner = kOutwardFaces[static_cast<std::size_t>(face % 4)];
  return {t[static_cast<std::size_t>(corner[0])], t[static_cast<std::size_t>(corner[1])],
          t[static_cast<std::size_t>(corner[2])]};
}

/// True if an edge of what is left is one of the surface.
bool is_on_surface(const CutMesh& mesh, int vertex, int towards) {
  return std::ranges::any_of(mesh.around(vertex), [&](int t) {
    const Tetrahedron& corners = mesh.mesh().tetrahedra[static_cast<std::size_t>(t)];
    if (!mesh.remains(t) || std::ranges::find(corners, towards) == corners.end()) return false;
    for (int k = 0; k < 4; ++k) {
      const int skipped = corners[static_cast<std::size_t>(k)];
      if (skipped != vertex && skipped != towards && mesh.is_surface(4 * t + k)) return true;
    }
    return false;
  });
}

}  // namespace

Scalpel::Scalpel(const CutMesh& mesh) : slid_(mesh.mesh().vertices.size()) {
  double edges = 0, tetrahedra = 0;
  for (std::size_t t = 0; t < mesh.mesh().tetrahedra.size(); ++t) {
    if (!mesh.is_removable(static_cast<int>(t))) continue;
    const Tetrahedron& corners = mesh.mesh().tetrahedra[t];
    for (const auto& [a, b] : kEdges) {
      const double length = (mesh.mesh().vertices[static_cast<std::size_t>(corners[a])] -
                             mesh.mesh().vertices[static_cast<std::size_t>(corners[b])])
                                .norm();
      edges += length;
      longest_ = std::max(longest_, length);
    }
    height_ += shortest_height(mesh.mesh(), corners);
    ++tetrahedra;
  }
  edge_ = edges / (6 * tetrahedra);
  height_ /= tetrahedra;
}

/// Those whose centres are in a box around what the edge went through, and some edges of the mesh.
std::vector<int> Scalpel::around(const BladeEdge& was, const BladeEdge& is, std::span<const Vec3> are,
                                 const CutMesh& mesh) const {
  const Vec3 low = was[0].cwiseMin(was[1]).cwiseMin(is[0].cwiseMin(is[1])).array() - 2 * longest_;
  const Vec3 high = was[0].cwiseMax(was[1]).cwiseMax(is[0].cwiseMax(is[1])).array() + 2 * longest_;
  std::vector<int> near;
  for (int t = 0; t < static_cast<int>(mesh.mesh().tetrahedra.size()); ++t) {
    if (!mesh.remains(t) || !mesh.is_removable(t)) continue;
    const Vec3 centre = centre_at(mesh, are, t);
    if ((centre.array() >= low.array()).all() && (centre.array() <= high.array()).all()) near.push_back(t);
  }
  return near;
}

/// Returns where edges go through the plane, that their nearer ends could slide along; the shortest way
/// first.
std::vector<Scalpel::Crossing> Scalpel::crossings(const Plane& plane, std::span<const int> near,
                                                  std::span<const Vec3> are, const CutMesh& mesh) const {
  std::vector<Crossing> found;
  const auto meets = [&](const Vec3& x) {
    const double along = plane.along.dot(x - plane.origin), ahead = plane.ahead.dot(x - plane.origin);
    return along >= -kBeyond * edge_ && along <= plane.length + kBeyond * edge_ && ahead >= -plane.back &&
           ahead <= kAhead * edge_;
  };
  const auto observe = [&](int v, int w) {
    const Vec3 &x = at(mesh, are, v), along = at(mesh, are, w) - x;
    const double from = plane.normal.dot(x - plane.origin), to = from + plane.normal.dot(along);
    const double fraction = from / (from - to);
    if (from * to < 0 && fraction <= kMostSlide && !stays(v) && meets(x + fraction * along))
      found.push_back({v, w, fraction, fraction * along.norm()});
  };
  for (const int t : near) {
    const Tetrahedron& corners = mesh.mesh().tetrahedra[static_cast<std::size_t>(t)];
    for (const auto& [a, b] : kEdges) {
      observe(corners[static_cast<std::size_t>(a)], corners[static_cast<std::size_t>(b)]);
      observe(corners[static_cast<std::size_t>(b)], corners[static_cast<std::size_t>(a)]);
    }
  }
  std::ranges::sort(found, {}, [](const Crossing& c) { return std::tuple(c.far, c.vertex, c.towards); });
  return found;
}

/// It has slid, or is not to.
bool Scalpel::stays(int vertex) const {
  return slid_[static_cast<std::size_t>(vertex)] != 0 || std::ranges::find(stored_, vertex) != stored_.end();
}

/// True if the vertex of a crossing may slide: one that does not stay.
bool Scalpel::may_slide(const Crossing& crossing, const CutMesh& mesh) const {
  if (!mesh.is_free(crossing.vertex) || mesh.on_cut(crossing.vertex)) return false;
  return !mesh.on_surface(mesh.number_of(crossing.vertex)) ||
         is_on_surface(mesh, crossing.vertex, crossing.towards);
}

/// Slides the vertex, at rest, where that does the shapes around it no harm.
bool Scalpel::slide(const Crossing& crossing, CutMesh& mesh) const {
  const auto [volume, height] = shape_around(mesh, crossing.vertex);
  const Vec3 before = mesh.mesh().vertices[static_cast<std::size_t>(crossing.vertex)];
  const Vec3 end = mesh.mesh().vertices[static_cast<std::size_t>(crossing.towards)];
  mesh.move_vertex(crossing.vertex, before + crossing.fraction * (end - before));
  const auto [volume_then, height_then] = shape_around(mesh, crossing.vertex);
  const bool good = height_then >= std::min(height, kLeastHeight * height_) &&
                    std::abs(volume_then - volume) <= kSameVolume * volume;
  if (!good) mesh.move_vertex(crossing.vertex, before);
  return good;
}

/// Those that can, whether others have slid before or not.
void Scalpel::slide_onto(const Plane& plane, std::span<const int> near, std::span<Vec3> were,
                         std::span<Vec3> are, CutMesh& mesh, std::vector<CuttableModel::Slide>& slides) {
  std::size_t before = 0;
  do {
    before = slides.size();
    for (const Crossing& crossing : crossings(plane, near, are, mesh)) {
      const auto [v, w, fraction, far] = crossing;
      if (stays(v) || stays(w) || !may_slide(crossing, mesh) || !slide(crossing, mesh)) continue;
      for (const std::span<Vec3> positions : {were, are}) {
        Vec3& x = positions[static_cast<std::size_t>(mesh.number_of(v))];
        x += fraction * (at(mesh, positions, w) - x);
      }
      slid_[static_cast<std::size_t>(v)] = 1;
      slides.push_back({v, w, fraction});
    }
  } while (slides.size() > before);
}

/// Finds the faces between centres whose line the blade or its trail crossed, in the tissue as it is now:
/// where the blade was, that has since moved on. Faces next to tissue that cannot be cut stay; the blade is
/// at the end where it crossed an edge of one.
void Scalpel::find_faces(const BladeSweep& blade, std::span<const int> near, std::span<const Vec3> were,
                         std::span<const Vec3> are, const CutMesh& mesh, Stroke& stroke) const {
  const auto crosses = [&](const Vec3& shift, const Vec3& p, const Vec3& q) {
    const Vec3 moved = shift + kBehind * blade.trail;
    return passes_through({blade.was[0] + moved, blade.was[1] + moved}, blade.is, p, q);
  };
  for (const int t : near) {
    const Vec3 p = centre_at(mesh, are, t), p_was = centre_at(mesh, were, t);
    for (int face = 4 * t; face < 4 * t + 4; ++face) {
      if (mesh.across(face) < 0) continue;
      if (!mesh.can_part(face)) {
        const Triangle corners = corners_of(mesh, face);
        for (std::size_t k = 0; k < 3; ++k)
          stroke.at_end |= crosses(p - p_was, at(mesh, are, corners[k]), at(mesh, are, corners[(k + 1) % 3]));
        continue;
      }
      if (mesh.across(face) < face) continue;
      const int other = mesh.across(face) / 4;
      const Vec3 q = centre_at(mesh, are, other);
      if (crosses(0.5 * (p - p_was + q - centre_at(mesh, were, other)), p, q)) stroke.faces.push_back(face);
    }
  }
}

Stroke Scalpel::cut(const BladeSweep& blade, std::span<Vec3> were, std::span<Vec3> are, CutMesh& mesh) {
  const auto& [was, is, trail] = blade;
  const std::vector<int> near = around(was, is, are, mesh);
  Vec3 tissue = Vec3::Zero();
  for (const int t : near) tissue += centre_at(mesh, are, t) - centre_at(mesh, were, t);
  Stroke stroke{.motion =
                    motion_of(was, is) - tissue / std::max<double>(1, static_cast<double>(near.size()))};
  if (stroke.motion.norm() < kLeastMotion * edge_) return stroke;
  stroke.moved = true;
  const Vec3 edge = is[1] - is[0], course = stroke.motion - trail, across = edge.cross(course);
  stroke.trail = -std::min(1.0, kTrail * edge_ / course.norm()) * course;
  if (across.norm() > kAlongItself * edge.norm() * course.norm()) {
    Plane plane{is[0], edge.normalized(), {}, across.normalized(), edge.norm(), {}};
    plane.ahead = plane.normal.cross(plane.along);
    plane.back = course.dot(plane.ahead);
    slide_onto(plane, near, were, are, mesh, stroke.slides);
  }
  find_faces(blade, near, were, are, mesh, stroke);
  return stroke;
}

}  // namespace palpate::sim
