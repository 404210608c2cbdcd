#include "haptic_client/device/devices.h"

#include <array>

namespace palpate::client {
namespace {

const Vec3 kRest(0, 0.1, 0);  // m: above the organ of the scenes that ship

std::unique_ptr<Device> make_simulated(const DeviceSettings& settings) {
  Trajectory path = settings.trajectory ? Trajectory(*settings.trajectory) : Trajectory({0}, {kRest});
  return std::make_unique<SimulatedOperator>(settings.hand, std::move(path));
}

DeviceLimits limits_of_simulated(const DeviceSettings& settings) {
  return {.max_force = settings.hand.max_force};
}

constexpr std::array kDevices{
    DeviceRow{"simulated", "a hand (mass, spring, damper) that follows a recorded motion",
              &limits_of_simulated, &make_simulated},
};

}  // namespace

std::span<const DeviceRow> devices() {
  return kDevices;
}

}  // namespace palpate::client
