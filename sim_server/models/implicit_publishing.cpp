// What implicit steps tell clients of the motion: parts of Implicit.
#include "sim_server/models/implicit.h"

namespace palpate::sim {
namespace {

std::span<const double> numbers(const Eigen::VectorXd& all) {
  return {all.data(), static_cast<std::size_t>(all.size())};
}

}  // namespace

Mat3 Implicit::later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept {
  if (!published_) return Mat3::Zero();
  const Vec3 sum = sum_of(loads);
  Mat3 yields = published_->compliance(loads, seconds);
  for (const VertexLoad& a : loads) {
    for (const VertexLoad& b : loads) {
      if (dof_[a.vertex] < 0 || dof_[b.vertex] < 0 || columns_.slot[b.vertex] < 0) continue;
      yields -= fraction_of(a, sum) * fraction_of(b, sum) *
                columns_.values.block<3, 3>(dof_[a.vertex], 3 * columns_.slot[b.vertex]);
    }
  }
  return 0.5 * (yields + yields.transpose());
}

/// Returns where supports alone have led the body (nodes, m), and how fast it goes by them (m/s).
Implicit::Carried Implicit::carried() const {
  Carried carried{solid_.rest(), std::vector<Vec3>(solid_.rest().size(), Vec3::Zero())};
  for (const SupportResponse& response : responses_)
    response.add(supports_->time(), carried.positions, carried.velocities);
  return carried;
}

/// Returns the displacement from there, by unknowns, m: of the step as it will end, where the last loads
/// lead.
Eigen::VectorXd Implicit::displacement(std::span<const Vec3> from) const {
  const FreeDofs& dofs = dynamics_.dofs();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(dofs.count);
  if (loads_ != linearised_loads_) {
    add_response(loads_, 1, u);
    add_response(linearised_loads_, -1, u);
  }
  for (std::size_t node = 0; node < dofs.first.size(); ++node) {
    if (dofs.first[node] >= 0) u.segment<3>(dofs.first[node]) += dynamics_.position()[node] - from[node];
  }
  return u;
}

/// The step has ended where it stands, under the last loads.
void Implicit::store() {
  relaxation_->advance(period_, published_->amplitudes(numbers(displacement(solid_.rest()))), loads_);
}

/// Reads the modes of the step as it will end.
void Implicit::read_modes(ModalMotion& state) {
  const FreeDofs& dofs = dynamics_.dofs();
  const auto [from, along] = carried();
  const Eigen::VectorXd u = displacement(from), none = Eigen::VectorXd::Zero(dofs.count);
  Eigen::VectorXd speed = none;
  for (std::size_t node = 0; node < dofs.first.size(); ++node) {
    const int first = dofs.first[node];
    if (first >= 0)
      speed.segment<3>(first) = dynamics_.velocity_at(node, from[node] + u.segment<3>(first)) - along[node];
  }
  published_->begin(numbers(u), numbers(speed), numbers(none), 0);
  published_->advance(0, loads_, state.q, state.v);
  if (relaxation_)
    relaxation_->predict_tangent(period_, published_->amplitudes(numbers(displacement(solid_.rest()))),
                                 loads_, state.z, state.psi);
}

void Implicit::residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  published_->residual_compliance(vertices, patch);
}

}  // namespace palpate::sim
