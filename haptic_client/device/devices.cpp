#include "haptic_client/device/devices.h"

#include <array>

namespace palpate::client {
namespace {

std::unique_ptr<Device> make_simulated(const DeviceSettings& settings) {
  Trajectory path = settings.trajectory ? Trajectory(*settings.trajectory) : Trajectory({0}, {Vec3::Zero()});
  return std::make_unique<SimulatedOperator>(settings.hand, std::move(path));
}

constexpr std::array kDevices{
    DeviceRow{"simulated", "a hand (mass, spring, damper) that follows a recorded motion", &make_simulated},
};

}  // namespace

std::span<const DeviceRow> devices() {
  return kDevices;
}

}  // namespace palpate::client
