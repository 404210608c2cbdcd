#include "tests/emulation/falcon.h"

#include <algorithm>
#include <cerrno>

namespace palpate::emulation {
namespace {

constexpr std::uint8_t kIn = 0x81, kOut = 0x02;

}  // namespace

Falcon::Falcon(const Settings& settings)
    : settings_(settings),
      mechanics_(settings.mechanics),
      mcu_(faults_, [this](const FalconPacket& request) { return exchange(request); }),
      chip_(faults_,
            {[this](const Bytes& bytes, double baud) { return receive(bytes, baud); },
             [this](double baud) { mcu_.set_baud(baud); },
             [this](bool high) {
               const auto before = mcu_.resets();
               mcu_.set_dtr(high);
               if (mcu_.resets() != before) mechanics_.power_up();
             },
             [this] { return mcu_.ready(); }},
            settings.wall) {
  if (settings.loaded) mcu_.start_firmware();
  if (settings.homed) mechanics_.home_now();
}

Bytes Falcon::descriptors() const {
  return {18, 1, 0x00, 0x02, 0,  0,    0,    8,    0x03, 0x04, 0x48, 0xcb, 0x00, 0x06, 1, 2, 0, 1,  // device
          9,  2, 32,   0,    1,  1,    0,    0xa0, 45,                                // configuration
          9,  4, 0,    0,    2,  0xff, 0xff, 0xff, 2,                                 // interface
          7,  5, kIn,  2,    64, 0,    0,    7,    5,    kOut, 2,    64,   0,    0};  // bulk endpoints
}

std::string Falcon::text(int index) const {
  if (index == 1) return "FTDI";
  return index == 2 ? "FALCON HAPTIC" : "";
}

UsbResult Falcon::request(const UsbSetup& setup, const Bytes&, double now) {
  return chip_.request(setup, now);
}

int Falcon::write(std::uint8_t endpoint, const Bytes& data, double now) {
  if (endpoint != kOut) return -EPIPE;
  advance(now);
  ++writes_;
  chip_.write(data, now);
  return 0;
}

std::optional<UsbResult> Falcon::read(std::uint8_t endpoint, std::size_t size, double now) {
  if (endpoint != kIn) return UsbResult{-EPIPE, {}};
  return chip_.read(size, now);
}

double Falcon::wake_at(double) const {
  return chip_.wake_at();
}

void Falcon::advance(double now) {
  if (settings_.wall) mechanics_.advance(std::min(now - mechanics_until_, 1.0));
  mechanics_until_ = now;
}

void Falcon::opened(double now) {
  ++opens_;
  const Bytes old = encode({{100, 200, 300}, 0, 0});
  for (int i = 0; i < faults_.stale; ++i) chip_.put({old[static_cast<std::size_t>(i) % old.size()]}, now);
}

void Falcon::power_up(double now) {
  chip_.power_up();
  mcu_.power_up();
  mechanics_.power_up();
  mechanics_until_ = now;
  leds_ = 0;
}

std::vector<Bytes> Falcon::receive(const Bytes& bytes, double baud) {
  std::vector<Bytes> messages = mcu_.receive(bytes, baud);
  if (!mcu_.running() || faults_.garbage == 0) return messages;
  for (Bytes& message : messages) {
    Bytes garbage;
    for (int i = 0; i < faults_.garbage; ++i) garbage.push_back(static_cast<std::uint8_t>(0x80 + i % 0x40));
    message.insert(message.begin(), garbage.begin(), garbage.end());
  }
  return messages;
}

void Falcon::record(const FalconPacket& request) {
  ++packets_;
  int largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    wished_dac_[i] = request.numbers[i];
    largest = std::max(largest, std::abs(wished_dac_[i]));
  }
  largest_dac_ = std::max(largest_dac_, largest);
  if (mechanics_.homed() != 7) largest_dac_unhomed_ = std::max(largest_dac_unhomed_, largest);
}

FalconPacket Falcon::exchange(const FalconPacket& request) {
  run_due();
  record(request);
  leds_ = request.flags & (kGreenBit | kBlueBit | kRedBit);
  mechanics_.set_homing(request.flags & kHomingBit);
  mechanics_.set_dac(wished_dac_);
  if (!settings_.wall) mechanics_.advance(settings_.packet_time);
  if (faults_.freeze == 0) frozen_ = mechanics_.encoders();
  FalconPacket reply;
  for (std::size_t i = 0; i < 3; ++i) reply.numbers[i] = static_cast<std::int16_t>(frozen_[i]);
  reply.flags =
      static_cast<std::uint8_t>((mechanics_.homed() << kHomedShift) | static_cast<unsigned>(buttons_));
  return reply;
}

void Falcon::set_fault(const std::string& name, int value) {
  for (const FalconFault& fault : kFalconFaults) {
    if (name != fault.name) continue;
    faults_.*fault.value = value;
    return;
  }
  UsbDevice::set_fault(name, value);
}

}  // namespace palpate::emulation
