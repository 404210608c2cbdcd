#pragma once
#include <functional>
#include <vector>

#include "sim_server/deformation/deformation_model.h"
#include "sim_server/deformation/model_inputs.h"
#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

/// How places of a tissue answer to one [[fixed.motion]], once it has gone on for long: the motion's
/// displacement times `along`, and that of a quarter of a period later times `ahead`.
struct SupportResponse {
  SupportMotion motion;
  std::vector<Vec3> along, ahead;  ///< (n) m per m of the support

  /// Adds what it does to the places (n, m) and their velocities (n, m/s) at time `t` (s). No allocation.
  void add(double t, std::span<Vec3> positions, std::span<Vec3> velocities) const noexcept;
};

/// Whether a tissue follows its supports at once, or swings by its masses and the scene's Rayleigh damping.
enum class Following { kAtOnce, kSwinging };

/// Lumped mass of each unknown, kg.
Eigen::VectorXd masses_of(const Solid& solid, const FreeDofs& dofs);

/// K^-1 of columns of forces (N) on the unknowns: how they move, m.
using Flexibility = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;

/// How all nodes answer to each motion of the scene, linearised about rest. With the displacements split into
/// free ones u and prescribed ones d (Chopra 2012, Dynamics of Structures, section 9.7),
///   M u'' + alpha M u' + K_ff (u + beta u') = -K_fd (d + beta d'),
/// so that for d = Im(e exp(i w t)) the steady answer is u = Im(X exp(i w t)) with
///   (K_ff + s M) X = -K_fd e,   s = (i w alpha - w^2) / (1 + i w beta);
/// at once: s = 0 (Bathe 1996, section 4.2.2). Exact in time, whatever the step. Set-up only. Throws `Error`
/// where the tissue swings beyond all measure: without damping, at one of its own frequencies.
std::vector<SupportResponse> support_responses(const ModelInputs& inputs, const Solid& solid,
                                               const FreeDofs& dofs, const Flexibility& flexibility,
                                               Following following);

/// The surface of a tissue as its supports move it. A linear tissue under loads stands that much farther.
class MovingSupports {
 public:
  /// `responses`: of all nodes. At time 0.
  MovingSupports(const ModelInputs& inputs, const std::vector<SupportResponse>& responses);

  /// Goes on by `dt` (s). No allocation.
  FreeMotion advance(double dt) noexcept;
  /// Where that led the surface, m, and how fast it goes, m/s.
  std::span<const Vec3> positions() const { return positions_; }
  std::span<const Vec3> velocities() const { return velocities_; }
  double time() const { return time_; }  ///< s

  std::size_t bytes() const;

 private:
  std::vector<Vec3> rest_, positions_, velocities_;
  std::vector<SupportResponse> responses_;  // of surface vertices
  double time_ = 0;                         // s
};

}  // namespace palpate::sim
