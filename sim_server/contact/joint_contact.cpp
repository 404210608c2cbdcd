#include "sim_server/contact/joint_contact.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace palpate::sim {
namespace {

constexpr int kLooks = 3;  // at the surface, where the tissue closes over a tool

int sum_over(std::span<const ToolContact> tools, int (ToolContact::*of)() const) {
  return std::accumulate(tools.begin(), tools.end(), 0,
                         [of](int sum, const ToolContact& tool) { return sum + (tool.*of)(); });
}

bool any_friction(std::span<const ToolContact> tools) {
  return std::ranges::any_of(tools, &ToolContact::has_friction);
}

}  // namespace

JointContact::JointContact(std::span<const ToolContact> tools, std::size_t vertices)
    : solver_(sum_over(tools, &ToolContact::max_nodes), sum_over(tools, &ToolContact::max_triangles),
              any_friction(tools), static_cast<int>(tools.size())),
      node_of_vertex_(vertices, -1),
      free_(vertices) {
  const int nodes = sum_over(tools, &ToolContact::max_nodes);
  near_.reserve(tools.size());
  touching_.reserve(tools.size());
  patch_.reserve(nodes, sum_over(tools, &ToolContact::max_triangles));
  vertices_.reserve(static_cast<std::size_t>(nodes));
  were_.reserve(static_cast<std::size_t>(nodes));
  are_.reserve(static_cast<std::size_t>(nodes));
  loads_.reserve(static_cast<std::size_t>(nodes));
  if (any_friction(tools))
    forces_before_.reserve(static_cast<std::size_t>(nodes + sum_over(tools, &ToolContact::max_triangles)));
  displacement_.resize(3 * (nodes + static_cast<int>(tools.size())));
  node_forces_.resize(3 * nodes);
}

bool JointContact::has_solved(std::size_t tool) const noexcept {
  return place_of(tool) >= 0;
}

/// The place of a tool among those that are solved for; -1: it has none.
int JointContact::place_of(std::size_t tool) const noexcept {
  const auto at = std::ranges::find(near_, tool);
  return at == near_.end() ? -1 : static_cast<int>(at - near_.begin());
}

bool JointContact::advance(std::span<ToolContact> tools, std::span<const std::optional<PathPoint>> to,
                           Tissue& tissue) {
  for (std::size_t t = 0; t < tools.size(); ++t) {
    goes_[t] = to[t] && !tools[t].holds() && tools[t].start_way(to[t]->pose, to[t]->bend, tissue.known_to(t));
  }
  return go(tools, tissue);
}

bool JointContact::settle(std::span<ToolContact> tools, Tissue& tissue) {
  for (std::size_t t = 0; t < tools.size(); ++t) {
    goes_[t] = tools[t].placed() && !tools[t].holds();
    if (goes_[t]) tools[t].start_settling(tissue.known_to(t));
  }
  return go(tools, tissue);
}

bool JointContact::go(std::span<ToolContact> tools, Tissue& tissue) {
  int increments = 1;
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (goes_[t]) increments = std::max(increments, tools[t].increments());
  }
  forces_ = {};
  bool converged = true;
  for (int i = 1; i <= increments; ++i) {
    bool any = false;
    for (std::size_t t = 0; t < tools.size(); ++t) {
      const ToolTissue own = tissue.known_to(t);
      if (!goes_[t] || tools[t].has_stopped(own)) continue;
      tools[t].go_on(i, increments, own);
      any = true;
    }
    if (!any) break;
    converged = solve(tools, tissue);
    if (!converged) break;  // what comes after would begin from anywhere
  }
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (goes_[t]) tools[t].end_way(forces_[t], tissue.known_to(t));
  }
  return converged;
}

/// Contact where the tools are now, and once more where the tissue has closed over one of them.
bool JointContact::solve(std::span<ToolContact> tools, Tissue& tissue) {
  const auto stopped = [&] {
    int count = 0;
    for (std::size_t t = 0; t < tools.size(); ++t)
      count += goes_[t] && tools[t].has_stopped(tissue.known_to(t));
    return count;
  };
  for (int look = 0; look < kLooks; ++look) {
    const int before = stopped();
    gather(tools, tissue);
    bool converged = true;
    if (near_.size() == 1) {
      converged = solve_alone(near_.front(), tools, tissue);
    } else {
      if (!near_.empty()) {
        take_compliance(tissue);
        solve_patch(tools);
      }
      set_loads(tools, tissue);
      for (const std::size_t t : near_) converged = converged && forces_[t].converged;
      for (std::size_t t = 0; t < tools.size(); ++t) {
        if (goes_[t]) tools[t].note(forces_[t], solver_.feature_forces(), place_of(t), tissue.known_to(t));
      }
    }
    if (!converged) return false;
    if (stopped() == before) return true;
  }
  return false;
}

/// One tool near the surface: the loads of all others, if they have any, are of grasps.
bool JointContact::solve_alone(std::size_t index, std::span<ToolContact> tools, Tissue& tissue) {
  near_.clear();
  forces_[index] = tools[index].solve_contact(tissue.touched_by(index));
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (goes_[t]) tools[t].note(forces_[t], tissue.known_to(t));
  }
  return forces_[index].converged;
}

void JointContact::solve_patch(std::span<ToolContact> tools) {
  const int m = patch_.nodes();
  auto u = displacement_.head(3 * (m + static_cast<int>(near_.size())));
  for (int i = 0; i < m; ++i) {
    u.segment<3>(3 * i) = are_[static_cast<std::size_t>(i)] - patch_.free[i];
    for (const std::size_t t : near_) {
      const Vec3 ahead = tools[t].foreseen(vertices_[i]);
      u.segment<3>(3 * i) += ahead;
      if (!ahead.isZero(0)) break;
    }
  }
  double least_radius = std::numeric_limits<double>::infinity(), uncertainty = 0;
  forces_before_.clear();
  for (int k = 0; k < static_cast<int>(near_.size()); ++k) {
    ToolContact& tool = tools[near_[k]];
    u.segment<3>(3 * (m + k)) = tool.tip_offset() + tool.foreseen_tip();
    tool.predict(vertices_, patch_, u.head(3 * m), node_forces_.head(3 * m));
    tool.append_forces(k, forces_before_);
    least_radius = std::min(least_radius, tool.radius());
    uncertainty = std::max(uncertainty, tool.uncertainty());
  }
  touching_.front().start.forces = forces_before_;
  std::array<ContactForce, kMaxTools> forces;
  solver_.solve(patch_, touching_, u, std::span(forces).first(near_.size()),
                {.expected = uncertainty / least_radius});
  for (std::size_t k = 0; k < near_.size(); ++k) forces_[near_[k]] = forces[k];
}

/// The union of the patches of the tools that are near the surface, each node once.
void JointContact::gather(std::span<ToolContact> tools, Tissue& tissue) {
  hold_grasps(tools, tissue);
  for (const int vertex : vertices_) node_of_vertex_[vertex] = -1;
  near_.clear();
  touching_.clear();
  vertices_.clear();
  were_.clear();
  are_.clear();
  patch_.free.clear();
  patch_.triangles.clear();
  std::array<std::size_t, kMaxTools + 1> first{};
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (!goes_[t]) continue;
    const ToolTissue met = tissue.known_to(t);
    const ContactPatch& own = tools[t].gather(met.positions(), base_);
    if (own.triangles.empty()) {
      forces_[t] = {};
      tools[t].set_tip_offset(Vec3::Zero());
      tissue.replace_loads(t, {});
      continue;
    }
    const std::span<const int> vertices = tools[t].patch_vertices();
    for (const Triangle& corners : own.triangles) {
      Triangle& joint = patch_.triangles.emplace_back();
      for (int i = 0; i < 3; ++i) joint[i] = node_of(vertices[corners[i]], tools[t], met);
    }
    touching_.push_back({&tools[t].shape(), tools[t].pose()});
    near_.push_back(t);
    first[near_.size()] = patch_.triangles.size();
  }
  const double lead = lead_slip(tools);
  const std::span<const Triangle> triangles(patch_.triangles);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    touching_[k].triangles = triangles.subspan(first[k], first[k + 1] - first[k]);
    const ToolPose was = tools[near_[k]].slip_start(lead);
    touching_[k].start = {were_, was.p_W, was.q_W};
  }
}

/// Puts the places from which the slip of nodes is measured ahead, by as much for one tool as for another, as
/// they share nodes: as for the tool with the least. Returns that share.
double JointContact::lead_slip(std::span<const ToolContact> tools) {
  std::optional<double> least;
  for (const std::size_t t : near_) {
    if (!tools[t].has_friction() || !tools[t].has_way()) continue;
    least = std::min(least.value_or(1), tools[t].slip_lead());
  }
  const double lead = least.value_or(0);
  for (std::size_t i = 0; lead > 0 && i < vertices_.size(); ++i) {
    for (const std::size_t t : near_) {
      const Vec3 ahead = tools[t].surface_lead(vertices_[i], lead);
      were_[i] += ahead;
      if (!ahead.isZero(0)) break;
    }
  }
  return lead;
}

/// The shape of the surface free of all tools but those that grasp.
void JointContact::hold_grasps(std::span<const ToolContact> tools, Tissue& tissue) {
  base_ = tissue.free;
  loads_.clear();
  for (std::size_t t = 0; t < tools.size(); ++t) {
    if (!tools[t].holds()) continue;
    const std::span<const VertexLoad> own = tissue.loads_of(t);
    loads_.insert(loads_.end(), own.begin(), own.end());
  }
  if (loads_.empty()) return;
  std::ranges::copy(tissue.model->apply(loads_), free_.begin());
  base_ = free_;
  tissue.apply_all_loads();
}

/// The patch node of a surface vertex, given one if it has none yet.
int JointContact::node_of(int vertex, const ToolContact& tool, const ToolTissue& tissue) {
  int& node = node_of_vertex_[vertex];
  if (node >= 0) return node;
  node = static_cast<int>(vertices_.size());
  vertices_.push_back(vertex);
  patch_.free.push_back(base_[vertex] - tissue.still_to_come(vertex));
  are_.push_back(tissue.positions()[vertex]);
  were_.push_back(tool.increment_start(vertex, tissue.positions()));
  return node;
}

void JointContact::take_compliance(const Tissue& tissue) {
  patch_.compliance.shape(3 * patch_.nodes(), 3 * patch_.nodes());
  patch_.source = tissue.traits.columns;
  patch_.vertices = vertices_;
  if (patch_.source == nullptr) return tissue.model->compliance(vertices_, patch_);
  patch_.filled.assign(vertices_.size(), 0);
  patch_.source->begin(patch_);
}

void JointContact::set_loads(std::span<ToolContact> tools, Tissue& tissue) {
  const int m = patch_.nodes();
  auto own = node_forces_.head(3 * m);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    solver_.node_forces_of(static_cast<int>(k), own);
    loads_.clear();
    for (int i = 0; i < m; ++i) {
      if (const Vec3 force = own.segment<3>(3 * i); !force.isZero(0)) loads_.push_back({vertices_[i], force});
    }
    tissue.replace_loads(near_[k], loads_);
    tools[near_[k]].set_tip_offset(displacement_.segment<3>(3 * (m + static_cast<int>(k))));
  }
  tissue.apply_all_loads();
}

void JointContact::differentiate(std::size_t index, ToolContact& tool, const ToolTissue& tissue) noexcept {
  if (tool.force().contacts > 0) tool.differentiate(solver_, patch_, place_of(index), vertices_, tissue);
}

}  // namespace palpate::sim
