#pragma once
#include <span>
#include <vector>

#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

/// Viscosity of a body by a Prony series, as Simo (1987, Comput. Meth. Appl. Mech. Engng 60:153) has it for
/// large strains, with the recursion of Taylor, Pister and Goudreau (1970, Int. J. Numer. Meth. Engng 2:45),
/// which is exact where the elastic stress S0 changes evenly within each step. With g_i and tau_i the share
/// and time of each term, and a prime for the end of a step of length h,
///   h_i' = exp(-h / tau_i) h_i + g_i gamma_i (S0' - S0),   gamma_i = (1 - exp(-h / tau_i)) tau_i / h,
///   S'   = (1 - sum g_i) S0' + sum h_i'.
/// Stresses are of one kind, second Piola-Kirchhoff (Cauchy of the linear law), in Pa, one at each quadrature
/// point. It begins without any stress. After construction nothing allocates.
class PronySeries {
 public:
  /// Makes room for so many quadrature points. Without terms it does nothing, and holds nothing.
  PronySeries(std::span<const Relaxation> terms, std::size_t points);

  bool empty() const { return terms_.empty(); }
  /// Begins a step of `h` (s > 0). May be called again before the step ends.
  void begin(double h);
  /// Ends it at the elastic stresses `elastic` (points). A point whose stress is no number, as of an element
  /// that is flat, keeps what it has.
  void end(std::span<const Mat3> elastic);
  /// Returns the viscosity of the step begun last: S' = scale S0' + memory, whatever S0' will be. Valid until
  /// the next begins.
  Viscosity viscosity() const { return {scale_, memory_}; }
  std::size_t bytes() const;

 private:
  std::vector<Relaxation> terms_;
  double h_ = 0;
  double scale_ = 1;                             // 1 + sum g_i (gamma_i - 1)
  std::vector<Mat3> elastic_, memory_, stress_;  // S0; S' - scale S0'; h_i, (terms x points)
};

}  // namespace palpate::sim
