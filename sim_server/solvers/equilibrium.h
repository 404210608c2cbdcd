#pragma once
#include <functional>
#include <string>

#include "sim_server/elasticity/solid.h"
#include "sim_server/sparse/sparse_cholesky.h"

namespace palpate::sim {

/// Loads on a body at rest.
struct StaticLoad {
  /// Forces on the nodes (N) of a body at `x` (nodes, m); they may follow it.
  std::function<void(std::span<const Vec3> x, std::span<Vec3> f)> forces = {};
  std::vector<HeldAxes> held = {};  ///< (nodes)
  /// (nodes) From rest to where each is held, along those axes, m; empty: at rest.
  std::vector<Vec3> moved = {};
  /// (nodes) The initial guess, with what is held where it shall be, m; empty: at rest.
  std::vector<Vec3> start = {};
};

/// Settings of the search for an equilibrium.
struct EquilibriumSettings {
  double tolerance = 1e-12;  ///< relative residual at which an increment ends
  double rounding = 1e-7;    ///< the same, where one more iteration does not lessen it
  int max_newton = 60;       ///< per increment
  int max_halvings = 12;     ///< of the load, where Newton's method fails
};

/// Equilibrium of a body.
struct Equilibrium {
  std::vector<Vec3> x;                 ///< (nodes) m
  int increments = 0, iterations = 0;  ///< of the load; Newton steps in all
  double residual = 0;                 ///< relative: its norm, as a share of all forces that act
};

/// The static equilibrium f_int(x) = f_ext(x) by Newton's method with a line search, in one increment of the
/// load, or as many as it takes. Where the tangent stiffness is not positive definite, as much inertia is
/// added as makes it so (`NewtonMatrix`). Throws `Error`, beginning with `where`, when the
/// fixed nodes do not hold the body or no stable equilibrium is found. Reports its increments.
Equilibrium find_equilibrium(const Solid& solid, const StaticLoad& load, const std::string& where,
                             const std::function<void(double fraction)>& progress = {},
                             const EquilibriumSettings& settings = {});

}  // namespace palpate::sim
