#include "sim_server/scene/loads.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::sim {
namespace {

Vec3 area_of(std::span<const Vec3> x, const std::array<int, 3>& corner) {
  return 0.5 * (x[corner[1]] - x[corner[0]]).cross(x[corner[2]] - x[corner[0]]);
}

/// Releases spare vertices: what becomes the copy of a vertex is of no tetrahedron at first, and those that
/// are held stay one.
void release_spares(const TetMesh& mesh, std::vector<HeldAxes>& held) {
  std::vector<char> is_corner(held.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int v : t) is_corner[static_cast<std::size_t>(v)] = 1;
  }
  for (std::size_t v = 0; v < held.size(); ++v) {
    if (is_corner[v] == 0) held[v] = 0;
  }
}

}  // namespace

Loads::Loads(const Scene& scene, const TetMesh& mesh, const Surface& surface, const Solid& solid)
    : follows_(solid.material().law != ElasticLaw::kLinear),
      rest_(solid.rest()),
      dead_(rest_.size(), Vec3::Zero()) {
  hold(scene, mesh);
  for (const Load& load : scene.loads) {
    if (load.kind == Load::Kind::kGravity) {
      solid.add_body_forces(solid.material().density * load.vector, dead_);
    } else if (load.kind == Load::Kind::kForce) {
      const std::vector<int> vertices = vertices_in(load.region, mesh);
      const auto resists = [&](int v) {
        int axes = 0;  // of the force
        for (int axis = 0; axis < 3; ++axis) axes |= load.vector[axis] != 0 ? 1 << axis : 0;
        return axes != 0 && (axes & ~held_[v]) == 0;
      };
      if (std::ranges::all_of(vertices, resists))
        fail("{}: every vertex in this region is held, so that the force would move nothing",
             load.region.where);
      for (const int v : vertices) dead_[v] += load.vector / static_cast<double>(vertices.size());
    } else if (load.kind == Load::Kind::kTraction) {
      for (const Face& face : movable_faces_in(load.region, mesh, surface))
        push(face, area_of(rest_, face.corners).norm() * load.vector, dead_);
    } else if (load.kind == Load::Kind::kPressure) {
      pressures_.push_back({load.pressure, movable_faces_in(load.region, mesh, surface)});
    }
  }
}

/// Finds what is held, and where: a later displacement counts over an earlier one, and over a [[fixed]].
void Loads::hold(const Scene& scene, const TetMesh& mesh) {
  held_.assign(rest_.size(), 0);
  std::vector<Vec3> moved(rest_.size(), Vec3::Zero());
  for (const FixedRegion& region : scene.fixed) {
    for (const int vertex : vertices_in(region, mesh)) held_[vertex] |= region.axes;
  }
  if (scene.blade() != nullptr) release_spares(mesh, held_);
  bool moves = false;
  for (const Load& load : scene.loads) {
    if (load.kind != Load::Kind::kDisplacement) continue;
    moves = true;
    for (const int vertex : vertices_in(load.region, mesh)) {
      held_[vertex] |= load.axes;
      for (int axis = 0; axis < 3; ++axis) {
        if ((load.axes >> axis & 1) != 0) moved[vertex][axis] = load.vector[axis];
      }
    }
  }
  for (std::size_t k = 0; k < mesh.mid_edges.size(); ++k) {
    const auto [a, b] = mesh.mid_edges[k];
    const std::size_t middle = static_cast<std::size_t>(mesh.corners()) + k;
    held_[middle] = held_[a] & held_[b];
    moved[middle] = 0.5 * (moved[a] + moved[b]);
  }
  motions_ = held_motions(scene, mesh, held_);
  if (moves || !motions_.empty()) moved_ = std::move(moved);
}

std::vector<Vec3> Loads::moved(double t) const {
  std::vector<Vec3> moved = moved_;
  for (const HeldMotion& held : motions_) {
    for (const auto& [node, direction] : held.nodes)
      moved[node] += displacement_at(held.motion, t) * direction;
  }
  return moved;
}

void Loads::put_held(double t, std::span<Vec3> x) const noexcept {
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((held_[i] >> axis & 1) != 0) x[i][axis] = rest_[i][axis] + moved_[i][axis];
    }
  }
  for (const HeldMotion& held : motions_) {
    const double displacement = displacement_at(held.motion, t);
    for (const auto& [node, direction] : held.nodes) x[node] += displacement * direction;
  }
}

std::vector<Loads::Face> Loads::faces_in(const Region& region, const TetMesh& mesh, const Surface& surface) {
  std::vector<char> inside(mesh.vertices.size(), 0);
  for (const int v : vertices_in(region, mesh)) inside[v] = 1;
  const auto tagged = region.surface_tag.empty() ? mesh.tagged_triangles.end()
                                                 : mesh.tagged_triangles.find(region.surface_tag);
  const auto is_in = [&](Triangle corners) {
    if (tagged == mesh.tagged_triangles.end())
      return std::ranges::all_of(corners, [&](int corner) { return inside[corner] != 0; });
    std::ranges::sort(corners);
    return std::ranges::binary_search(tagged->second, corners);
  };
  std::vector<Face> faces;
  for (std::size_t i = 0; i < surface.triangles.size(); i += static_cast<std::size_t>(surface.per_face)) {
    const Triangle* const parts = &surface.triangles[i];
    const bool entire = surface.per_face == 1;
    Face face{};
    for (std::size_t c = 0; c < 3; ++c) {
      face.corners[c] = surface.vertices[entire ? parts[0][c] : parts[c][0]];
      face.pushed[c] = surface.vertices[entire ? parts[0][c] : parts[3][c]];
    }
    if (is_in(face.corners)) faces.push_back(face);
  }
  if (faces.empty() && tagged != mesh.tagged_triangles.end())
    fail("{}: no triangle of \"{}\" is on the boundary of the body; tag its outside", region.where,
         region.surface_tag);
  if (faces.empty())
    fail("{}: no triangle of the boundary has all its corners in this region; make it larger", region.where);
  return faces;
}

std::vector<Loads::Face> Loads::movable_faces_in(const Region& region, const TetMesh& mesh,
                                                 const Surface& surface) const {
  std::vector<Face> faces = faces_in(region, mesh, surface);
  const auto is_held = [&](const Face& face) {
    return std::ranges::all_of(face.pushed, [&](int node) { return held_[node] == kAllAxes; });
  };
  if (std::ranges::all_of(faces, is_held))
    fail("{}: every vertex in this region is held, so that the load would move nothing", region.where);
  return faces;
}

/// Equally on the corners; of quadratic triangles on the middles of the edges, as their shape functions say.
void Loads::push(const Face& face, const Vec3& force, std::span<Vec3> f) {
  for (const int node : face.pushed) f[node] += force / 3;
}

void Loads::add_forces(std::span<const Vec3> x, std::span<Vec3> f) const {
  for (std::size_t i = 0; i < dead_.size(); ++i) f[i] += dead_[i];
  for (const Pressure& pressure : pressures_) {
    for (const Face& face : pressure.faces)
      push(face, -pressure.pascal * area_of(follows_ ? x : std::span<const Vec3>(rest_), face.corners), f);
  }
}

}  // namespace palpate::sim
