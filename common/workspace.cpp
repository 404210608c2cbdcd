#include "common/workspace.h"

#include <Eigen/LU>
#include <array>

#include "common/error.h"
#include "common/units.h"

namespace palpate {
namespace {

// Of the Falcon somewhat more than the cube of 100 mm that its maker states; of the SpaceMouse what the
// client's [spacemouse] `reach` is where it is not told.
const std::array kReaches{
    DeviceReach{"falcon", Vec3(-0.065, -0.065, 0.07), Vec3(0.065, 0.065, 0.18)},
    DeviceReach{"spacemouse", Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0.1, 0.1)},
};

}  // namespace

Mat3 read_rotated_axes(const Config& config) {
  Mat3 axes = Mat3::Zero();
  const auto names = config.texts("axes", 3, {"x", "y", "z"});
  for (int i = 0; i < 3; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    const bool minus = name.starts_with('-');
    const std::size_t axis = std::string("xyz").find(name.substr(minus ? 1 : 0));
    if (name.size() != (minus ? 2 : 1) || axis == std::string::npos)
      fail("{}: `axes`: \"{}\" is no axis; known: x, y, z, -x, -y, -z", config.where("axes"), name);
    axes(i, static_cast<int>(axis)) = minus ? -1 : 1;
  }
  if (axes.determinant() == 0) fail("{}: `axes` must name x, y and z once each", config.where("axes"));
  if (axes.determinant() < 0)
    fail("{}: `axes` would mirror the world; change one sign or swap two", config.where("axes"));
  return axes;
}

Workspace read_workspace(const Config& config) {
  Workspace workspace;
  workspace.scale = config.number("scale", {0.01, 100, "world m per device m"}, workspace.scale);
  workspace.offset_W = config.vector("offset", {-kMaxCoordinate, kMaxCoordinate, "m"}, workspace.offset_W);
  workspace.axes = read_rotated_axes(config);
  return workspace;
}

std::span<const DeviceReach> device_reaches() {
  return kReaches;
}

}  // namespace palpate
