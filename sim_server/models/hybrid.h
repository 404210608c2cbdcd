#pragma once
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "sim_server/client_model/slow_modes.h"
#include "sim_server/explicit/cuttable_motion.h"
#include "sim_server/tissue/estimated_memory.h"

namespace palpate::sim {

/// Extent of the part in motion, and modes of the condensed part.
struct HybridSettings {
  int condensed_modes = ClientModes::kDefault;  ///< of the condensed part, that swing, [0, 1000]
  int layers = 1;                               ///< of tetrahedra in motion around what can be cut, [0, 100]

  static constexpr std::array<std::string_view, 2> kKeys{"layers", "condensed_modes"};
  static HybridSettings read(const Config& config);
  std::string to_text() const;
};

/// Linear elastic tissue of which what can be cut is in motion, by tensor-mass, and the rest is condensed: a
/// large part computed beforehand, and a small one whose topology can change (Cotin, Delingette and Ayache
/// 2000, Vis. Comput. 16:437, section 5). See `CuttableMotion` and `CondensedPart`.
struct Hybrid {
  /// Throws `Error` as those, or where the scene has no [cutting].
  static std::unique_ptr<DeformationModel> make(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
};

}  // namespace palpate::sim
