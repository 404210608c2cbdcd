#pragma once
#include <atomic>
#include <optional>
#include <vector>

#include "common/time.h"
#include "haptic_client/device/falcon_packets.h"
#include "haptic_client/device/usb_transport.h"

namespace palpate::client {

/// Phase of a Falcon on its way from the plug to the hand.
enum class FalconPhase : std::uint8_t {
  kClosed,     ///< not there, or not ours
  kProbe,      ///< open: does firmware answer?
  kBoot,       ///< the boot loader was reset and is asked for its sign of life
  kHandshake,  ///< it answered: ready for the image?
  kUpload,     ///< the image goes, echoed byte for byte
  kUnhomed,    ///< firmware runs; the grip must be pulled out and pushed in. No torque
  kReady,      ///< homed: positions are right, torques go
};

/// The states of a Novint Falcon and what is said to it in each; pure: time is an argument, the transport one
/// too. Never waits: call it every tick. Torques leave it only in kReady.
class FalconMachine {
 public:
  /// `firmware`: image for the boot loader; empty: only a device that has one already can be used.
  /// `frozen_fade`: how long encoders may stand still under force before it fades; 0: for ever.
  explicit FalconMachine(std::vector<std::byte> firmware, Time frozen_fade = Time::zero())
      : firmware_(std::move(firmware)), frozen_fade_(frozen_fade) {}

  /// Takes what came from the device and goes on.
  void poll(UsbTransport& port, Time now) noexcept;
  /// Sends the motors' command (DAC units), less where encoders stand still for too long; zero where the
  /// device is not ready. Whether it went: not while the last one is on the way, nor before firmware runs.
  bool command(UsbTransport& port, const std::array<std::int16_t, 3>& torque) noexcept;

  /// Sets the line as running firmware wants it.
  static void normal_mode(UsbTransport& port) noexcept;

  FalconPhase phase() const noexcept { return phase_; }
  /// A torque was sent, and no zero has left since: whatever became of the port, the motors may hold it.
  bool may_push() const noexcept { return may_push_; }
  /// A zero has left by another way.
  void note_at_rest() noexcept { may_push_ = false; }
  /// The newest status of a ready device, if it came in the last 50 ms.
  std::optional<FalconStatus> status(Time now) const noexcept;
  /// Returns the message for the user, a static text. Any thread.
  const char* message() const noexcept { return message_; }

 private:
  static constexpr std::size_t kChunk = 62;  // bytes of an image at once
  void enter(FalconPhase phase, Time now) noexcept;
  void take(UsbTransport& port, Time now) noexcept;
  void begin(UsbTransport& port, Time now) noexcept;
  void boot_mode(UsbTransport& port, Time now) noexcept;
  void probe(UsbTransport& port, Time now) noexcept;
  void boot(UsbTransport& port, Time now) noexcept;
  void handshake(UsbTransport& port, Time now) noexcept;
  void upload(UsbTransport& port, Time now) noexcept;
  void run(UsbTransport& port, Time now) noexcept;
  void watch_encoders(Time now) noexcept;
  void lose(UsbTransport& port, Time now) noexcept;
  void give_up(UsbTransport& port, Time now, Time wait, const char* message) noexcept;
  bool send(UsbTransport& port, std::span<const std::byte> bytes, Time now) noexcept;

  std::vector<std::byte> firmware_;
  Time frozen_fade_;
  double gain_ = 1;  // of the torques
  FalconPhase phase_ = FalconPhase::kClosed;
  std::atomic<const char*> message_{"looking for a Falcon"};
  struct Times {
    Time entered{}, sent{}, heard{}, moved{}, ran{}, retry_at{}, lost{};
  } times_;
  bool known_ = false;    // it was there once
  bool failing_ = false;  // it refused its firmware, and a line said so
  bool pushes_ = false;   // a torque that a hand feels
  bool may_push_ = false,
       zero_in_transit_ = false;  // the newest command, of no torque, may still be on the way
  bool requested_ = false;        // something was sent in this phase and its answer is due
  int tries_ = 0, loads_ = 0;     // of the phase; of the image
  std::size_t uploaded_ = 0;      // bytes
  std::array<std::byte, 512> answer_{};
  std::size_t answered_ = 0;
  FalconStream stream_;
  std::optional<FalconStatus> status_;
};

}  // namespace palpate::client
