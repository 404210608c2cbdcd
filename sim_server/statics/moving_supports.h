#pragma once
#include <functional>
#include <vector>

#include "sim_server/elasticity/solid.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

/// Steady response of places of a tissue to one [[fixed.motion]]: the motion's displacement times `along`,
/// and that of a quarter of a period later times `ahead`.
struct SupportResponse {
  SupportMotion motion;
  std::vector<Vec3> along, ahead;  ///< (n) m per m of the support

  /// Adds what it does to the places (n, m) and their velocities (n, m/s) at time `t` (s). No allocation.
  void add(double t, std::span<Vec3> positions, std::span<Vec3> velocities) const noexcept;
};

/// Response to supports: at once, or with masses and the scene's Rayleigh damping.
enum class Following { kAtOnce, kSwinging };

/// Lumped mass of each unknown, kg.
Eigen::VectorXd masses_of(const Solid& solid, const FreeDofs& dofs);

/// K^-1 of columns of forces (N) on the unknowns: how they move, m.
using Flexibility = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;

/// Returns the steady response of all nodes to each motion of the scene, linearised about rest. With the
/// displacements split into free ones u and prescribed ones d (Chopra 2012, Dynamics of Structures, section
/// 9.7),
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
  /// Positions (m) and velocities (m/s) of the surface after the last `advance`.
  std::span<const Vec3> positions() const { return state_.positions; }
  std::span<const Vec3> velocities() const { return state_.velocities; }
  double time() const { return state_.time; }  ///< s

  struct State {
    std::vector<Vec3> positions, velocities;  ///< of the surface, m, m/s
    double time = 0;                          ///< s
  };
  const State& state() const { return state_; }
  void set_state(const State& state) { state_ = state; }

  std::size_t bytes() const;

 private:
  std::vector<Vec3> rest_;
  std::vector<SupportResponse> responses_;  // of surface vertices
  State state_;
};

}  // namespace palpate::sim
