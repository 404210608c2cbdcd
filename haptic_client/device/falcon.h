#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "haptic_client/device/device.h"
#include "haptic_client/device/falcon_machine.h"

namespace palpate::client {

/// `[falcon]` of the client file.
struct FalconSettings {
  std::filesystem::path firmware;  ///< image for the boot loader; empty: the device must have one already
  /// DAC units per N m of leg torque, [100, 50000]. Uncertain by 2 to 4 times from device to device: begin
  /// low.
  double torque_constant = 2300;
  /// s, [0.5, 3600]: how long encoders may stand still under force before it fades in 1 s; 0: for ever.
  double frozen_fade = 0;
};

/// Bytes of a firmware image. Throws `Error` when it cannot be read or cannot be one (1 kB to 64 kB).
std::vector<std::byte> read_firmware(const std::filesystem::path& file);

inline constexpr std::array kFalconIds{UsbId{0x0403, 0xcb48}};

using UsbPorts = std::vector<std::unique_ptr<UsbTransport>>;

/// Number of Falcons whose force was set to zero, and of those that were not free or did not accept it.
struct Silenced {
  int falcons = 0, held = 0;
};

/// Opens Falcons that another process may just have left, each as soon as it is free (one that is held does
/// not keep the others waiting), sends each zero torque and closes it again. `add_new`: looks, ten times, for
/// more, also where others had their zero: one that is just being enumerated again is there soon. A second in
/// all, at most, and what transfers take.
Silenced silence_falcons(UsbPorts ports, const std::function<void(UsbPorts&)>& add_new = {});

/// A Novint Falcon: grip position in m in its own frame (x right, y up, z out towards the user), force of its
/// three motors. No force before it is homed. One USB exchange a tick, which overlaps the tick: the position
/// is what answered the command of the tick before.
class Falcon : public Device {
 public:
  Falcon(std::unique_ptr<UsbTransport> port, std::vector<std::byte> firmware, double torque_constant,
         double frozen_fade = 0);
  ~Falcon() override;
  DeviceReading read(Time now) noexcept override;
  void write(const Vec3& f_D) noexcept override;
  bool stop() noexcept override;
  std::uint64_t cut_by_motors() const noexcept override { return cut_; }
  const char* status() const noexcept override { return machine_.message(); }

 private:
  bool stop_after_fault() noexcept;

  std::unique_ptr<UsbTransport> port_;
  FalconMachine machine_;
  double torque_constant_;
  Vec3 p_D_;
  bool handed_over_ = false;  // its zero did not leave: who takes it over needs the port
  bool valid_ = false;
  std::uint64_t cut_ = 0;
};

}  // namespace palpate::client
