#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.h"
#include "common/contact/contact_solver.h"
#include "common/relaxation.h"
#include "sim_server/solvers/vibration_modes.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {

/// Setting of models that need no modes themselves.
struct ClientModes {
  static constexpr int kDefault = 40;  ///< as `modes` of `reduced`
  int modes = kDefault;  ///< `client_modes`: largest number of published ones, [0, kMaxPublishedModes]

  static constexpr std::array<std::string_view, 1> kKeys{"client_modes"};
  static ClientModes read(const Config& config);
  std::string to_text() const;
};

/// State of the published modes.
struct ModalMotion {
  Eigen::VectorXd q, v;  ///< (k) amplitudes, m sqrt(kg), and rates, m sqrt(kg)/s
  Eigen::MatrixXd z{};   ///< (k x terms) amplitudes that follow q late, of a tissue that relaxes, m sqrt(kg)
  std::vector<Vec3> psi{};  ///< (surface vertices x terms) viscous memory of the residual compliance, N
};

/// The slowest modes of a linear tissue, as its surface moves in them:
///   q_k'' + damping_k q_k' + w_k^2 q_k = shapes_k^T f.
/// What a client needs to know of a tissue that swings, besides how compliant all the rest of it is: a
/// compliance alone, however fresh, has no memory. Of a tissue that relaxes, by the same series everywhere,
/// what stands there is how stiff it is at once, and
///   q_k'' + damping_k q_k' + w_k^2 (q_k - sum_j fraction_j z_kj) = shapes_k^T f,   z_kj' = (q_k - z_kj) /
///   time_j.
struct PublishedModes {
  Eigen::VectorXd frequencies;  ///< (k) w, rad/s, ascending
  Eigen::VectorXd damping;      ///< (k) 1/s
  Eigen::MatrixXd shapes;       ///< (3 surface vertices x k), 1/sqrt(kg): of unit mass
  /// The first so many are those that a client can follow (`common/damped_mode.h`).
  Eigen::Index published = 0;
  std::vector<Relaxation> relaxations{};  ///< at most `kMostRelaxations`

  /// `modes`: over the unknowns; a surface vertex begins at `first` there, or -1: held.
  PublishedModes(const VibrationModes& modes, std::span<const int> first, const RayleighDamping& damping);

  /// Subtracts sum_k yields_k shapes_k shapes_k^T at these surface vertices from the compliance of `patch`,
  /// which is one in which mode k gives way by `yields` (m^2 kg/N). 9 k multiplications a pair of vertices;
  /// no allocation.
  void take_out(std::span<const int> vertices, const Eigen::VectorXd& yields,
                ContactPatch& patch) const noexcept;
  /// Adds how hard these loads drive each of the published modes, N/sqrt(kg).
  void add_drive(std::span<const VertexLoad> loads, Eigen::Ref<Eigen::VectorXd> drive) const noexcept;
  /// Returns the static compliance of each published mode, 1 / w^2, and 0 for the others.
  Eigen::VectorXd published_at_rest() const;
  /// Returns how much more (m/N) the first `end` modes yield to a force held for `seconds` than to one held
  /// for `before` (s), for the surface that bears these loads as one piece.
  Mat3 yield_(std::span<const VertexLoad> loads, double seconds, double before,
              Eigen::Index end) const noexcept;

  std::size_t bytes() const {
    return static_cast<std::size_t>(shapes.size() + 2 * frequencies.size()) * sizeof(double);
  }
};

}  // namespace palpate::sim
