#pragma once
#include <vector>

#include "haptic_client/device/device.h"
#include "haptic_client/evaluation/captured_session.h"

namespace palpate::client {

/// A hand that does what one in a capture did, whatever force it feels: the places and buttons of its tool
/// states in their own time, straight between two of them. It begins at its first reading, and holds still at
/// the end. Its frame is the world. 64 bytes a tick.
class CapturedHand final : public Device {
 public:
  /// Reads the whole session. Throws `Error` where it cannot be read.
  explicit CapturedHand(CapturedSession& session);

  double seconds() const;  ///< from the first tick to the last

  DeviceReading read(Time now) noexcept override;
  void write(const Vec3&) noexcept override {}

 private:
  struct Tick {
    Time t;
    Vec3 p_W;
    std::uint16_t buttons;
    bool lost;
  };
  std::vector<Tick> ticks_;
  std::size_t at_ = 0;  // the newest tick that has passed
  Time start_{};
};

}  // namespace palpate::client
