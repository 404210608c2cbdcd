#include "sim_server/deformation/hybrid.h"

#include <algorithm>
#include <fmt/core.h>

#include "common/error.h"

namespace palpate::sim {
namespace {

/// Of each vertex, whether it is one of a tetrahedron of which `chosen` says so.
std::vector<char> vertices_of(const TetMesh& mesh, const std::vector<char>& chosen) {
  std::vector<char> of_vertex(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < chosen.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      if (chosen[t] != 0) of_vertex[static_cast<std::size_t>(v)] = 1;
    }
  }
  return of_vertex;
}

/// Of each vertex, whether it is in motion.
std::vector<char> in_motion(const ModelInputs& inputs, int layers) {
  const TetMesh& mesh = inputs.mesh;
  std::vector<char> chosen = removable_tetrahedra(*inputs.scene.cutting, mesh);
  std::vector<char> moves = vertices_of(mesh, chosen);
  for (int layer = 0; layer < layers; ++layer) {
    for (std::size_t t = 0; t < chosen.size(); ++t) {
      for (const int v : mesh.tetrahedra[t]) chosen[t] |= moves[static_cast<std::size_t>(v)];
    }
    moves = vertices_of(mesh, chosen);
  }
  return moves;
}

}  // namespace

HybridSettings HybridSettings::read(const Config& config) {
  HybridSettings read;
  read.layers = static_cast<int>(config.integer("layers", {0, 100, "layers of tetrahedra"}, read.layers));
  read.rest_modes = static_cast<int>(config.integer("rest_modes", {0, 1000, "modes"}, read.rest_modes));
  return read;
}

std::string HybridSettings::to_text() const {
  return fmt::format("layers = {}\nrest_modes = {}\n", layers, rest_modes);
}

std::unique_ptr<DeformationModel> Hybrid::make(const ModelInputs& inputs) {
  if (!inputs.scene.cutting) fail("{}: model \"hybrid\" needs a [cutting] section", inputs.scene.source);
  const auto& settings = inputs.scene.deformation.of<HybridSettings>();
  return std::make_unique<CuttableMotion>(inputs, in_motion(inputs, settings.layers), settings.rest_modes);
}

double Hybrid::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  return tensors_bytes(counts) + body_bytes(counts, scene.material->element, 1);
}

}  // namespace palpate::sim
