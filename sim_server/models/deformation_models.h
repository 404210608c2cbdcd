#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <vector>

#include "common/config.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/estimated_memory.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

/// The materials that a model is for, each with those before it.
enum class Materials {
  kNone,    ///< it passes over a plain material, and counts as one that does not deform
  kPlain,   ///< law "linear", element "p1", no fibres
  kLinear,  ///< law "linear" with any element and fibres
  kAny,     ///< any law, element, fibres and relaxation, and any [[load]]
};

/// Row of the registry: a new model is one file and one row, and nothing outside this folder knows its name.
/// What a row does by functions is filled in by `row_of` in `deformation_models.cpp` from the model's class
/// and its settings.
struct DeformationModelRow {
  std::string_view name;
  std::string_view summary;
  Materials materials = Materials::kNone;
  bool moves = false;  ///< the organ has inertia, or goes as one piece; false: at rest at every instant
  bool flies = false;  ///< nothing need hold the body: it has mass
  bool cuts = false;   ///< tissue can be removed and separated while tools touch it (`remove`, `part`)
  bool needs_cutting = false;  ///< only of scenes with [cutting]
  bool condenses = false;      ///< all that its set-up takes long for can be condensed (`Condensed`)
  /// Parts that other models build and this one does not need, for `explain`.
  struct Unneeded {
    std::string_view what, note;
  };
  std::optional<Unneeded> unneeded{};

  std::unique_ptr<DeformationModel> (*make)(const ModelInputs&) = nullptr;
  /// Bytes that its elements and matrices will take; of a scene with a [material].
  double (*estimated_bytes)(const Scene&, const MeshCounts&) = nullptr;
  /// The keys of [deformation] that it takes besides `model`; reads them, in their ranges; and as text again.
  std::vector<std::string_view> (*keys)() = nullptr;
  void (*read)(const Config&, DeformationSettings&) = nullptr;
  std::string (*to_text)(const DeformationSettings&) = nullptr;
  /// Returns as text the settings that say what the body is (`kOfBody`), not how exactly its motion is found.
  std::string (*body_to_text)(const DeformationSettings&) = nullptr;
  bool (*has_settings)(std::type_index) = nullptr;

  bool deforms() const { return materials != Materials::kNone; }
  /// True if it precomputes the compliance of all that tools reach.
  bool keeps_compliance() const { return deforms() && materials != Materials::kAny; }
  /// True if it reads settings of this type, such as `ImplicitSettings`.
  template <class Settings>
  bool takes() const {
    return has_settings(typeid(Settings));
  }
};
std::span<const DeformationModelRow> deformation_models();
/// Returns the models that need no [cutting].
std::span<const DeformationModelRow> models_without_cutting();

/// The row of `settings.model`. Throws `Error` where there is none.
const DeformationModelRow& model_of(const DeformationSettings& settings);

/// "quasi_static", or "tensor_mass, implicit": names of the models that can.
template <class Can>
std::string models_that(const Can& can) {
  std::string names;
  for (const DeformationModelRow& row : deformation_models()) {
    if (can(row)) names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  return names;
}

/// `[deformation]`: the model and its settings. Throws `Error`, of a key of other models with their names.
DeformationSettings read_deformation(const Config& config);
/// Returns the section as text.
std::string to_text(const DeformationSettings& settings);

}  // namespace palpate::sim
