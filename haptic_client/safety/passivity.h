#pragma once
#include <array>
#include <cstdint>

#include "common/time.h"
#include "common/types.h"

namespace palpate::client {

/// Counts of the passivity observer and its controller.
struct PassivityCounts {
  std::uint64_t damped = 0;    ///< ticks with injected damping
  std::uint64_t softened = 0;  ///< ticks with a gain below 1
  double largest_debt_j = 0;   ///< most energy owed, J
  double least_gain = 1;       ///< smallest gain
};

/// Time-domain passivity control (Hannaford and Ryu 2002, IEEE Trans. Robot. Autom. 18:1) that follows a
/// reference energy (Ryu, Preusche, Hannaford and Hirzinger 2005, IEEE Trans. Control Syst. Technol. 13:737).
///
/// Tissue is passive: what it gives back was stored in it. At the place of a sample, where the force F of the
/// tissue is known, its stored energy S is that of a spring of the compliance c that the samples show, cut at
/// the largest force: c F^2 / 2. The law, sampling and latency included, did the work A = sum of f . dx on
/// the handle by then, relative to a surface that moves by itself. Of a passive law A + S never grows; what
/// it grows by from one sample to the next is energy from nowhere, and is owed. So energy that the spring
/// stores is credit from the beginning, and contact that is entered or left by a soft start owes nothing. The
/// work of the limits after the law (fade, slew) is theirs, and is not counted here.
///
/// What is owed beyond the tolerated debt (and a tenth of the energy stored: what a compliance that changes
/// from place to place makes of S) is answered by damping that grows continuously up to a bound; its work
/// pays the debt. Only where damping is at its bound and the debt still stays (a wall too stiff for rate and
/// latency) does a gain on the force fall. Once the debt is paid the gain returns within 2 s, once: where it
/// must fall again within 20 s the wall itself is too stiff, and the gain recovers in 20 s, so that a limit
/// cycle gets one period of 2 s and no second. Nothing here makes a force jump. Pure; haptic thread only; no
/// allocation.
class Passivity {
 public:
  struct Settings {
    bool enabled = true;
    double debt =
        1e-3;  ///< J, [1e-6, 10]: what may be owed without an answer; damping is whole at half as much again
    double allowance = 1e-3;  ///< W, [0, 10]: power that a hand surely takes
    double damping = 10;      ///< N s/m, [0, 100]: bound of the injected damping, in the device frame
  };
  explicit Passivity(const Settings& settings) : settings_(settings) {}

  /// The handle came to where it is at `t` by `d_D` (m) within `dt` (s), under the forces given to `wrote`;
  /// the surface goes by itself at `surface_v_D` (m/s). Once a tick, first.
  void moved(Time t, const Vec3& d_D, const Vec3& surface_v_D, double dt) noexcept;
  /// A sample arrived: at time `t` of a tick the tool was at `p_D` (m) and the tissue's force was `f_D` (N),
  /// `max_force` (N) of it at most to be felt. In the order of time.
  void sampled(Time t, const Vec3& p_D, const Vec3& f_D, double max_force) noexcept;
  /// Nothing is compared across here: the force was off, or fades, or the samples before are too long ago.
  void restart() noexcept;

  /// Limits of this tick: `gain` (0, 1] on the law's force, and `damping` (N s/m).
  struct Ruling {
    double gain = 1, damping = 0;
  };
  Ruling rule(double dt) noexcept;
  /// The law's force of this tick, within the largest force (N), before gain and fade; and the damper's.
  void wrote(const Vec3& law_D, const Vec3& damper_D) noexcept {
    law_ = law_D;
    damper_ = damper_D;
  }

  /// Returns the gain on the law's force, (0, 1].
  double gain() const noexcept { return gain_; }
  /// Energy owed, J.
  double debt() const noexcept { return debt_; }
  const PassivityCounts& counts() const noexcept { return counts_; }

 private:
  static constexpr std::size_t kTicks = 2048;  // half a second at 4 kHz
  struct Tick {
    Time t{};
    double work = 0;
  };
  struct Reference {
    bool known = false;
    Vec3 p = Vec3::Zero(), f = Vec3::Zero();
    Time t{};
  };
  /// History of the gain, by which it returns quickly or slowly.
  struct Recovery {
    bool returned = false;  // quickly, by some of it, since it fell
    bool is_slow = false;   // it fell again after that
    double calm = 0;        // s, since it last fell
  };
  double recovery_rate(double pending, double dt) noexcept;
  const Tick* tick_at(Time t) const noexcept;
  void learn_compliance(const Reference& next) noexcept;
  double stored(double force, double max_force) const noexcept;
  void owe(double energy) noexcept;

  Settings settings_;
  Vec3 law_ = Vec3::Zero(), damper_ = Vec3::Zero();  // N, written last
  double work_ = 0;                                  // A, J
  std::array<Tick, kTicks> ticks_{};
  std::size_t count_ = 0;
  Reference last_;     // sample
  double excess_ = 0;  // A + S at the last sample whose S was known
  bool excess_known_ = false;
  double moment_ = 0, square_ = 0;            // of compliance: sums of -dp . df and df . df
  double scale_ = 0;                          // J, stored lately
  double debt_ = 0, gain_ = 1, damping_ = 0;  // J; shares
  Recovery recovery_;
  PassivityCounts counts_;
};

}  // namespace palpate::client
