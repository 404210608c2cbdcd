#include "sim_server/scene_file/read_reach.h"

#include <Eigen/Geometry>
#include <numbers>

#include "common/error.h"
#include "common/text.h"
#include "common/workspace.h"

namespace palpate::sim {
namespace {

constexpr double kComesNearer = 0.02;  // m: so far tissue at rest beyond reach may deform towards a tool

/// Returns the box of the device's grip, in its own frame.
Box device_box(const Config& config) {
  if (config.has("box")) {
    const auto [min, max] = config.box("box");
    if (config.has("device"))
      fail("{}: `box` says how far the device reaches; remove `device`", config.where("box"));
    return {min, max};
  }
  const std::string device = config.text("device");
  const auto& row = find_row(device_reaches(), device, "device with a workspace (or give its `box`)",
                             config.where("device"));
  return {row.min, row.max};
}

/// Returns where `device` is put into the scene as the client's [workspace] does.
Reach read_workspace_of(const Config& config, const Tool& shape) {
  const Workspace workspace = read_workspace(config);
  const Box device = device_box(config);
  config.reject_unknown();
  Eigen::AlignedBox3d box(workspace.to_world(device.min));
  box.extend(workspace.to_world(device.max));  // its axes are the world's
  if (shape.trocar) box.extend(shape.trocar->pivot_W);
  return widened(Reach(Box{box.min(), box.max()}), shape.length + shape.radius + kComesNearer);
}

Reach read_cone(const Config& config, const Tool& shape) {
  if (!shape.trocar)
    fail("{}: [tool.cone] is for shape \"trocar\", which turns about its pivot", config.where());
  const Vec3 axis = config.vector("axis", {-1e3, 1e3, "no unit"});
  if (!(axis.norm() > 0)) fail("{}: `axis` has no direction", config.where("axis"));
  const double tilt = config.number("tilt", {1, 180, "degrees"});
  const double depth = config.number("depth", {1e-3, 1, "m"});
  config.reject_unknown();
  return Cone{shape.trocar->pivot_W, axis.normalized(), tilt * std::numbers::pi / 180, depth,
              shape.radius + kComesNearer};
}

}  // namespace

void read_reach(const Config& config, ToolSettings& tool) {
  const auto workspace = config.table("workspace"), cone = config.table("cone");
  if (config.has("reach") + workspace.has_value() + cone.has_value() > 1)
    fail("{}: `reach`, [tool.workspace] and [tool.cone] all say how far the tool gets; keep one",
         config.where());
  if (config.has("reach")) {
    const auto [min, max] = config.box("reach");
    tool.reach = Box{min, max};
    tool.reach_where = config.where("reach");
  } else if (workspace) {
    tool.reach = read_workspace_of(*workspace, tool.shape);
    tool.reach_where = workspace->where();
    tool.stays_within = true;
  } else if (cone) {
    tool.reach = read_cone(*cone, tool.shape);
    tool.reach_where = cone->where();
    tool.stays_within = true;
  }
}

}  // namespace palpate::sim
