#pragma once
#include <functional>
#include <map>

#include "tests/emulation/falcon_mcu.h"
#include "tests/emulation/falcon_mechanics.h"
#include "tests/emulation/ft232r.h"

namespace palpate::emulation {

/// A Novint Falcon (0403:cb48): the chip on the bus, the microcontroller behind it, the mechanism, and a hand
/// on it.
class Falcon : public UsbDevice {
 public:
  struct Settings {
    bool wall = false;  ///< wall clock; else every I/O packet is `packet_time` of the mechanism's time
    double packet_time = 1e-3;  ///< s, [1e-4, 0.1]
    bool loaded = false;        ///< firmware in place at the start
    bool homed = false;         ///< references found at the start
    FalconMechanics::Settings mechanics = {};
  };
  explicit Falcon(const Settings& settings);

  Bytes descriptors() const override;
  std::string text(int index) const override;
  UsbResult request(const UsbSetup& setup, const Bytes& data, double now) override;
  int write(std::uint8_t endpoint, const Bytes& data, double now) override;
  std::optional<UsbResult> read(std::uint8_t endpoint, std::size_t size, double now) override;
  double wake_at(double now) const override;
  void advance(double now) override;
  void opened(double now) override;
  void power_up(double now) override;
  std::string command(const std::string& verb, const Words& arguments, double now) override;
  std::string state(double now) override;
  /// What the host asked of each motor in its last packet.
  const std::array<int, 3>& wished_dac() const { return wished_dac_; }

 protected:
  void set_fault(const std::string& name, int value) override;

 private:
  /// What a packet of the host does, and what the firmware replies.
  FalconPacket exchange(const FalconPacket& request);
  void record(const FalconPacket& request);
  std::vector<Bytes> receive(const Bytes& bytes, double baud);
  void move_hand(const Words& words);
  void set_hand(const std::string& key, double value);
  void pull_and_push(const std::string& what);
  void run_due();

  Settings settings_;
  FalconFaults faults_;
  FalconMechanics mechanics_;
  FalconMcu mcu_;
  Ft232r chip_;
  int buttons_ = 0, leds_ = 0, largest_dac_ = 0, largest_dac_unhomed_ = 0;
  std::array<int, 3> wished_dac_{}, frozen_{};
  std::uint64_t packets_ = 0, opens_ = 0, writes_ = 0;
  double mechanics_until_ = 0;                                       // s of the wall clock
  std::multimap<std::uint64_t, std::pair<std::string, Words>> due_;  // by packet number
};

}  // namespace palpate::emulation
