#include "haptic_client/device/spacemouse.h"

#include <algorithm>
#include <array>

namespace palpate::client {
namespace {

using namespace std::chrono_literals;

constexpr Time kIdle = 100ms;                                   // without a report: the cap is released
constexpr Time kOpenAgain = 500ms;                              // between two tries to open
constexpr std::uint8_t kHidToInterface = 0x21, kSetReport = 9;  // of HID

}  // namespace

SpaceMouse::SpaceMouse(std::unique_ptr<UsbTransport> port, const SpaceMouseSettings& settings)
    : port_(std::move(port)), settings_(settings) {}

SpaceMouse::~SpaceMouse() {
  light(false);
  port_->close();  // waits for the light
}

DeviceReading SpaceMouse::read(Time now) noexcept {
  advance(now);
  const bool there = keep_open(now);
  std::array<std::byte, kFullSpeedPacket> report;
  while (const std::size_t size = there ? port_->read(report) : 0) {
    if (take_spacemouse_report({report.data(), size}, state_)) heard_ = now;
  }
  return {.t = now, .p_D = p_D_, .buttons = state_.buttons, .valid = there};
}

/// The last report held until now, but not longer than the silence that counts as standing still.
void SpaceMouse::advance(Time now) noexcept {
  const Time end = std::min(now, heard_ + kIdle);
  if (end > last_) {
    p_D_ += to_seconds(end - last_) * settings_.speed * state_.push_D;
    p_D_ = p_D_.cwiseMax(-settings_.reach).cwiseMin(settings_.reach);
  }
  last_ = now;
}

bool SpaceMouse::keep_open(Time now) noexcept {
  if (port_->state() == UsbTransport::State::kLost) {
    const char* const why = port_->trouble();
    message_ = why[0] != 0 ? why : "the SpaceMouse was unplugged; plug it in again";
    port_->close();
    state_ = {};
    retry_at_ = now + kOpenAgain;
  }
  if (port_->state() != UsbTransport::State::kClosed) return true;
  if (now < retry_at_) return false;
  if (!port_->open(now)) {
    if (port_->trouble()[0] != 0) message_ = port_->trouble();
    return false;
  }
  light(true);
  message_ = "SpaceMouse ready: push its cap to where the tool shall go";
  return true;
}

void SpaceMouse::light(bool on) noexcept {
  const std::array report{std::byte{kSpaceMouseLight & 0xff}, std::byte{on}};
  port_->control({.type = kHidToInterface,
                  .request = kSetReport,
                  .value = kSpaceMouseLight,
                  .optional = true,
                  .data = report});
}

}  // namespace palpate::client
