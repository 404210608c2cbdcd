#pragma once
#include <deque>
#include <functional>

#include "tests/emulation/falcon_faults.h"
#include "tests/emulation/usb_device.h"

namespace palpate::emulation {

/// The baud rate of an FTDI divisor: 3 MHz / (14 bits + eighths coded in bits 14 and 15). 0 and 1 mean 3 and
/// 2 Mbaud.
double baud_of_divisor(std::uint16_t divisor);

/// The 128 bytes of the chip's memory in a Falcon: its ids and names, as an FT232R keeps them.
Bytes eeprom_of_falcon();

/// FT232R: a USB bridge to a serial line. Every IN packet is at most 64 bytes and begins with two status
/// bytes. Data leaves when 62 bytes are there, or when the latency timer has run out since the packet before;
/// with a timer of 1 ms as soon as it is there. Without data the timer sends the status alone.
class Ft232r {
 public:
  /// What hangs on the serial line.
  struct Line {
    std::function<std::vector<Bytes>(const Bytes&, double baud)> receive;
    std::function<void(double baud)> set_baud;
    std::function<void(bool high)> set_dtr;
    std::function<bool()> clear_to_send;
  };
  /// `wall`: bytes take their time on the line, and data its 1 ms frame on the bus.
  Ft232r(FalconFaults& faults, Line line, bool wall) : faults_(faults), line_(std::move(line)), wall_(wall) {}

  UsbResult request(const UsbSetup& setup, double now);
  void write(const Bytes& data, double now);
  std::optional<UsbResult> read(std::size_t size, double now);
  double wake_at() const;
  /// Bytes that nobody asked for: they wait for the next read.
  void put(const Bytes& bytes, double now);
  void power_up();

  double baud() const { return baud_; }
  double latency() const { return latency_; }
  std::size_t waiting() const { return fifo_.size(); }

 private:
  struct Byte {
    std::uint8_t value;
    bool last;     // the IN packet ends here
    double ready;  // s
  };
  void answer(const Bytes& bytes, double received, double now);
  std::size_t ready_bytes(double now) const;
  void append_packet(Bytes& transfer, double now);
  void append_status(Bytes& transfer) const;
  bool set(const UsbSetup& setup);

  FalconFaults& faults_;
  const Bytes eeprom_ = eeprom_of_falcon();
  Line line_;
  bool wall_;
  std::deque<Byte> fifo_;
  double baud_ = 9600, latency_ = 0.016;  // baud, s
  double last_sent_ = 0, line_free_ = 0;  // s
  int flooded_ = 0;
};

}  // namespace palpate::emulation
