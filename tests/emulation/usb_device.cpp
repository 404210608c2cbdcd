#include "tests/emulation/usb_device.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace palpate::emulation {
namespace {

constexpr std::size_t kDeviceDescriptorSize = 18;
constexpr std::uint8_t kDirectionIn = 0x80;

/// A string descriptor: UTF-16, from ASCII.
Bytes string_descriptor(const std::string& text) {
  Bytes bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
  for (const char c : text) {
    bytes.push_back(static_cast<std::uint8_t>(c));
    bytes.push_back(0);
  }
  return bytes;
}

UsbResult cut(Bytes bytes, std::size_t length) {
  bytes.resize(std::min(bytes.size(), length));
  return {0, std::move(bytes)};
}

}  // namespace

double number(const std::string& word, double low, double high) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != 0 || !(value >= low && value <= high))
    throw CommandError("\"" + word + "\" is no number from " + std::to_string(low) + " to " +
                       std::to_string(high));
  return value;
}

UsbResult UsbDevice::descriptor(const UsbSetup& setup) const {
  const int kind = setup.value >> 8, index = setup.value & 0xff;
  const Bytes all = descriptors();
  if (kind == 1) return cut({all.begin(), all.begin() + kDeviceDescriptorSize}, setup.length);
  if (kind == 2 && index == 0) return cut({all.begin() + kDeviceDescriptorSize, all.end()}, setup.length);
  if (kind == 3 && index == 0) return cut({4, 3, 0x09, 0x04}, setup.length);  // English
  if (kind == 3 && !text(index).empty()) return cut(string_descriptor(text(index)), setup.length);
  return {-EPIPE, {}};
}

UsbResult UsbDevice::control(const UsbSetup& setup, const Bytes& data, double now) {
  constexpr std::uint8_t kGetStatus = 0, kClearFeature = 1, kGetDescriptor = 6, kGetConfiguration = 8,
                         kSetConfiguration = 9;
  if (setup.type == kDirectionIn && setup.request == kGetDescriptor) return descriptor(setup);
  if (setup.type == kDirectionIn && setup.request == kGetConfiguration) return cut({1}, setup.length);
  if (setup.type == kDirectionIn && setup.request == kGetStatus) return cut({0, 0}, setup.length);
  if (setup.type == 0 && setup.request == kSetConfiguration) return {};
  if (setup.type == 2 && setup.request == kClearFeature) return {};
  UsbResult result = request(setup, data, now);
  return result.status == 0 ? cut(std::move(result.data), setup.length) : result;
}

std::string UsbDevice::command(const std::string& verb, const Words& arguments, double now) {
  if (verb == "state") return state(now);
  if (verb != "fault" || arguments.empty() || arguments.size() > 2)
    throw CommandError("this device does not know \"" + verb + "\" with these arguments");
  set_fault(arguments[0], arguments.size() == 2 ? static_cast<int>(number(arguments[1], 0, 1e6)) : 1);
  return {};
}

void UsbDevice::set_fault(const std::string& name, int value) {
  if (name == "permission") {
    denied_ = value != 0;
  } else if (name == "busy") {
    busy_ = value != 0;
  } else {
    throw CommandError("no fault \"" + name + "\" for this device");
  }
}

}  // namespace palpate::emulation
