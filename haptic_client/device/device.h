#pragma once
#include <optional>

#include "common/time.h"
#include "common/types.h"

namespace palpate::client {

/// Reading of a device.
struct DeviceReading {
  Time t{};                   ///< when it was read, this machine's monotonic clock
  Vec3 p_D = Vec3::Zero();    ///< position of the handle, m, device frame
  std::optional<Quat> q_D{};  ///< orientation of the handle, unit, device frame; none: it does not tell
  std::uint16_t buttons = 0;  ///< one bit each
  bool valid = true;          ///< false: nothing known (unplugged, not homed): no force may follow
};

/// Limits of a device; known from its settings, before (and without) opening it.
struct DeviceLimits {
  double max_force = 8;                              ///< N
  Time min_period = std::chrono::microseconds(250);  ///< shortest loop period it serves
  double usual_rate_hz = 500;                        ///< ticks a second where nobody asks for a rate
};

/// A force-feedback device. Called by the haptic thread only; never blocks longer than its own exchange,
/// never throws, allocates or logs.
class Device {
 public:
  virtual ~Device() = default;
  virtual DeviceReading read(Time now) noexcept = 0;
  /// Sets the force on the hand (N, device frame) until the next call.
  virtual void write(const Vec3& f_D) noexcept = 0;
  /// Sets the position of the handle (m, device frame) that the mouse of a page requests, and its buttons.
  /// Only a device that is that mouse uses it.
  virtual void aim(const Vec3& p_D, std::uint16_t buttons) noexcept {
    (void)p_D;
    (void)buttons;
  }
  /// The last call: zero force. Whether it has left when this returns, or there never was any; if not, the
  /// device is free for who takes it over. Waits for that, where transfers hang for seconds; the guardian,
  /// who watches, does not wait so long.
  virtual bool stop() noexcept {
    write(Vec3::Zero());
    return true;
  }
  /// Writes so far whose force its motors could not give whole. The haptic thread, or once it has ended.
  virtual std::uint64_t cut_by_motors() const noexcept { return 0; }
  /// Returns what the user should know or do, a static text; empty where there is nothing to report. Any
  /// thread.
  virtual const char* status() const noexcept { return ""; }
};

}  // namespace palpate::client
