#include "sim_server/statics/moving_supports.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "common/error.h"
#include "sim_server/scene/held_motion.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {
namespace {

using Complex = std::complex<double>;

constexpr int kMostSteps = 2000;    // of the iteration; beyond, the scene is refused
constexpr double kSolved = 1e-12;   // relative residual, of the static answer
constexpr double kUnbounded = 1e4;  // of the static answer: farther swings nothing

/// The stiffness at rest of all nodes, none held; the lower triangle.
SparseMatrix total_stiffness(const Solid& solid) {
  StiffnessMatrix stiffness = solid.stiffness_matrix(FreeDofs(solid.nodes(), {}));
  solid.add_stiffness(solid.rest(), stiffness);
  return stiffness.lower();
}

/// -K_fd e over the unknowns, N/m.
Eigen::VectorXd pull_of(const HeldMotion& held, const SparseMatrix& stiffness, const FreeDofs& dofs) {
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(stiffness.rows()), pull(dofs.count);
  for (const auto& [node, e] : held.nodes) displacement.segment<3>(3 * static_cast<Eigen::Index>(node)) = e;
  const Eigen::VectorXd force = stiffness.selfadjointView<Eigen::Lower>() * displacement;
  for (std::size_t i = 0; i < dofs.first.size(); ++i) {
    if (dofs.first[i] >= 0)
      pull.segment<3>(dofs.first[i]) = -force.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  dofs.hold(pull);
  return pull;
}

/// X of (I + s K^-1 M) X = `statics` by conjugate orthogonal conjugate gradients (van der Vorst and Melissen
/// 1990, IEEE Trans. Magn. 26:706) with the product x^T M y, in which K^-1 M is symmetric: as many steps as
/// there are modes whose frequency is not far above that of the motion, and a few more. False where it does
/// not come to an end, or to one that cannot be.
bool swing(const Flexibility& flexibility, const Eigen::VectorXd& mass, Complex s, Eigen::VectorXcd& x) {
  const auto applied = [&](const Eigen::VectorXcd& p) -> Eigen::VectorXcd {
    Eigen::MatrixXd parts(p.size(), 2);
    parts << mass.cwiseProduct(p.real()), mass.cwiseProduct(p.imag());
    parts = flexibility(parts);
    return p + s * (parts.col(0) + Complex(0, 1) * parts.col(1));
  };
  const auto product = [&](const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
    return a.cwiseProduct(mass).cwiseProduct(b).sum();
  };
  const double statics = x.norm(), enough = kSolved * statics;
  Eigen::VectorXcd residual = x - applied(x), along = residual;
  Complex before = product(residual, residual);
  for (int i = 0; i < kMostSteps && residual.norm() > enough; ++i) {
    const Eigen::VectorXcd ahead = applied(along);
    const Complex step = before / product(along, ahead);
    x += step * along;
    residual -= step * ahead;
    const Complex now = product(residual, residual);
    along = residual + now / before * along;
    before = now;
  }
  return residual.norm() <= enough && x.norm() <= kUnbounded * statics;
}

SupportResponse response_of(const HeldMotion& held, const Eigen::VectorXcd& x, const FreeDofs& dofs) {
  SupportResponse response{held.motion, std::vector<Vec3>(dofs.first.size(), Vec3::Zero()),
                           std::vector<Vec3>(dofs.first.size(), Vec3::Zero())};
  for (const auto& [node, e] : held.nodes) response.along[node] = e;
  for (std::size_t i = 0; i < dofs.first.size(); ++i) {
    if (dofs.first[i] < 0) continue;
    response.along[i] += x.segment<3>(dofs.first[i]).real();
    response.ahead[i] = x.segment<3>(dofs.first[i]).imag();
  }
  return response;
}

}  // namespace

Eigen::VectorXd masses_of(const Solid& solid, const FreeDofs& dofs) {
  const std::vector<double> masses = solid.masses();
  Eigen::VectorXd of_unknowns(dofs.count);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (dofs.first[i] >= 0) of_unknowns.segment<3>(dofs.first[i]).setConstant(masses[i]);
  }
  return of_unknowns;
}

void SupportResponse::add(double t, std::span<Vec3> positions, std::span<Vec3> velocities) const noexcept {
  const double angle = angle_at(motion, t), omega = 2 * std::numbers::pi / motion.period;
  const double sine = motion.amplitude * std::sin(angle), cosine = motion.amplitude * std::cos(angle);
  for (std::size_t i = 0; i < along.size(); ++i) {
    positions[i] += sine * along[i] + cosine * ahead[i];
    velocities[i] += omega * (cosine * along[i] - sine * ahead[i]);
  }
}

std::vector<SupportResponse> support_responses(const ModelInputs& inputs, const Solid& solid,
                                               const FreeDofs& dofs, const Flexibility& flexibility,
                                               Following following) {
  std::vector<SupportResponse> responses;
  const auto motions = held_motions(inputs.scene, inputs.mesh, dofs.held);
  if (motions.empty()) return responses;
  inputs.progress(name_of(Stage::kSupports), 0);
  const auto& damping = inputs.scene.deformation.of<RayleighDamping>();
  const SparseMatrix stiffness = total_stiffness(solid);
  const Eigen::VectorXd mass = masses_of(solid, dofs);
  for (const HeldMotion& held : motions) {
    Eigen::VectorXcd x = flexibility(pull_of(held, stiffness, dofs)).col(0).cast<Complex>();
    const double w = 2 * std::numbers::pi / held.motion.period;
    const Complex s = Complex(-w * w, w * damping.mass) / Complex(1, w * damping.stiffness);
    if (following == Following::kSwinging && !swing(flexibility, mass, s, x))
      fail("{}: [[fixed.motion]]: at a period of {:g} s the tissue swings beyond all measure; {}", held.where,
           held.motion.period, "give it damping, or another period");
    responses.push_back(response_of(held, x, dofs));
  }
  return responses;
}

MovingSupports::MovingSupports(const ModelInputs& inputs, const std::vector<SupportResponse>& responses) {
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  for (const SupportResponse& all : responses) {
    SupportResponse& own = responses_.emplace_back(SupportResponse{all.motion, {}, {}});
    for (const int vertex : inputs.surface.vertices) {
      own.along.push_back(all.along[vertex]);
      own.ahead.push_back(all.ahead[vertex]);
    }
  }
  state_.positions = state_.velocities = rest_;
  advance(0);
}

FreeMotion MovingSupports::advance(double dt) noexcept {
  state_.time += dt;
  std::ranges::copy(rest_, state_.positions.begin());
  std::ranges::fill(state_.velocities, Vec3::Zero());
  for (const SupportResponse& response : responses_)
    response.add(state_.time, state_.positions, state_.velocities);
  return {state_.positions, state_.velocities};
}

std::size_t MovingSupports::bytes() const {
  return (2 * responses_.size() + 3) * rest_.size() * sizeof(Vec3);
}

}  // namespace palpate::sim
