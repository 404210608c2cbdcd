#pragma once
/// The stages of a set-up, as progress lines and reports call them.
#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

namespace palpate::sim {

/// Gets the progress of set-up: what is being done, which fraction of it (0 to 1). Called at the beginning of
/// each stage at least; with 1 at the end of the last, so that stages cover the whole set-up (`SetupTimes`).
using Progress = std::function<void(std::string_view what, double fraction)>;

/// Stages of a set-up, in no particular order. The contact of each tool is a further stage, named in
/// `simulation.h`.
enum class Stage {
  kMesh,
  kSurface,
  kStiffness,
  kFactor,
  kLoadedShape,
  kSupports,
  kModes,
  kTensors,
  kFrequency,
  kCompliance,
  kCondensed,
};

/// Name of a stage, and the part of the program that it makes.
struct StageRow {
  Stage stage;
  std::string_view name, part;
};
inline constexpr std::array kStages{
    StageRow{Stage::kMesh, "reading the mesh", "mesh"},
    StageRow{Stage::kSurface, "extracting the surface", "surface"},
    StageRow{Stage::kStiffness, "assembling the stiffness matrix", "stiffness matrix"},
    StageRow{Stage::kFactor, "factoring the stiffness matrix", "its factor"},
    StageRow{Stage::kLoadedShape, "finding the shape under its loads", "finding the shape under its loads"},
    StageRow{Stage::kSupports, "computing moving supports", "moving supports"},
    StageRow{Stage::kModes, "finding the modes of vibration", "modes"},
    StageRow{Stage::kTensors, "assembling the tensors", "tensors"},
    StageRow{Stage::kFrequency, "finding the highest frequency", "tensors"},
    StageRow{Stage::kCompliance, "computing compliance", "compliance"},
    StageRow{Stage::kCondensed, "condensing what is not in motion", "condensed part"},
};

constexpr const StageRow& row_of(Stage stage) {
  return *std::ranges::find(kStages, stage, &StageRow::stage);
}
constexpr std::string_view name_of(Stage stage) {
  return row_of(stage).name;
}

}  // namespace palpate::sim
