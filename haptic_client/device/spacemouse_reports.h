#pragma once
/// HID input reports of a 3Dconnexion 6-DoF mouse, and the meaning of its deflection.
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/types.h"
#include "haptic_client/device/usb_transport.h"

namespace palpate::client {

/// The models that speak as below. Not here, though of the same makers: mice without six axes, keypads, and
/// receivers that serve several devices.
std::span<const UsbId> spacemouse_ids() noexcept;
/// "SpaceNavigator"; "SpaceMouse" for one whose name is not known.
const char* spacemouse_name(const UsbId& id) noexcept;

constexpr int kSpaceMouseFull = 350;     ///< raw units of full deflection; more is cut
constexpr int kSpaceMouseDeadBand = 10;  ///< raw units: less is no deflection

/// Newest state of the mouse.
struct SpaceMouseState {
  Vec3 push_D = Vec3::Zero();  ///< each in [-1, 1]: right, up, towards the user; see `spacemouse_response`
  std::uint16_t buttons = 0;   ///< the first 16, a bit each
};

/// Response to a raw deflection: zero in the dead band, +-1 from full deflection on, between them the square
/// of the way, so that it begins without a step in value or slope.
double spacemouse_response(int raw) noexcept;

/// Takes one report: translation (7 bytes, or 13 with the rotation, which is not used) or buttons. Others and
/// truncated ones change nothing. True: it had the translation.
bool take_spacemouse_report(std::span<const std::byte> report, SpaceMouseState& state) noexcept;

/// The output report that switches the light on or off.
constexpr std::uint16_t kSpaceMouseLight = 0x0204;  ///< wValue of SET_REPORT: output report 4

}  // namespace palpate::client
