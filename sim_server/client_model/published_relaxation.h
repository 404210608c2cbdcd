#pragma once
#include <vector>

#include "sim_server/client_model/slow_modes.h"

namespace palpate::sim {

/// Viscous memory of a tissue that relaxes, for clients that step its modes. For each published mode and term
/// it holds the delayed amplitude, z' = (q - z) / time; for each surface vertex and term the force psi in the
/// residual compliance (`SeriesStep::creep`). Both follow the recursion of `PronySeries`, of which z is a
/// projection. The residual compliance is quasi-static. One thread; only the constructor allocates.
class PublishedRelaxation {
 public:
  /// Nothing has been pressed yet. A surface vertex that moves in no mode is held, and does not creep.
  explicit PublishedRelaxation(const PublishedModes& modes);

  /// A step of `h` (s > 0) has ended with the published modes at `q`, under these loads.
  void advance(double h, const Eigen::VectorXd& q, std::span<const VertexLoad> loads) noexcept;
  /// Writes the memory at the end of the step in hand, if that ends so.
  void predict_tangent(double h, const Eigen::VectorXd& q, std::span<const VertexLoad> loads,
                       Eigen::MatrixXd& z, std::vector<Vec3>& psi) noexcept;
  std::size_t bytes() const;

 private:
  struct Memory {
    Eigen::VectorXd q;      // (published modes)
    Eigen::MatrixXd z;      // (published modes x terms)
    std::vector<Vec3> f;    // (surface vertices) N
    std::vector<Vec3> psi;  // (surface vertices x terms) N
  };
  void step(double h, const Eigen::VectorXd& q, std::span<const VertexLoad> loads, Memory& memory) noexcept;

  std::vector<Relaxation> terms_;
  std::vector<char> held_;   // of surface vertices
  std::vector<Vec3> loads_;  // of surface vertices, N
  Memory memory_, predicted_;
};

}  // namespace palpate::sim
