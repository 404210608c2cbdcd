#include "sim_server/mesh/surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fmt/ranges.h>
#include <iterator>
#include <span>
#include <tuple>
#include <utility>

#include "common/error.h"

namespace palpate::sim {
namespace {

struct Face {
  Triangle sorted;          // the vertices, ascending: equal for the two sides of one face
  Triangle outward;         // the same vertices, outward from `tetrahedron`
  int tetrahedron, number;  // of its tetrahedron
};

std::vector<Face> sorted_faces(const TetMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tetrahedra.size());
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    const Tetrahedron& t = mesh.tetrahedra[i];
    for (int k = 0; k < 4; ++k) {
      const Triangle& corner = kOutwardFaces[static_cast<std::size_t>(k)];
      const Triangle outward{t[corner[0]], t[corner[1]], t[corner[2]]};
      Triangle sorted = outward;
      std::ranges::sort(sorted);
      faces.push_back({sorted, outward, static_cast<int>(i), k});
    }
  }
  std::ranges::sort(faces, [](const Face& a, const Face& b) {
    return std::tie(a.sorted, a.tetrahedron) < std::tie(b.sorted, b.tetrahedron);
  });
  return faces;
}

/// Returns which way round the face is, against its sorted vertices.
bool is_even(const Triangle& t) {
  return (t[0] < t[1]) + (t[1] < t[2]) + (t[2] < t[0]) == 2;
}

// Gives the vertices that `surface.triangles` names (mesh numbers) their surface numbers.
void number_vertices(Surface& surface) {
  std::vector<int>& vertices = surface.vertices;
  for (const Triangle& triangle : surface.triangles) {
    vertices.insert(vertices.end(), triangle.begin(), triangle.end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (Triangle& triangle : surface.triangles) {
    for (int& vertex : triangle) {
      vertex = static_cast<int>(std::ranges::lower_bound(vertices, vertex) - vertices.begin());
    }
  }
}

/// Each face in four, by the vertices in the middle of its edges.
std::vector<Triangle> in_four(const std::vector<Triangle>& faces, const TetMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(4 * faces.size());
  for (const auto& [a, b, c] : faces) {
    const int ab = mesh.middle(a, b), bc = mesh.middle(b, c), ca = mesh.middle(c, a);
    triangles.insert(triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return triangles;
}

}  // namespace

std::vector<std::array<int, 4>> face_neighbours(const TetMesh& mesh) {
  std::vector<std::array<int, 4>> across(mesh.tetrahedra.size(), {-1, -1, -1, -1});
  const std::vector<Face> faces = sorted_faces(mesh);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const Face &a = faces[i - 1], &b = faces[i];
    if (a.sorted != b.sorted) continue;
    across[static_cast<std::size_t>(a.tetrahedron)][static_cast<std::size_t>(a.number)] = b.tetrahedron;
    across[static_cast<std::size_t>(b.tetrahedron)][static_cast<std::size_t>(b.number)] = a.tetrahedron;
  }
  return across;
}

OuterFaces outer_faces(const TetMesh& mesh) {
  const std::vector<Face> faces = sorted_faces(mesh);
  OuterFaces found;
  for (auto first = faces.begin(); first != faces.end();) {
    const auto last =
        std::find_if(first, faces.end(), [&](const Face& f) { return f.sorted != first->sorted; });
    // Two tetrahedra on a face lie on its two sides, so they see it turned the other way round.
    const bool same_side = last - first == 2 && is_even(first->outward) == is_even((first + 1)->outward);
    if (last - first == 1) {
      found.triangles.push_back(first->outward);
    } else if (last - first > 2 || same_side) {
      OverlappingFace& overlap = found.overlaps.emplace_back();
      overlap.vertices = first->sorted;
      std::transform(first, last, std::back_inserter(overlap.tetrahedra),
                     [](const Face& face) { return face.tetrahedron; });
    }
    first = last;
  }
  return found;
}

std::string describe(const OverlappingFace& face) {
  constexpr std::size_t kShown = 6;  // tetrahedra: the message stays one line
  const auto shown = std::span(face.tetrahedra).first(std::min(kShown, face.tetrahedra.size()));
  return fmt::format(
      "the face of vertices {} belongs to {} tetrahedra ({}{}), but a solid has one on each side of a face",
      face.vertices, face.tetrahedra.size(), fmt::join(shown, ", "),
      shown.size() < face.tetrahedra.size() ? ", ..." : "");
}

Surface boundary_surface(const TetMesh& mesh) {
  OuterFaces faces = outer_faces(mesh);
  if (!faces.overlaps.empty())
    fail("mesh: {}; remove the tetrahedra that overlap", describe(faces.overlaps.front()));
  Surface surface;
  if (mesh.mid_edges.empty()) {
    surface.triangles = std::move(faces.triangles);
  } else {
    surface.triangles = in_four(faces.triangles, mesh);
    surface.per_face = 4;
  }
  number_vertices(surface);
  return surface;
}

}  // namespace palpate::sim
