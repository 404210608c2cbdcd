#pragma once
#include <array>
#include <span>

#include "common/damped_mode.h"
#include "haptic_client/extrapolation/extrapolator.h"
#include "haptic_client/extrapolation/modal_steps.h"
#include "haptic_client/extrapolation/relaxing_loads.h"
#include "haptic_client/extrapolation/surface_model.h"
#include "haptic_client/extrapolation/tick_memory.h"

namespace palpate::client {

/// What a tissue that swings remembers: its slow modes (protocol/surface_pages.h), stepped here between two
/// samples under the force that the tool puts on it. Each sample tells where they stood at its time; what
/// they are off by here, compared with what was so at that tick, goes on by itself from then to now, as the
/// motion is linear. How hard other tools drive them goes on along the line through the two newest samples.
/// Of a tissue that relaxes, what its modes and all the rest of it remember is stepped, too
/// (`RelaxingLoads`), and what a sample tells of the past is taken on to now likewise. Haptic
/// thread; only the constructor allocates, 5.1 MB. A tick takes about 0.5 us of 40
/// modes; a sample that is 36 ms old 10 us with all of `LocalContact`, of 80 ms 20, of 200 ms 45, at 500
/// ticks a second (ns_per_arrival of `haptic_client evaluate`): it sets right all ticks since.
class ModalMemory {
 public:
  /// How a point of the surface moves in the modes, 1/sqrt(kg).
  using Shapes = std::array<Vec3, kMostSlowModes>;

  ModalMemory();

  /// Where the modes stood at `t`, under the force `f` (N) on the tool. False where the surface is not known
  /// well enough, or these are no amplitudes of any organ: then it knows nothing any more.
  bool take(const Surface& surface, Time t, const Vec3& f) noexcept;
  /// Forgets all.
  void restart() noexcept;
  bool known() const noexcept { return known_; }
  bool stands() const noexcept { return standing_; }

  /// Stands on the vertex nearest to `p_rest` (m, in the frame of the surface at rest). False where the model
  /// does not know the shapes there.
  bool stand_near(const SurfaceModel& model, const Vec3& p_rest) noexcept;
  /// The force of the tool is borne by the surface as these loads are; none: where it stands.
  bool bear(const SurfaceModel& model, std::span<const SurfaceLoad> loads) noexcept;

  /// Goes on to the tick at `t`, under the force of the last.
  void advance(Time t) noexcept;
  /// The force on the tool at that tick, N, and the loads that it is about; remembers the tick.
  void press(const Vec3& f, std::span<const SurfaceLoad> loads = {}) noexcept;

  /// How far the modes, and what has crept, have moved the surface where it stands, m: at the tick of
  /// `advance`, or at the sample of `take`, whichever came last.
  Vec3 displacement() const noexcept { return at(present_) + crept_; }
  /// How far of that has crept, and the loads that would hold all of it there, N, on the compliance.
  const Vec3& crept() const noexcept { return crept_; }
  std::span<const SurfaceLoad> creeping() const noexcept { return loads_.creeping(); }
  /// How far a vertex has crept, m.
  Vec3 creep(const SurfaceModel& model, int vertex) const noexcept { return loads_.creep(model, vertex); }
  /// How much farther than foreseen the sample of `take` told it to be then, m; 0 where nothing was.
  Vec3 drift() const noexcept { return drift_; }
  /// And how much farther a vertex of these shapes, m.
  Vec3 warp(const Shapes& shapes) const noexcept {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < system_.count; ++k) sum += present_[k] * (shapes[k] - foot_[k]);
    return sum;
  }

 private:
  bool take_spectrum(const Surface& surface) noexcept;
  void take_series(const protocol::RelaxedState& told) noexcept;
  void take_loads(const protocol::ModalLoads& told, Time t) noexcept;
  bool take_told(const Surface& surface) noexcept;
  Vec3 at(const ModalNumbers& q) const noexcept;
  ModalNumbers force_of(const Vec3& f) const noexcept;
  ModalNumbers all_forces(Time t) const noexcept;
  ModalState now(Time t) const noexcept;
  ModalState soon(ModalState state, const ModalNumbers& force, Time rest) const noexcept;
  void begin(Time t, const Vec3& f) noexcept;
  void correct(ModalState& before, Time t) noexcept;
  void add(const ModalState& more, ModalState& state) const noexcept;
  void creep_at_foot() noexcept;

  bool known_ = false, standing_ = false;
  std::uint64_t version_ = 0, foot_version_ = 0;  // of the surface model that spectrum and foot are of
  ModalSystem system_;
  ModalSteps short_step_;
  std::size_t first_told_ = 0, end_told_ = 0;  // of the modes whose z the newest sample tells of
  RelaxingLoads loads_;
  const SurfaceModel* model_ = nullptr;  // of the newest sample
  int foot_vertex_ = 0;
  Vec3 crept_ = Vec3::Zero();  // where it stands, m
  Shapes foot_{}, bearing_{};
  Vec3 foot_at_ = Vec3::Zero();  // m, of `stand_near`
  ModalState state_, told_;      // at `time_`; of the newest sample
  ModalNumbers force_{};         // of the tool, held from the last tick on, N/sqrt(kg)
  /// How hard other tools drive the modes: along a line from the sample at `t` on.
  struct Trend {
    Time t{};
    ModalNumbers load{}, rate{};  // N/sqrt(kg), and a second
    double at(std::size_t mode, Time now) const noexcept;
  } others_, others_before_;
  bool driven_ = false;  // whether there are others
  Time time_{}, tick_{}, tick_before_{}, compared_{};
  ModalNumbers present_{};
  Vec3 drift_ = Vec3::Zero();
  TickMemory<ModalState> past_;  // as it is known by now
};

}  // namespace palpate::client
