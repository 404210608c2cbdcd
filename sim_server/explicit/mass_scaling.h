#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.h"
#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Mass added to the stiffest elements of a body that can be cut. The more, the fewer sub-steps, and the
/// later the tissue answers there.
struct AddedMass {
  std::optional<double> fraction{};  ///< `added_mass`, of the mass in motion, [0, 0.2]; absent: 0.01

  static constexpr std::array<std::string_view, 1> kKeys{"added_mass"};
  static AddedMass read(const Config& config);
  std::string to_text() const;
};

/// More mass for the stiffest elements of a body in explicit motion, so that a few slivers do not shorten its
/// sub-steps (selective mass scaling: Olovsson, Simonsson and Unosson 2005, Int. J. Numer. Meth. Engng
/// 63:1436, in its simplest form).
struct MassScaling {
  /// No body made of some of these elements has a higher frequency, rad/s: each element alone, with a quarter
  /// of its mass at each corner, has at most that, and Rayleigh's quotient of the body is a mean of theirs
  /// (Irons and Treharne 1971).
  double frequency = 0;
  std::vector<double> factors;  ///< (tetrahedra) of their masses, >= 1
  double added = 0;             ///< kg
  double fraction = 0;          ///< that is, of the mass in motion
};

/// Returns the lowest frequency that at most `fraction` of the body's mass, added, allows. `moves`: of each
/// vertex, not 0 where it is in motion; elements without any such do not count. Empty: all are. O(m log m),
/// some 10 us an element.
MassScaling scale_masses(const TetMesh& mesh, const Material& material, double fraction,
                         std::span<const char> moves = {});

/// Says for reports what so much more mass (of the mass in motion) does to the force.
std::string added_mass_text(double fraction);

/// The factor (>= 1) of its mass with which a tetrahedron alone has at most this frequency, rad/s.
double mass_factor_of(const TetMesh& mesh, std::size_t tetrahedron, const Material& material,
                      double frequency);

}  // namespace palpate::sim
