#include "sim_server/explicit/region_in_motion.h"

namespace palpate::sim {
namespace {

/// Returns, of each vertex, whether it is one of a tetrahedron of which `chosen` says so.
std::vector<char> vertices_of(const TetMesh& mesh, const std::vector<char>& chosen) {
  std::vector<char> of_vertex(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < chosen.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      if (chosen[t] != 0) of_vertex[static_cast<std::size_t>(v)] = 1;
    }
  }
  return of_vertex;
}

}  // namespace

std::vector<char> RegionInMotion::vertices(const TetMesh& mesh) const {
  std::vector<char> chosen = removable;
  std::vector<char> moves = vertices_of(mesh, chosen);
  for (int layer = 0; layer < layers; ++layer) {
    for (std::size_t t = 0; t < chosen.size(); ++t) {
      for (const int v : mesh.tetrahedra[t]) chosen[t] |= moves[static_cast<std::size_t>(v)];
    }
    moves = vertices_of(mesh, chosen);
  }
  return moves;
}

}  // namespace palpate::sim
