#pragma once

namespace palpate::sim {

/// Settings of the motion of a body in time.
struct DynamicsSettings {
  double rayleigh_mass = 0;       ///< alpha, 1/s, [0, 1e4]
  double rayleigh_stiffness = 0;  ///< beta, s, [0, 10]
  bool second_order = false;      ///< BDF2 instead of backward Euler
  /// Method that solves A x = b: by a factor of the step's own, or by a factor made in the background, a new
  /// one every `refresh_steps`, that a quasi-Newton method corrects.
  enum class Solver { kDirect, kQuasiNewton };
  Solver solver = Solver::kDirect;
  int refresh_steps = 8;  ///< [1, 1000]
  /// Norm of the residual that columns of compliance made in the background may leave of three unit forces.
  /// They are of where the body was some steps before.
  double tolerance = 0;
  bool cut = false;    ///< tetrahedra may be removed (`Dynamics::remove`): no factor serves for ever
  bool flies = false;  ///< nothing need hold the body: it has mass
};

}  // namespace palpate::sim
