#pragma once
#include <optional>

#include "haptic_client/calibration/grip_holder.h"
#include "haptic_client/calibration/weighing.h"
#include "haptic_client/device/device.h"
#include "haptic_client/safety/limiter.h"

namespace palpate::client {

/// Stages of a calibration, in this order.
enum class CalibrationStage : std::uint8_t {
  kHome,       ///< the device has no position yet
  kCentre,     ///< brings the grip to the middle, waits until it rests
  kWeighGrip,  ///< swings it
  kHang,       ///< waits for the weight, until both rest
  kWeighBoth,  ///< swings both
  kLetDown,    ///< it is decided; the force fades
  kEnd,        ///< no force
};

/// Why there is no result.
enum class CalibrationTrouble : std::uint8_t {
  kNone,
  kNotHomed,     ///< no position within two minutes
  kNotMoved,     ///< the grip did not come to the middle
  kHeld,         ///< a hand did not let it go
  kUnsteady,     ///< the readings did not agree
  kNoWeight,     ///< the force did not change as it must
  kImplausible,  ///< no device has the constant that would follow: another weight hangs there
  kTooHeavy,     ///< all the force there is does not lift the weight
  kLost,         ///< the device gave no position for more than a second
  kOscillates    ///< the limiter switched the force off
};

/// State of a running calibration, for its display.
struct CalibrationProgress {
  CalibrationStage stage = CalibrationStage::kHome;
  bool held = false;     ///< a hand is on the grip
  double newton = 0;     ///< force asked of the device
  double seconds = 120;  ///< left of this stage
};

/// Finds the torque constant of a device that stands upright with a known weight: holds the grip in the
/// middle without and with it. The difference of the two forces, in newtons as `assumed` has them, must be m
/// g. Nothing else enters: the weight of the grip is in both. The state machine takes time and position and
/// returns a force, which the limiter has passed last; no clock, no device inside. Haptic thread only.
class Calibration {
 public:
  struct Settings {
    double mass = 0.2;  ///< kg, of the weight, [0.05, 0.5]
    double assumed =
        2300;  ///< torque constant the device's driver works with, DAC units per N m. Take the
               ///< lowest plausible one, so that the true force is no larger than the one asked for
    Limiter::Settings limits = {};  ///< its largest force is also the most that the grip is held with
    Vec3 centre_D{0, 0, 0.11};      ///< m: where the grip is held
  };
  static constexpr double kGravity = 9.80665;  ///< m/s2

  /// DAC units per N m that are plausible.
  static constexpr double kLowestTorqueConstant = 2300, kHighestTorqueConstant = 10000;

  explicit Calibration(const Settings& settings);

  /// Advances by one tick and returns the force (N, device frame) to write.
  Vec3 tick(const DeviceReading& reading) noexcept;

  CalibrationProgress progress() const noexcept;
  bool ended() const noexcept { return stage_ == CalibrationStage::kEnd; }

  /// The rest once it has ended. Without trouble there is a result:
  CalibrationTrouble trouble() const noexcept { return trouble_; }
  /// DAC units per N m.
  double torque_constant() const noexcept;
  /// Share of it: by how much the repeated readings differ.
  double uncertainty() const noexcept;
  /// rad: between the force that the weight takes and straight up.
  double tilt() const noexcept;
  /// N as assumed: what the weight takes; as far as that is known, also in trouble.
  Vec3 difference() const noexcept { return force_ - grip_.force(); }
  /// kg: the largest mass that does for a device of any plausible torque constant, in trouble too.
  double largest_mass() const noexcept;

 private:
  void enter(CalibrationStage stage) noexcept;
  void end(CalibrationTrouble trouble) noexcept;
  Vec3 lose(double elapsed) noexcept;
  void find(const Vec3& p_D) noexcept;
  void step(const Vec3& p_D, const Vec3& f_D, double dt) noexcept;
  void give_up_in_time() noexcept;
  bool weight_is_there() const noexcept;
  bool is_plausible() const noexcept;
  Vec3 goal() const noexcept;

  Settings settings_;
  Limiter limiter_;
  GripHolder holder_;
  Weighing grip_, both_;
  CalibrationStage stage_ = CalibrationStage::kHome;
  CalibrationTrouble trouble_ = CalibrationTrouble::kNone;
  std::optional<Time> last_;   // tick
  bool holds_ = false;         // the grip, since the last tick
  double lost_ = 0;            // s: without a position until now
  double in_stage_ = 0;        // s
  Vec3 force_ = Vec3::Zero();  // N: filtered while the weight is awaited, then weighed
  double newton_ = 0;
};

}  // namespace palpate::client
