#pragma once
#include <optional>
#include <vector>

#include "common/relaxation.h"
#include "common/types.h"

namespace palpate::sim {

/// Which energy a deformation costs: see `laws.h`.
enum class ElasticLaw { kLinear, kCorotational, kStVenantKirchhoff, kNeoHookean };

/// Interpolation of displacement and volume inside a tetrahedron: see `solid.h`.
enum class ElementKind { kLinear, kNodalPressure, kQuadratic };

/// Fibres along one direction everywhere, which stiffen the tissue along it.
struct Fibres {
  Vec3 direction;  ///< unit, mesh frame at rest
  double modulus;  ///< Young's modulus along them, beyond that of the rest, Pa, (0, 1e12]
};

/// Tissue. Liver, the values of configs/scenes/liver.toml: see there for their sources.
struct Material {
  double young_modulus = 10e3;  ///< E, Pa, (0, 1e12]; of a tissue that relaxes: at once
  double poisson_ratio = 0.45;  ///< nu, [0, 0.5)
  double density = 1060;        ///< kg/m^3, (0, 1e5]
  ElasticLaw law = ElasticLaw::kLinear;
  ElementKind element = ElementKind::kLinear;
  std::optional<Fibres> fibres{};
  std::vector<Relaxation> relaxations{};

  /// Linear law, linear elements, nothing else.
  bool is_plain() const {
    return law == ElasticLaw::kLinear && element == ElementKind::kLinear && !fibres && relaxations.empty();
  }
  /// Linear law, any element, with fibres or without: stress goes with strain, and that is all.
  bool is_linear() const { return law == ElasticLaw::kLinear && relaxations.empty(); }
  /// True if linear elements are much too stiff for it, as it hardly changes its volume (Hughes 2000, The
  /// Finite Element Method, section 4.4). A thick sphere under pressure is too stiff by half at nu 0.499, ten
  /// times at 0.4999.
  bool locks() const { return element == ElementKind::kLinear && poisson_ratio >= 0.49; }
  /// First Lame parameter, Pa.
  double lame_lambda() const {
    return young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  }
  /// Shear modulus (second Lame parameter), Pa.
  double lame_mu() const { return young_modulus / (2 * (1 + poisson_ratio)); }
};

}  // namespace palpate::sim
