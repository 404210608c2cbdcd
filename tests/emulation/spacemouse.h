#pragma once
#include <array>
#include <deque>

#include "tests/emulation/usb_device.h"

namespace palpate::emulation {

/// A 3Dconnexion 6-DoF mouse. `kTwoReports`: 046d:c626, translation and rotation in two reports of 7 bytes;
/// `kOneReport`: 256f:c62e, all six in one of 13; `kReceiver`: 256f:c62f, the same behind an interface of the
/// maker's own that has an endpoint too. Reports come every 8 ms while it is deflected, once more
/// with zeros when it is released, and report 3 (buttons) when they change.
class SpaceMouse : public UsbDevice {
 public:
  enum class Layout { kTwoReports, kOneReport, kReceiver };
  explicit SpaceMouse(Layout layout) : layout_(layout) {}

  Bytes descriptors() const override;
  std::string text(int index) const override;
  std::string kernel_driver() const override { return "usbhid"; }
  int interface() const override { return layout_ == Layout::kReceiver ? 1 : 0; }
  UsbResult request(const UsbSetup& setup, const Bytes& data, double now) override;
  int write(std::uint8_t endpoint, const Bytes& data, double now) override;
  std::optional<UsbResult> read(std::uint8_t endpoint, std::size_t size, double now) override;
  double wake_at(double now) const override;
  void power_up(double now) override;
  std::string command(const std::string& verb, const Words& arguments, double now) override;
  std::string state(double now) override;

 private:
  bool deflected() const;
  void sample();
  Bytes axes_report(std::uint8_t id, std::size_t first, std::size_t count) const;

  Layout layout_;
  std::array<int, 6> axes_{};  // tx ty tz rx ry rz, raw, +-350 nominal
  int buttons_ = 0;
  bool led_ = false, released_ = true;
  std::deque<Bytes> reports_;
  double next_sample_ = 0;  // s
  std::uint64_t sent_ = 0;
};

}  // namespace palpate::emulation
