#include "sim_server/simulation/step_publisher.h"

#include <algorithm>
#include <array>

#include "sim_server/client_model/published_surface.h"

namespace palpate::sim {
namespace {

constexpr double kNearby = 2;         // of the tool radius: how far off a surface is published
constexpr double kProbeDepth = 0.04;  // of the tool radius: how deep to ask how stiff it is
constexpr double kFastestTool = 10;   // m/s: faster is an encoder that jumped, which others do not feel
constexpr double kMaxAhead = 2e-3;    // m; without a bound, fast tools fare worse

}  // namespace

StepPublisher::StepPublisher(std::size_t tools, std::size_t vertices, std::size_t most_loads)
    : by_others_(tools) {
  if (tools > 1) coupling_.emplace(tools, vertices, most_loads);
}

void StepPublisher::reserve(const PublishedModes* modes, std::size_t vertices) {
  if (modes == nullptr) return;
  modes_.q = modes_.v = Eigen::VectorXd::Zero(modes->published);
  modes_.z.setZero(modes->published, static_cast<Eigen::Index>(modes->relaxations.size()));
  modes_.psi.assign(vertices * modes->relaxations.size(), Vec3::Zero());
  std::ranges::fill(by_others_, modes_.q);
  pair_.reserve(2, 0);
  pair_.free.resize(2);
}

void StepPublisher::couple(std::span<const ToolInput> inputs, OrganAfterStep organ) {
  coupled_ = coupling_ && organ.tissue.traits.publishes_tangents &&
             std::ranges::any_of(inputs, [](const ToolInput& input) {
               return input.pose && (input.request.at_tool || input.request.ahead);
             });
  if (!coupled_) return;
  std::array<Vec3, kMaxTools> velocities;
  for (std::size_t i = 0; i < organ.tools.size(); ++i) {
    organ.tools.differentiate(i, organ.tissue);
    const bool known = inputs[i].pose && inputs[i].v_W.norm() <= kFastestTool;
    velocities[i] = known ? inputs[i].v_W : Vec3(Vec3::Zero());
  }
  coupling_->update(organ.tissue, organ.tools.all(), std::span(velocities).first(organ.tools.size()));
}

/// Linearises at `there`, with the places of the other tools held, not their loads: they yield, and the
/// surface comes along. The tangent is symmetric, as on the wire.
Linearisation StepPublisher::linearise_coupled(std::size_t tool, const Vec3& p_W, const Vec3& there,
                                               const ToolForce* known, OrganAfterStep organ) const {
  const Mat3* const relative = coupled_ ? &coupling_->relative_motion(tool) : nullptr;
  Linearisation l = linearise(tool, relative ? Vec3(p_W + *relative * (there - p_W)) : there, known, organ);
  const Mat3 k = relative ? Mat3(l.tangent * *relative) : l.tangent;
  l.tangent = 0.5 * (k + k.transpose());  // of friction, the part that stores energy
  l.p_W = there;
  return l;
}

void StepPublisher::add_wanted(std::size_t tool, const ToolInput& input, const PublishedModes* modes,
                               bool once_a_step, OrganAfterStep organ, ToolAnswer& answer) {
  if (!input.pose || answer.flagged) return;
  const auto& [tissue, tools, rest, cut] = organ;
  // No linearisation of the tissue alone where the force of a blade is rendered, too.
  if (tissue.traits.publishes_tangents && !(cut != nullptr && cut->resists(tool)))
    add_linearisations(tool, input, once_a_step, organ, answer);
  const Vec3& p_W = input.pose->p_W;
  if (!input.request.surface_shift || tools[tool].holds()) return;  // what is grasped is no matter of contact
  if (cut != nullptr && !(cut->published() && cut->published()->covers(p_W))) return;
  answer.surface_shift_W = surface_shift(tool, p_W, modes, organ);
  if (modes != nullptr) publish_modes(tool, *modes, organ, answer);
}

void StepPublisher::add_linearisations(std::size_t tool, const ToolInput& input, bool once_a_step,
                                       OrganAfterStep organ, ToolAnswer& answer) const {
  const ToolRequest& request = input.request;
  if (!request.at_tool && !request.ahead) return;
  const Vec3& p_W = input.pose->p_W;
  const Tissue& tissue = organ.tissue;
  answer.surface_v_W =
      organ.tools[tool].surface_velocity(p_W, tissue, tissue.velocities, tissue.loads_of(tool));
  if (coupled_ && coupling_->moved_by_others(tool)) answer.others = coupling_->others(tool);
  if (request.at_tool) answer.at_tool = linearise_coupled(tool, p_W, p_W, &answer, organ);
  // Where contact is solved several times a step, the tool would be there within one of them: a jump that
  // tissue with inertia answers otherwise than the motion that is expected. Then the tangent must do.
  if (!request.ahead || !once_a_step) return;
  const Vec3 v_W = answer.others ? Vec3(answer.surface_v_W + answer.others->v_W) : answer.surface_v_W;
  const Vec3 motion = request.ahead->seconds * (request.ahead->v_W - v_W);  // on the organ as it stands
  Vec3 there = p_W + std::min(1.0, kMaxAhead / motion.norm()) * motion;
  if (!there.allFinite()) there = p_W;
  answer.ahead = linearise_coupled(tool, p_W, there, nullptr, organ);
}

void StepPublisher::publish_modes(std::size_t tool, const PublishedModes& modes, OrganAfterStep organ,
                                  ToolAnswer& answer) {
  organ.tissue.traits.client->read_modes(modes_);
  answer.modes = &modes_;
  if (organ.tools.size() == 1) return;
  Eigen::VectorXd& driven = by_others_[tool];
  driven.setZero();
  for (std::size_t other = 0; other < organ.tools.size(); ++other) {
    if (other != tool) modes.add_drive(organ.tissue.loads_of(other), driven);
  }
  answer.modal_loads = &driven;
}

Linearisation StepPublisher::linearise(std::size_t tool, const Vec3& p_W, const ToolForce* known,
                                       OrganAfterStep organ) {
  ToolContact& contact = organ.tools[tool];
  if (!contact.placed()) return {};
  const ToolTissue tissue = organ.tissue.touched_by(tool);
  const ToolForce there = known != nullptr ? *known : contact.probe(p_W, tissue);
  if (there.contacts > 0) {
    const double size = there.force.norm();
    return {p_W, there.force, there.tangent, size > 0 ? Vec3(there.force / size) : Vec3(Vec3::Zero()), 0};
  }
  const SurfacePlane plane = contact.nearest(p_W, organ.tissue);
  if (plane.gap > kNearby * contact.radius()) return {};
  // A little beyond the first touch, so that it is known how stiff the surface is.
  const Vec3 touching = p_W - (plane.gap + kProbeDepth * contact.radius()) * plane.normal_W;
  return {p_W, Vec3::Zero(), contact.probe(touching, tissue).tangent, plane.normal_W, plane.gap};
}

Vec3 StepPublisher::surface_shift(std::size_t tool, const Vec3& p_W, const PublishedModes* modes,
                                  OrganAfterStep organ) {
  const ToolTissue tissue = organ.tissue.touched_by(tool);
  const int vertex = organ.tools[tool].nearest_vertex(p_W, organ.tissue);
  if (vertex < 0) return Vec3::Zero();  // all that it could touch has been cut away
  if (modes == nullptr) return tissue.free()[vertex] - organ.rest[vertex];
  const std::span<const Vec3> carried = organ.tissue.carried;
  const Vec3 by_supports = carried.empty() ? Vec3(Vec3::Zero()) : Vec3(carried[vertex] - organ.rest[vertex]);
  return by_supports + residual_shift(tool, vertex, organ);
}

/// Returns how far the other tools push a vertex, but for what they do by the published modes, m.
Vec3 StepPublisher::residual_shift(std::size_t tool, int vertex, OrganAfterStep organ) {
  Vec3 shift = Vec3::Zero();
  for (std::size_t other = 0; other < organ.tools.size(); ++other) {
    if (other == tool) continue;
    for (const VertexLoad& load : organ.tissue.loads_of(other)) {
      organ.tissue.traits.client->residual_compliance(std::array{vertex, load.vertex}, pair_);
      shift += pair_.compliance.block<3, 3>(0, 3) * load.force;
    }
  }
  return shift;
}

}  // namespace palpate::sim
