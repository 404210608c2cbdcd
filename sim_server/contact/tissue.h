#pragma once
#include <memory>
#include <span>
#include <vector>

#include "sim_server/deformation/deformation_model.h"

namespace palpate::sim {

/// The tissue as all tools share it. Positions are those of the surface vertices, m, world.
struct Tissue {
  std::unique_ptr<DeformationModel> model;
  std::span<const Vec3> free;        ///< in this step, without any contact
  std::span<const Vec3> velocities;  ///< of that, m/s; empty: it rests
  std::span<const Vec3> positions;   ///< now, under the loads of all tools
  std::vector<Vec3> before;          ///< at the end of the last step; empty where no tool has friction
};

}  // namespace palpate::sim
