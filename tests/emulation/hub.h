#pragma once
#include <cerrno>

#include "tests/emulation/usb_device.h"

namespace palpate::emulation {

/// A hub, so that devices have the parents, and programs the port paths, that they would have on a real
/// machine. It answers what enumeration asks and nothing else.
class Hub : public UsbDevice {
 public:
  explicit Hub(bool root) : root_(root) {}

  Bytes descriptors() const override {
    const auto id = [this](std::uint8_t root, std::uint8_t other) { return root_ ? root : other; };
    return {18,
            1,
            0x00,
            0x02,
            9,
            0,
            1,
            64,
            id(0x6b, 0x09),
            id(0x1d, 0x04),
            id(0x02, 0x5a),
            0,
            0x00,
            0x01,
            1,
            2,
            0,
            1,  // device
            9,
            2,
            25,
            0,
            1,
            1,
            0,
            0xe0,
            0,
            9,
            4,
            0,
            0,
            1,
            9,
            0,
            0,
            0,  // configuration, interface
            7,
            5,
            0x81,
            3,
            4,
            0,
            12};  // interrupt endpoint
  }
  std::string text(int index) const override {
    if (index == 1) return "Emulation";
    return index == 2 ? (root_ ? "Root hub" : "Hub") : "";
  }
  std::string kernel_driver() const override { return "hub"; }
  bool is_hub() const override { return true; }
  UsbResult request(const UsbSetup&, const Bytes&, double) override { return {-EPIPE, {}}; }
  int write(std::uint8_t, const Bytes&, double) override { return -EPIPE; }
  std::optional<UsbResult> read(std::uint8_t, std::size_t, double) override { return std::nullopt; }
  double wake_at(double) const override { return kNever; }
  void power_up(double) override {}
  std::string state(double) override { return "{}"; }

 private:
  bool root_;
};

}  // namespace palpate::emulation
