#pragma once
#include <vector>

#include "sim_server/deformation/slow_modes.h"

namespace palpate::sim {

/// What a tissue that relaxes remembers besides where its modes stand, for clients that step it: of each told
/// mode and term what follows its amplitude late, z' = (q - z) / time, and of each surface vertex and term
/// the force psi that what is left of the compliance has not forgotten (`SeriesStep::creep`). Both by the
/// recursion of `PronySeries`, of which z is a projection; psi takes all but the told modes for quasi-static.
/// One thread; only the constructor allocates.
class ToldRelaxation {
 public:
  /// Nothing has been pressed yet. A surface vertex that moves in no mode is held, and does not creep.
  explicit ToldRelaxation(const SlowModes& modes);

  /// A step of `h` (s > 0) has ended with the told modes at `q`, under these loads.
  void advance(double h, const Eigen::VectorXd& q, std::span<const NodalLoad> loads) noexcept;
  /// What it will remember, if the step in hand ends so.
  void foresee(double h, const Eigen::VectorXd& q, std::span<const NodalLoad> loads, Eigen::MatrixXd& z,
               std::vector<Vec3>& psi) noexcept;
  std::size_t bytes() const;

 private:
  struct Memory {
    Eigen::VectorXd q;      // (told modes)
    Eigen::MatrixXd z;      // (told modes x terms)
    std::vector<Vec3> f;    // (surface vertices) N
    std::vector<Vec3> psi;  // (surface vertices x terms) N
  };
  void step(double h, const Eigen::VectorXd& q, std::span<const NodalLoad> loads, Memory& memory) noexcept;

  std::vector<Relaxation> terms_;
  std::vector<char> held_;   // of surface vertices
  std::vector<Vec3> loads_;  // of surface vertices, N
  Memory memory_, foreseen_;
};

}  // namespace palpate::sim
