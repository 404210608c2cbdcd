#pragma once
#include "common/time.h"

namespace palpate::client {

/// When it is worth looking through the bus for a device: once at first; when something was plugged in; about
/// twice a second while one is there that cannot be used, or where the system does not tell of plugging.
class UsbLookout {
 public:
  /// `published`: the system tells when a device is plugged in.
  explicit UsbLookout(bool published) : published_(published) {}
  bool due(Time now) const noexcept { return now >= next_; }
  /// A device was plugged in, or ours was let go.
  void poll() noexcept { next_ = Time::min(); }
  /// `absent`: there was none; else there was one, but it could not be used.
  void failed(Time now, bool absent) noexcept { next_ = absent && published_ ? Time::max() : now + kAgain; }

 private:
  static constexpr Time kAgain = std::chrono::milliseconds(500);  // between two tries
  bool published_;
  Time next_ = Time::min();
};

}  // namespace palpate::client
