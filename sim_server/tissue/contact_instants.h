#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/config.h"
#include "sim_server/scene/deformation_settings.h"

namespace palpate::sim {

/// Number of instants within a step at which contact is solved, for a tissue in motion, along the path that
/// the tool really took. A force is held from one instant to the next, so what swings answers it late by half
/// of the time between them, and the error of the force falls as that time does.
struct ContactInstants {
  std::optional<int> instants{};  ///< [1, 1000]; absent: as many as the model thinks good

  static constexpr std::array<std::string_view, 1> kKeys{"instants"};
  static ContactInstants read(const Config& config);
  std::string to_text() const;
};

/// Returns how many the settings request; `otherwise` where they say nothing, and 1 where the model has none
/// (as in a scene that was not read from a file).
int instants_of(const DeformationSettings& settings, int otherwise);

}  // namespace palpate::sim
