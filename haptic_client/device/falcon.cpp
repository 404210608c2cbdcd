#include "haptic_client/device/falcon.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include "common/clock.h"
#include "common/error.h"
#include "haptic_client/device/falcon_kinematics.h"

namespace palpate::client {
namespace {

/// Waits until everything is through, half a second at most.
void drain(UsbTransport& port) noexcept {
  constexpr int kRounds = 250;  // of 2 ms: half a second
  const Time round = std::chrono::milliseconds(2);
  std::array<std::byte, 64> ignored;
  for (int i = 0; i < kRounds && port.state() == UsbTransport::State::kBusy; ++i) {
    while (port.read(ignored) > 0) {
    }
    sleep_until(now() + round);
  }
}

/// Zero torque, three times, and that it left; closes the port.
bool send_zero(UsbTransport& port) {
  constexpr int kTimes = 3;  // as nothing checks the answers
  FalconMachine::normal_mode(port);
  for (int i = 0; i < kTimes; ++i) {
    drain(port);
    port.write(encode_falcon({.red = true}));
  }
  drain(port);
  const bool sent = port.state() == UsbTransport::State::kIdle;
  port.close();
  return sent;
}

/// True of what a text is made of. Bytes of UTF-8 beyond ASCII are found in images as well.
bool is_text(char byte) {
  return (byte >= ' ' && byte <= '~') || byte == '\n' || byte == '\r' || byte == '\t';
}

}  // namespace

std::vector<std::byte> read_firmware(const std::filesystem::path& file) {
  constexpr std::size_t kLeast = 1024, kMost = 65536;  // bytes: beyond, it is the wrong file
  std::error_code ignored;                             // a pipe would wait for a writer, a device has no end
  const bool is_file = std::filesystem::is_regular_file(file, ignored);
  std::ifstream in;
  if (is_file) in.open(file, std::ios::binary);
  if (!is_file || !in)
    fail("{}: no such firmware image; Palpate ships none, it belongs to the maker of the device",
         file.string());
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.size() < kLeast || bytes.size() > kMost)
    fail("{}: has {} bytes; a firmware image of the Falcon has {} to {}", file.string(), bytes.size(), kLeast,
         kMost);
  if (std::ranges::all_of(bytes, is_text))
    fail(
        "{}: is a text, a web page perhaps, and no firmware image of the Falcon, which is binary; download "
        "the image "
        "itself",
        file.string());
  std::vector<std::byte> image;
  for (const char byte : bytes) image.push_back(static_cast<std::byte>(byte));
  return image;
}

Silenced silence_falcons(UsbPorts ports, const std::function<void(UsbPorts&)>& add_new) {
  constexpr int kTriesALook = 10;  // 10 ms apart: new ports are searched for ten times a second
  Silenced silenced;
  const Time end = now() + std::chrono::seconds(1);
  for (int i = 0; !ports.empty() || add_new; ++i) {
    const bool last = now() >= end;  // begun after that, as a port that hangs may have taken all of it
    if (i > 0) sleep_until(now() + std::chrono::milliseconds(10));
    if (add_new && i % kTriesALook == 0) add_new(ports);
    const Time polls = now() + i * std::chrono::seconds(1);  // it looks each time, not twice a second
    silenced.falcons += static_cast<int>(std::erase_if(ports, [&](const std::unique_ptr<UsbTransport>& port) {
      return port->open(polls) && send_zero(*port);
    }));
    if (last) break;
  }
  silenced.held = static_cast<int>(ports.size());
  return silenced;
}

Falcon::Falcon(std::unique_ptr<UsbTransport> port, std::vector<std::byte> firmware, double torque_constant,
               double frozen_fade)
    : port_(std::move(port)),
      machine_(std::move(firmware), from_seconds(frozen_fade)),
      torque_constant_(torque_constant),
      p_D_(falcon::kCentre) {}

Falcon::~Falcon() {
  if (!handed_over_) Falcon::stop();
  port_->close();
}

/// Sends what is on the way first: a port takes one transfer at a time. Tries until the zero that follows it
/// has left, four times at most.
bool Falcon::stop() noexcept {
  constexpr int kTimes = 4;  // of a second at most, by `drain`
  bool left = false;
  for (int i = 0; i < kTimes && !left; ++i) {
    drain(*port_);
    const bool went = machine_.command(*port_, {0, 0, 0});
    drain(*port_);
    left = went && port_->state() == UsbTransport::State::kIdle;
  }
  if (left) machine_.note_at_rest();
  handed_over_ = machine_.may_push() && !stop_after_fault();
  return !handed_over_;
}

/// A transfer failed under force, and the port is closed by now, or about to be: it is opened anew.
bool Falcon::stop_after_fault() noexcept {
  constexpr int kTimes = 5;  // 10 ms apart
  for (int i = 0; i < kTimes; ++i) {
    if (i > 0) sleep_until(now() + std::chrono::milliseconds(10));
    port_->close();
    if (!port_->open(now() + i * std::chrono::seconds(1)) || !send_zero(*port_)) continue;
    machine_.note_at_rest();
    return true;
  }
  return false;
}

DeviceReading Falcon::read(Time now) noexcept {
  machine_.poll(*port_, now);
  DeviceReading reading{.t = now, .p_D = p_D_, .valid = false};
  valid_ = false;
  const auto status = machine_.status(now);
  if (!status) return reading;
  Vec3 angles;
  for (int i = 0; i < 3; ++i) angles[i] = falcon::angle_of(status->encoder[static_cast<std::size_t>(i)]);
  auto p = falcon::grip_position(angles, p_D_);
  if (!p) p = falcon::grip_position(angles, falcon::kCentre);  // too far from the last place
  if (!p) return reading;
  p_D_ = *p;
  valid_ = true;
  return {.t = now, .p_D = p_D_, .buttons = status->buttons, .valid = true};
}

void Falcon::write(const Vec3& f_D) noexcept {
  const Vec3 dac = valid_ ? falcon::motor_commands(f_D, p_D_, torque_constant_) : Vec3(Vec3::Zero());
  std::array<std::int16_t, 3> torque{};
  for (int i = 0; i < 3; ++i)
    torque[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(std::lround(dac[i]));
  cut_ += std::lround(dac.cwiseAbs().maxCoeff()) >= kFalconMaxTorque ? 1 : 0;
  machine_.command(*port_, torque);
}

}  // namespace palpate::client
