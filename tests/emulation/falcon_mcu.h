#pragma once
#include <functional>
#include <vector>

#include "tests/emulation/falcon_faults.h"
#include "tests/emulation/falcon_packet.h"

namespace palpate::emulation {

/// The Falcon's microcontroller as its serial line shows it: a boot loader, and the firmware that it loads.
///
/// Boot loader: at 9600 baud `0A 43 0D` is answered by `0A 44 2C 0D`; then at 142857 baud `41` is echoed, and
/// every byte of the image is. The firmware starts when the line goes to 1.5 Mbaud after at least 4096 bytes;
/// it is lost when DTR rises (reset) and at power-up. Bytes at another baud rate are not understood.
class FalconMcu {
 public:
  /// Takes the host's packet, returns the reply.
  using Exchange = std::function<FalconPacket(const FalconPacket&)>;
  FalconMcu(FalconFaults& faults, Exchange exchange) : faults_(faults), exchange_(std::move(exchange)) {}

  /// Bytes from the host; returns the answers in order, each one message.
  std::vector<Bytes> receive(const Bytes& bytes, double baud);
  void set_dtr(bool high);
  /// The line's speed (baud): how the firmware is started after its image.
  void set_baud(double baud);
  void power_up();
  /// Starts as if an image had been loaded.
  void start_firmware() { mode_ = Mode::kRunning; }

  bool running() const { return mode_ == Mode::kRunning; }
  /// The loader has answered a greeting and waits: the modem line CTS.
  bool ready() const { return mode_ == Mode::kGreeted || mode_ == Mode::kLoading; }
  /// The image as far as it has been loaded.
  const Bytes& image() const { return image_; }
  std::uint64_t resets() const { return resets_; }

 private:
  enum class Mode { kWaiting, kGreeted, kLoading, kRunning };
  void greet(std::uint8_t byte, std::vector<Bytes>& answers);
  void load(const Bytes& bytes, std::vector<Bytes>& answers);
  void run(const Bytes& bytes, std::vector<Bytes>& answers);

  FalconFaults& faults_;
  Exchange exchange_;
  Mode mode_ = Mode::kWaiting;
  bool dtr_ = false, spoiled_ = false;  // spoiled: this load has failed, its image will not start
  bool corrupting_ = false, failing_ = false;
  Bytes greeting_, image_;
  FalconPacketParser parser_;
  std::uint64_t resets_ = 0;
};

}  // namespace palpate::emulation
