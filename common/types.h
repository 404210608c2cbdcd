#pragma once
/// Small fixed-size algebra, under the names the whole house uses. SI units and radians everywhere.
/// A trailing letter names the frame a vector is expressed in: `_W` world, `_D` device, `_M` mesh at rest.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

}  // namespace palpate
