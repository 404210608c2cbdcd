#pragma once
#include <string>

#include "sim_server/solvers/newton_matrix.h"

namespace palpate::sim {

/// What the parts of an implicit step take, ms of a reference machine: two cores of AMD's Zen 3 (2020), on
/// which the rates were measured (livers of 6 to 100 thousand tetrahedra; each part within a factor of 1.5).
/// Told from counts alone, so that what is bounded by them is the same on every machine; how long it takes
/// there `sim_server explain` measures.
struct StepCosts {
  double evaluation = 0;  ///< of the residual
  double solve = 0;       ///< with the factor, one right-hand side
  double factor = 0;      ///< A assembled and factored

  StepCosts(const Solid& solid, const NewtonMatrix& matrix);
  /// Columns of A^-1, three for each of so many nodes, at once.
  double columns(int nodes) const { return nodes > 0 ? (1.3 + 0.4 * nodes) * solve : 0; }
  /// One iteration of Newton's method.
  double iteration() const { return evaluation + solve; }
  /// The least step: the turns of the nodes, two iterations with contact at one node, the residual at its
  /// end, and a factor where none comes from the background.
  double least(bool background) const {
    return 2 * iteration() + 1.5 * evaluation + columns(1) + (background ? 0 : factor);
  }
  std::string to_text() const;
};

}  // namespace palpate::sim
