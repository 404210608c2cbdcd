#include "sim_server/models/hybrid.h"

#include <fmt/core.h>

#include "common/error.h"

namespace palpate::sim {
HybridSettings HybridSettings::read(const Config& config) {
  HybridSettings read;
  read.layers = static_cast<int>(config.integer("layers", {0, 100, "layers of tetrahedra"}, read.layers));
  read.condensed_modes =
      static_cast<int>(config.integer("condensed_modes", {0, 1000, "modes"}, read.condensed_modes));
  return read;
}

std::string HybridSettings::to_text() const {
  return fmt::format("layers = {}\ncondensed_modes = {}\n", layers, condensed_modes);
}

std::unique_ptr<DeformationModel> Hybrid::make(const ModelInputs& inputs) {
  if (!inputs.scene.cutting) fail("{}: model \"hybrid\" needs a [cutting] section", inputs.scene.source);
  const auto& settings = inputs.scene.deformation.of<HybridSettings>();
  return std::make_unique<CuttableMotion>(
      inputs, RegionInMotion{removable_tetrahedra(*inputs.scene.cutting, inputs.mesh), settings.layers,
                             settings.condensed_modes});
}

double Hybrid::estimated_bytes(const Scene& scene, const MeshCounts& counts) {
  const int bodies = published_bodies(scene) + 1;
  return tensors_bytes(counts) + bodies * body_bytes(counts, scene.material->element, 1);
}

}  // namespace palpate::sim
