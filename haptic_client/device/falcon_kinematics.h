#pragma once
#include <optional>

#include "common/types.h"

namespace palpate::client {

/// The delta mechanism of the Novint Falcon: three legs, each a thigh driven by a motor and a shin of
/// parallelograms, after R. E. Stamper (1997), A three degree of freedom parallel manipulator with only
/// translational degrees of freedom. Device frame: x right, y up, z out of the device towards the user, m;
/// leg angles in rad, in the order top, right, left. Pure; any thread; no allocation.
namespace falcon {

/// Leg angle of an encoder: 320 lines read four times a motor turn, capstan 14.25 mm on 110 mm, and 35
/// degrees where the count is 0 (homed).
double angle_of(int counts) noexcept;

/// Angles of the legs with the grip at `p_D`; nothing where a leg does not reach. About 0.2 us.
std::optional<Vec3> leg_angles(const Vec3& p_D) noexcept;

/// d(angles)/d(position), rad/m, a row a leg; nothing where a leg does not reach or is stretched out
/// (singular).
std::optional<Mat3> jacobian(const Vec3& p_D) noexcept;

/// The grip where the legs have these angles: Newton from `guess` (the last place), steps halved until
/// they come nearer, until the angles agree to 1e-12 rad. Nothing when that does not happen in 50 steps. Two
/// or three steps from a place a tick ago, about 1 us.
std::optional<Vec3> grip_position(const Vec3& angles, const Vec3& guess) noexcept;

/// A place well inside, to begin from.
inline const Vec3 kCentre{0, 0, 0.11};

/// Motor commands (DAC units) that give the force `f_D` (N) at `p_D`: tau = J^-T f, DAC = -K tau, all three
/// scaled together where one is beyond +-4096, so that clipping keeps the direction. `dac_per_newton_metre`
/// (K) is uncertain by 2 to 4 times on real devices: calibrate it. Zero where the position is none.
Vec3 motor_commands(const Vec3& f_D, const Vec3& p_D, double dac_per_newton_metre) noexcept;

}  // namespace falcon
}  // namespace palpate::client
