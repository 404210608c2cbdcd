#pragma once
#include <atomic>
#include <memory>

#include "haptic_client/device/device.h"
#include "haptic_client/device/spacemouse_reports.h"

namespace palpate::client {

/// `[spacemouse]` of the client file.
struct SpaceMouseSettings {
  double speed = 0.1;  ///< of the tool at full deflection, along each axis, m/s, [0.001, 1]
  double reach = 0.1;  ///< half a side of the box around its start that the tool stays in, m, [0.001, 1]
};

/// A 3Dconnexion 6-DoF mouse: its deflection is the velocity of a tool that starts at 0 (x right, y up, z
/// towards the user, m). It has no motors: the force is reported, not rendered. The tool stands still when no
/// translation came for 100 ms, and while the mouse is unplugged; then it goes on from where it was.
class SpaceMouse : public Device {
 public:
  SpaceMouse(std::unique_ptr<UsbTransport> port, const SpaceMouseSettings& settings);
  /// Switches the light off and gives the mouse back to the system.
  ~SpaceMouse() override;
  DeviceReading read(Time now) noexcept override;
  void write(const Vec3&) noexcept override {}
  const char* status() const noexcept override { return message_; }

 private:
  void advance(Time now) noexcept;
  bool keep_open(Time now) noexcept;
  void light(bool on) noexcept;

  std::unique_ptr<UsbTransport> port_;
  SpaceMouseSettings settings_;
  std::atomic<const char*> message_{"looking for a SpaceMouse"};
  SpaceMouseState state_;
  Vec3 p_D_ = Vec3::Zero();
  Time last_{}, heard_{}, retry_at_{};  // tick before; last translation; not opened before
};

}  // namespace palpate::client
