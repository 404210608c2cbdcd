#pragma once

namespace palpate::sim {

/// Isotropic elastic tissue. Liver, the values of configs/scenes/liver.toml: see there for their sources.
struct Material {
  double young_modulus = 10e3;  ///< E, Pa, (0, 1e12]
  double poisson_ratio = 0.45;  ///< nu, [0, 0.5)
  double density = 1060;        ///< kg/m^3, (0, 1e5]

  /// First Lame parameter, Pa.
  double lame_lambda() const {
    return young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  }
  /// Shear modulus (second Lame parameter), Pa.
  double lame_mu() const { return young_modulus / (2 * (1 + poisson_ratio)); }
};

}  // namespace palpate::sim
