#include "tests/emulation/spacemouse.h"

#include <algorithm>
#include <cerrno>

#include "tests/emulation/json.h"

namespace palpate::emulation {
namespace {

constexpr std::uint8_t kIn = 0x81;
constexpr std::uint8_t kOwnIn = 0x82;  // of a receiver's other interface: never has data
constexpr double kInterval = 0.008;    // s

struct UsbId {
  int vendor, product;
};

void put_two(Bytes& bytes, int number) {
  bytes.push_back(static_cast<std::uint8_t>(number & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(number >> 8));
}

/// A report descriptor: a multi-axis controller (page 1, usage 8) with two input reports of three axes, or
/// one of six, buttons in report 3 and the LED in output report 4.
Bytes report_descriptor(bool one_report) {
  Bytes bytes{0x05, 0x01, 0x09, 0x08, 0xa1, 0x01, 0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01, 0x75, 0x10};
  const std::uint8_t first = one_report ? 6 : 3;
  for (std::uint8_t id = 1, usage = 0x30; usage < 0x36; ++id) {
    bytes.insert(bytes.end(), {0x85, id});
    for (int i = 0; i < first; ++i) bytes.insert(bytes.end(), {0x09, usage++});
    bytes.insert(bytes.end(), {0x95, first, 0x81, 0x06});
  }
  bytes.insert(bytes.end(), {0x85, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x10, 0x15, 0x00, 0x25,
                             0x01, 0x75, 0x01, 0x95, 0x10, 0x81, 0x02, 0x85, 0x04, 0x05, 0x08,
                             0x09, 0x4b, 0x75, 0x01, 0x95, 0x08, 0x91, 0x02, 0xc0});
  return bytes;
}

}  // namespace

Bytes SpaceMouse::descriptors() const {
  const bool one = layout_ != Layout::kTwoReports, receiver = layout_ == Layout::kReceiver;
  const UsbId id = one ? UsbId{0x256f, receiver ? 0xc62f : 0xc62e} : UsbId{0x046d, 0xc626};
  Bytes bytes{18, 1, 0x00, 0x02, 0, 0, 0, 8};  // device
  for (const int number : {id.vendor, id.product, 0x0431}) put_two(bytes, number);
  bytes.insert(bytes.end(), {1, 2, 0, 1});
  bytes.insert(bytes.end(), {9, 2});  // configuration
  put_two(bytes, receiver ? 50 : 34);
  bytes.insert(bytes.end(), {static_cast<std::uint8_t>(receiver ? 2 : 1), 1, 0, 0x80, 50});
  if (receiver) {  // an interface of the maker's own, with an interrupt endpoint
    bytes.insert(bytes.end(), {9, 4, 0, 0, 1, 0xff, 0, 0, 0});
    bytes.insert(bytes.end(), {7, 5, kOwnIn, 3, 16, 0, 8});
  }
  const auto number = static_cast<std::uint8_t>(interface()),
             size = static_cast<std::uint8_t>(report_descriptor(one).size());
  bytes.insert(bytes.end(), {9, 4, number, 0, 1, 3, 0, 0, 0});            // interface: HID
  bytes.insert(bytes.end(), {9, 0x21, 0x10, 0x01, 0, 1, 0x22, size, 0});  // HID
  bytes.insert(bytes.end(), {7, 5, kIn, 3, 16, 0, 8});                    // interrupt endpoint, 8 ms
  return bytes;
}

std::string SpaceMouse::text(int index) const {
  if (index == 1) return "3Dconnexion";
  if (index != 2) return "";
  switch (layout_) {
    case Layout::kTwoReports:
      return "SpaceNavigator";
    case Layout::kOneReport:
      return "SpaceMouse Wireless";
    case Layout::kReceiver:
      return "SpaceMouse Wireless Receiver";
  }
  return "";
}

UsbResult SpaceMouse::request(const UsbSetup& setup, const Bytes& data, double) {
  constexpr std::uint8_t kGetDescriptor = 6, kSetReport = 9, kSetIdle = 10;
  if (setup.type == 0x81 && setup.request == kGetDescriptor && setup.value >> 8 == 0x22)
    return {0, report_descriptor(layout_ != Layout::kTwoReports)};
  if (setup.type == 0x21 && setup.request == kSetIdle) return {};
  if (setup.type != 0x21 || setup.request != kSetReport || setup.value != 0x0204) return {-EPIPE, {}};
  if (data.empty() || setup.index != interface()) return {-EPIPE, {}};
  led_ = data.back() != 0;  // with or without the report's number before it
  return {};
}

int SpaceMouse::write(std::uint8_t, const Bytes&, double) {
  return -EPIPE;
}

bool SpaceMouse::deflected() const {
  return std::ranges::any_of(axes_, [](int axis) { return axis != 0; });
}

Bytes SpaceMouse::axes_report(std::uint8_t id, std::size_t first, std::size_t count) const {
  Bytes report{id};
  for (std::size_t i = first; i < first + count; ++i) {
    const auto bits = static_cast<std::uint16_t>(axes_[i]);
    report.push_back(static_cast<std::uint8_t>(bits & 0xff));
    report.push_back(static_cast<std::uint8_t>(bits >> 8));
  }
  return report;
}

void SpaceMouse::sample() {
  if (!deflected() && released_) return;
  released_ = !deflected();
  if (layout_ != Layout::kTwoReports) {
    reports_.push_back(axes_report(1, 0, 6));
  } else {
    reports_.push_back(axes_report(1, 0, 3));
    reports_.push_back(axes_report(2, 3, 3));
  }
}

std::optional<UsbResult> SpaceMouse::read(std::uint8_t endpoint, std::size_t size, double now) {
  if (endpoint == kOwnIn) return std::nullopt;
  if (endpoint != kIn) return UsbResult{-EPIPE, {}};
  if (now < next_sample_) return std::nullopt;
  if (reports_.empty()) sample();
  if (reports_.empty()) return std::nullopt;
  UsbResult result{0, reports_.front()};
  reports_.pop_front();
  ++sent_;
  if (reports_.empty()) next_sample_ = now + kInterval;
  if (result.data.size() > size) {
    result.data.resize(size);
    result.status = -EOVERFLOW;
  }
  return result;
}

double SpaceMouse::wake_at(double now) const {
  const bool something = !reports_.empty() || deflected() || !released_;
  return something ? std::max(next_sample_, now) : kNever;
}

void SpaceMouse::power_up(double now) {
  reports_.clear();
  led_ = false;
  released_ = true;
  next_sample_ = now;
}

std::string SpaceMouse::command(const std::string& verb, const Words& arguments, double now) {
  if (verb == "mouse") {
    if (arguments.size() != 6) throw CommandError("expected mouse DEVICE TX TY TZ RX RY RZ");
    for (std::size_t i = 0; i < 6; ++i) axes_[i] = static_cast<int>(number(arguments[i], -32768, 32767));
    if (deflected()) released_ = false;
    return {};
  }
  if (verb != "buttons") return UsbDevice::command(verb, arguments, now);
  if (arguments.size() != 1) throw CommandError("expected buttons DEVICE MASK (0 to 65535)");
  buttons_ = static_cast<int>(number(arguments[0], 0, 65535));
  reports_.push_back(
      {3, static_cast<std::uint8_t>(buttons_ & 0xff), static_cast<std::uint8_t>(buttons_ >> 8)});
  return {};
}

std::string SpaceMouse::state(double now) {
  JsonLine json;
  json.add("axes", axes_);
  json.add("buttons", static_cast<double>(buttons_));
  json.add("led", led_);
  json.add("reports", static_cast<double>(sent_));
  json.add("time", now);
  return json.text();
}

}  // namespace palpate::emulation
