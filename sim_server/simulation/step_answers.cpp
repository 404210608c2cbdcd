// What a step tells of a tool beyond its force, where somebody asks: parts of Simulation.
#include <algorithm>
#include <array>

#include "sim_server/client_model/published_surface.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {
namespace {

constexpr double kNearby = 2;         // of the tool radius: how far off a surface is published
constexpr double kProbeDepth = 0.04;  // of the tool radius: how deep to ask how stiff it is
constexpr double kFastestTool = 10;   // m/s: faster is an encoder that jumped, which others do not feel
constexpr double kMaxAhead = 2e-3;    // m; without a bound, fast tools fare worse

}  // namespace

/// Couples the tools: how they move the surface under each other, if any client requests it.
void Simulation::couple(std::span<const ToolInput> inputs) {
  status_.coupled = coupling_ && tissue_.traits.publishes_tangents &&
                    std::ranges::any_of(inputs, [](const ToolInput& input) {
                      return input.pose && (input.request.at_tool || input.request.ahead);
                    });
  if (!status_.coupled) return;
  std::array<Vec3, kMaxTools> velocities;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    differentiate(i);
    const bool known = inputs[i].pose && inputs[i].v_W.norm() <= kFastestTool;
    velocities[i] = known ? inputs[i].v_W : Vec3(Vec3::Zero());
  }
  coupling_->update(tissue_, tools_, std::span(velocities).first(tools_.size()));
}

/// Linearises at `there`, with the places of the other tools held, not their loads: they yield, and the
/// surface comes along. The tangent is symmetric, as on the wire.
Linearisation Simulation::linearise_coupled(std::size_t tool, const Vec3& p_W, const Vec3& there,
                                            const ToolForce* known) {
  const Mat3* const relative = status_.coupled ? &coupling_->relative_motion(tool) : nullptr;
  Linearisation l = linearise(tool, relative ? Vec3(p_W + *relative * (there - p_W)) : there, known);
  const Mat3 k = relative ? Mat3(l.tangent * *relative) : l.tangent;
  l.tangent = 0.5 * (k + k.transpose());  // of friction, the part that stores energy
  l.p_W = there;
  return l;
}

/// Adds what was requested of this tool beyond its force.
void Simulation::add_wanted(std::size_t tool, const ToolInput& input) {
  ToolAnswer& answer = answers_[tool];
  if (!input.pose || answer.flagged) return;
  const Vec3& p_W = input.pose->p_W;
  ToolRequest request = input.request;
  // Nor of the tissue alone where the force of a blade is rendered, too.
  if (!tissue_.traits.publishes_tangents || (cut_ && cut_->resists(tool))) {
    request.at_tool = false;
    request.ahead.reset();
  }
  if (request.at_tool || request.ahead) {
    answer.surface_v_W =
        tools_[tool].surface_velocity(p_W, tissue_, tissue_.velocities, tissue_.loads_of(tool));
    if (status_.coupled && coupling_->moved_by_others(tool)) answer.others = coupling_->others(tool);
  }
  if (request.at_tool) answer.at_tool = linearise_coupled(tool, p_W, p_W, &answer);
  // Where contact is solved several times a step, the tool would be there within one of them: a jump that
  // tissue with inertia answers otherwise than the motion that is expected. Then the tangent must do.
  if (request.ahead && instants() == 1) {
    const Vec3 v_W = answer.others ? Vec3(answer.surface_v_W + answer.others->v_W) : answer.surface_v_W;
    const Vec3 motion = request.ahead->seconds * (request.ahead->v_W - v_W);  // on the organ as it stands
    Vec3 there = p_W + std::min(1.0, kMaxAhead / motion.norm()) * motion;
    if (!there.allFinite()) there = p_W;
    answer.ahead = linearise_coupled(tool, p_W, there, nullptr);
  }
  if (!request.surface_shift || tools_[tool].holds()) return;  // what is grasped is no matter of contact
  if (cut_ && !(cut_->published() && cut_->published()->covers(p_W))) return;
  answer.surface_shift_W = surface_shift(tool, p_W);
  if (published_modes() != nullptr) publish_modes(tool);
}

void Simulation::publish_modes(std::size_t tool) {
  tissue_.traits.client->read_modes(published_.modes);
  answers_[tool].modes = &published_.modes;
  if (tools_.size() == 1) return;
  Eigen::VectorXd& driven = tracks_[tool].modal_loads;
  driven.setZero();
  for (std::size_t other = 0; other < tools_.size(); ++other) {
    if (other == tool) continue;
    published_modes()->add_drive(tissue_.loads_of(other), driven);
  }
  answers_[tool].modal_loads = &driven;
}

Linearisation Simulation::linearise(std::size_t tool, const Vec3& p_W, const ToolForce* known) {
  ToolContact& contact = tools_[tool];
  if (!contact.placed()) return {};
  const ToolTissue tissue = tissue_.touched_by(tool);
  const ToolForce there = known != nullptr ? *known : contact.probe(p_W, tissue);
  if (there.contacts > 0) {
    const double size = there.force.norm();
    return {p_W, there.force, there.tangent, size > 0 ? Vec3(there.force / size) : Vec3(Vec3::Zero()), 0};
  }
  const SurfacePlane plane = contact.nearest(p_W, tissue_);
  if (plane.gap > kNearby * contact.radius()) return {};
  // A little beyond the first touch, so that it is known how stiff the surface is.
  const Vec3 touching = p_W - (plane.gap + kProbeDepth * contact.radius()) * plane.normal_W;
  return {p_W, Vec3::Zero(), contact.probe(touching, tissue).tangent, plane.normal_W, plane.gap};
}

std::optional<double> Simulation::gap(std::size_t tool) const noexcept {
  if (!tools_[tool].placed() || tools_[tool].touchable().empty()) return {};
  return tools_[tool].nearest(tools_[tool].place(), tissue_).gap;
}

Vec3 Simulation::surface_shift(std::size_t tool, const Vec3& p_W) {
  const ToolTissue tissue = tissue_.touched_by(tool);
  const int vertex = tools_[tool].nearest_vertex(p_W, tissue_);
  if (vertex < 0) return Vec3::Zero();  // all that it could touch has been cut away
  if (published_modes() == nullptr) return tissue.free()[vertex] - organ_.rest[vertex];
  const Vec3 carried =
      tissue_.carried.empty() ? Vec3(Vec3::Zero()) : Vec3(tissue_.carried[vertex] - organ_.rest[vertex]);
  return carried + residual_shift(tool, vertex);
}

/// Returns how far the other tools push a vertex, but for what they do by the published modes, m.
Vec3 Simulation::residual_shift(std::size_t tool, int vertex) {
  Vec3 shift = Vec3::Zero();
  for (std::size_t other = 0; other < tools_.size(); ++other) {
    if (other == tool) continue;
    for (const VertexLoad& load : tissue_.loads_of(other)) {
      tissue_.traits.client->residual_compliance(std::array{vertex, load.vertex}, pair_);
      shift += pair_.compliance.block<3, 3>(0, 3) * load.force;
    }
  }
  return shift;
}

}  // namespace palpate::sim
