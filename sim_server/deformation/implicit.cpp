#include "sim_server/deformation/implicit.h"

#include <algorithm>

#include "common/error.h"
#include "sim_server/elasticity/equilibrium.h"

namespace palpate::sim {
namespace {

const Material& material_of(const ModelInputs& inputs) {
  const Scene& scene = inputs.scene;
  if (!scene.material) fail("{}: model \"implicit\" needs a [material] section", scene.source);
  step_period(scene);  // before any work
  inputs.progress("assembling the stiffness matrix", 0);
  return *scene.material;
}

DynamicsSettings settings_of(const DeformationSettings& settings) {
  return {settings.rayleigh_mass, settings.rayleigh_stiffness, settings.second_order};
}

}  // namespace

Implicit::Implicit(const ModelInputs& inputs)
    : solid_(inputs.mesh, material_of(inputs)),
      scene_loads_(inputs.scene, inputs.mesh, inputs.surface, solid_),
      dynamics_(solid_, scene_loads_.held(), settings_of(inputs.scene.deformation), inputs.scene.source),
      period_(step_period(inputs.scene)),
      tolerance_(inputs.scene.deformation.tolerance),
      max_newton_(inputs.scene.deformation.max_newton),
      node_(inputs.surface.vertices),
      external_(static_cast<std::size_t>(solid_.nodes())),
      slot_(node_.size(), -1) {
  if (!inputs.scene.loads.empty()) {
    inputs.progress("finding the shape under its loads", 0);
    dynamics_.stand_at(
        find_equilibrium(
            solid_,
            {.forces = [this](std::span<const Vec3> x, std::span<Vec3> f) { scene_loads_.add_forces(x, f); },
             .held = scene_loads_.held(),
             .moved = scene_loads_.moved()},
            inputs.scene.source)
            .x);
  }
  inputs.progress("factoring the stiffness matrix", 0);
  for (const int node : node_) {
    dof_.push_back(dynamics_.dofs().first[node]);
    rest_.push_back(dynamics_.position()[node]);
  }
  free_ = positions_ = rest_;
  dynamics_.start_step(period_);
  dynamics_.improve(external());
  held_compliance_ = dynamics_.least_compliance();
  linearised();
  inputs.progress("factoring the stiffness matrix", 1);
}

FreeMotion Implicit::free_motion(double dt) noexcept {
  if (dt > 0) {
    if (moving_) {
      follow_loads();
      dynamics_.finish_step();
    }
    moving_ = true;
    touched_ = false;
    dynamics_.start_step(period_);
    met_ = loads_;
    looks_ = dynamics_.settle(external(), max_newton_, tolerance_);
    linearised();
  }
  return {free_, {}, positions_};
}

/// All of the body goes where the loads of now lead by the linearisation that stands.
void Implicit::follow_loads() noexcept {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(dynamics_.dofs().count);
  const auto add = [&](const std::vector<NodalLoad>& loads, double sign) {
    for (const NodalLoad& load : loads) {
      if (dof_[load.vertex] >= 0) change.segment<3>(dof_[load.vertex]) += sign * load.force;
    }
  };
  add(loads_, 1);
  add(met_, -1);
  if (change.isZero(0)) return;
  dynamics_.move(dynamics_.solve(change).col(0));
  met_ = loads_;
}

std::optional<FreeMotion> Implicit::relinearise() noexcept {
  if (never_changes() || ++looks_ > max_newton_) return {};
  follow_loads();
  if (!touched_) dynamics_.push_anew();
  touched_ = true;
  if (dynamics_.improve(external(), tolerance_) <= tolerance_) return {};
  linearised();
  return FreeMotion{free_, {}, positions_};
}

/// A new linearisation, or a new place of an old one: the surface there, and free of the loads it was made
/// under.
void Implicit::linearised() noexcept {
  if (factors_ != dynamics_.factors()) {
    std::fill(slot_.begin(), slot_.end(), -1);
    slots_ = 0;
    factors_ = dynamics_.factors();
  }
  for (std::size_t v = 0; v < node_.size(); ++v) positions_[v] = free_[v] = dynamics_.position()[node_[v]];
  press(met_, -1, free_);
}

/// What the scene and the tools push with (nodes, N).
std::span<const Vec3> Implicit::external() noexcept {
  std::fill(external_.begin(), external_.end(), Vec3::Zero());
  scene_loads_.add_forces(dynamics_.position(), external_);
  for (const NodalLoad& load : met_) external_[node_[load.vertex]] += load.force;
  return external_;
}

void Implicit::find_columns(std::span<const int> vertices) const noexcept {
  std::vector<int> missing;
  for (const int v : vertices) {
    if (dof_[v] < 0 || slot_[v] >= 0) continue;
    slot_[v] = slots_ + static_cast<int>(missing.size());
    missing.push_back(v);
  }
  if (missing.empty()) return;
  const auto count = static_cast<Eigen::Index>(missing.size());
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(dynamics_.dofs().count, 3 * count);
  for (Eigen::Index k = 0; k < count; ++k) unit.block<3, 3>(dof_[missing[k]], 3 * k).setIdentity();
  const Eigen::MatrixXd moved = dynamics_.solve(unit);
  slots_ += static_cast<int>(count);
  if (columns_.cols() < 3 * slots_)
    columns_.conservativeResize(3 * static_cast<Eigen::Index>(node_.size()), 2 * 3 * slots_);
  for (Eigen::Index k = 0; k < count; ++k) {
    auto column = columns_.middleCols<3>(3 * slot_[missing[k]]);
    for (std::size_t v = 0; v < node_.size(); ++v) {
      auto rows = column.middleRows<3>(static_cast<Eigen::Index>(3 * v));
      if (dof_[v] >= 0) {
        rows = moved.block<3, 3>(dof_[v], 3 * k);
      } else {
        rows.setZero();
      }
    }
  }
}

void Implicit::compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept {
  patch.tool_compliance = 0;
  find_columns(vertices);
  const auto m = static_cast<Eigen::Index>(vertices.size());
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      auto block = patch.compliance.block<3, 3>(3 * i, 3 * j);
      if (dof_[vertices[i]] < 0 || dof_[vertices[j]] < 0) {
        block = (i == j ? held_compliance_ : 0.0) * Mat3::Identity();
      } else {
        // Equal by theory to its mirror image; make it so to the last bit.
        block = 0.5 * (columns_.block<3, 3>(3 * vertices[i], 3 * slot_[vertices[j]]) +
                       columns_.block<3, 3>(3 * vertices[j], 3 * slot_[vertices[i]]).transpose());
      }
      patch.compliance.block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
  }
}

/// Moves `positions` by what loads do, times `sign`.
void Implicit::press(std::span<const NodalLoad> loads, double sign,
                     std::span<Vec3> positions) const noexcept {
  std::vector<int> vertices;
  for (const NodalLoad& load : loads) vertices.push_back(load.vertex);
  find_columns(vertices);
  for (const NodalLoad& load : loads) {
    if (dof_[load.vertex] < 0) {
      positions[load.vertex] += sign * held_compliance_ * load.force;
      continue;
    }
    const Eigen::VectorXd moved = columns_.middleCols<3>(3 * slot_[load.vertex]) * (sign * load.force);
    for (std::size_t v = 0; v < positions.size(); ++v)
      positions[v] += moved.segment<3>(static_cast<Eigen::Index>(3 * v));
  }
}

std::span<const Vec3> Implicit::apply(std::span<const NodalLoad> loads) noexcept {
  loads_.assign(loads.begin(), loads.end());
  std::copy(free_.begin(), free_.end(), positions_.begin());
  press(loads_, 1, positions_);
  return positions_;
}

std::vector<MemoryPart> Implicit::memory() const {
  return {{"elements", solid_.bytes()},
          {"motion", dynamics_.bytes()},
          {"compliance", static_cast<std::size_t>(columns_.size()) * sizeof(double)},
          {"positions", (rest_.size() + free_.size() + positions_.size() + external_.size()) * sizeof(Vec3) +
                            (node_.size() + dof_.size() + slot_.size()) * sizeof(int)}};
}

}  // namespace palpate::sim
