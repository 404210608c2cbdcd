#pragma once
#include <array>
#include <string>
#include <string_view>

#include "common/config.h"

namespace palpate::sim {

/// Rayleigh damping: the damping matrix is mass M + stiffness K (Bathe 1996, section 9.3.3). A mode of
/// angular frequency w has the damping ratio (mass / w + stiffness w) / 2.
struct RayleighDamping {
  double mass = 10;         ///< `rayleigh_mass`, 1/s, [0, 1e4]
  double stiffness = 1e-4;  ///< `rayleigh_stiffness`, s, [0, 1]

  static constexpr bool kOfBody = true;
  static constexpr std::array<std::string_view, 2> kKeys{"rayleigh_mass", "rayleigh_stiffness"};
  static RayleighDamping read(const Config& config);
  std::string to_text() const;
};

}  // namespace palpate::sim
