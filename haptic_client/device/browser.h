#pragma once
#include <optional>

#include "haptic_client/device/device.h"
#include "haptic_client/device/simulated_hand.h"

namespace palpate::client {

/// The mouse in a page of `sim_server --viewer` as a device: a hand whose arm follows the mouse, and which
/// the force pushes back, so that what is drawn gives way as a device would. The mouse tells its place some
/// 60 times a second; between, the arm goes there evenly. Without a mouse the hand stays where it is.
class Browser : public Device {
 public:
  /// Starts at rest at `start` (m, device frame).
  Browser(const OperatorSettings& settings, const Vec3& start)
      : hand_(settings, start), aim_(start), arm_(start) {}

  /// Steps of at most 0.25 ms; a pause of more than 0.1 s is one of the hand, too.
  DeviceReading read(Time now) noexcept override;
  void write(const Vec3& f_D) noexcept override { hand_.push(f_D); }
  void aim(const Vec3& p_D, std::uint16_t buttons) noexcept override;

 private:
  static constexpr double kBetween = 0.02;   // s in which the arm goes to where the mouse is
  static constexpr double kFastest_ = 0.25;  // m/s, of the arm: a mouse may jump, a hand does not

  SimulatedHand hand_;
  Vec3 aim_, arm_, arm_v_ = Vec3::Zero();  // m, m, m/s
  std::uint16_t buttons_ = 0;
  std::optional<Time> last_;
};

}  // namespace palpate::client
