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

/// State of a body in motion on the client: its slow modes (protocol/surface_pages.h), stepped between two
/// samples under the force of the tool. Each sample contains the modal state at its time. Its difference from
/// the state at that tick is advanced from then to now by itself, as the motion is linear. The loads of other
/// tools on the modes are extrapolated along the line through the two newest samples. For tissue that
/// relaxes, the viscous memory of its modes and of the residual compliance is stepped, too (`RelaxingLoads`),
/// and corrected likewise. Haptic thread; only the constructor allocates, 5.1 MB. A tick takes about 0.5 us
/// with 40 modes. A sample, with all of `LocalContact`, takes 10 us at an age of 36 ms, 20 us at 80 ms, 45 us
/// at 200 ms. These are for 500 ticks a second (ns_per_arrival of `haptic_client evaluate`): a sample
/// corrects all ticks since.
class ModalMemory {
 public:
  /// Mode shapes at a point of the surface, 1/sqrt(kg).
  using Shapes = std::array<Vec3, kMaxPublishedModes>;

  ModalMemory();

  /// Takes the modal state at `t`, under the force `f` (N) on the tool. Returns false where the surface is
  /// not known well enough, or where these are no amplitudes of any organ: the state is then unknown.
  bool take(const Surface& surface, Time t, const Vec3& f) noexcept;
  /// Forgets all.
  void restart() noexcept;
  bool known() const noexcept { return known_; }
  bool is_placed() const noexcept { return standing_; }

  /// Stands on the vertex nearest to `p_rest` (m, in the frame of the surface at rest). False where the model
  /// does not know the shapes there.
  bool place_near(const SurfaceModel& model, const Vec3& p_rest) noexcept;
  /// The force of the tool is borne by the surface as these loads are; none: where it stands.
  bool carry(const SurfaceModel& model, std::span<const VertexLoad> loads) noexcept;

  /// Goes on to the tick at `t`, under the force of the last.
  void advance(Time t) noexcept;
  /// The force on the tool at that tick, N, and the loads that it is about; remembers the tick.
  void apply_loads(const Vec3& f, std::span<const VertexLoad> loads = {}) noexcept;

  /// Returns the displacement (m) of the surface under the tool by the modes and by creep. It is that at the
  /// tick of `advance`, or at the sample of `take`, whichever came last.
  Vec3 displacement() const noexcept { return at(present_) + foot_.crept; }
  /// Returns the part of it that is creep, and the loads (N) that would hold all of it on the compliance.
  const Vec3& crept() const noexcept { return foot_.crept; }
  std::span<const VertexLoad> creeping() const noexcept { return loads_.creeping(); }
  /// Returns the creep of a vertex, m.
  Vec3 creep(const SurfaceModel& model, int vertex) const noexcept { return loads_.creep(model, vertex); }
  /// Returns the difference (m) of the displacement in the sample of `take` from the predicted one at that
  /// time; 0 where nothing was predicted.
  Vec3 drift() const noexcept { return drift_; }
  /// Returns the displacement (m) of a vertex with these shapes relative to the surface under the tool, by
  /// the present modes.
  Vec3 warp(const Shapes& shapes) const noexcept {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < system_.count; ++k) sum += present_[k] * (shapes[k] - foot_.shapes[k]);
    return sum;
  }

 private:
  bool take_spectrum(const Surface& surface) noexcept;
  void take_series(const protocol::RelaxedState& published) noexcept;
  void take_loads(const protocol::ModalLoads& published, Time t) noexcept;
  bool take_published(const Surface& surface) noexcept;
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
  std::uint64_t version_ = 0;  // of the surface model that the spectrum is of
  ModalSystem system_;
  ModalSteps short_step_;
  std::size_t first_published_ = 0, end_published_ = 0;  // of the modes whose z the newest sample tells of
  RelaxingLoads loads_;
  const SurfaceModel* model_ = nullptr;  // of the newest sample
  /// The vertex of the surface under the tool.
  struct Foot {
    std::uint64_t version = 0;  // of the surface model
    int vertex = 0;
    Vec3 crept = Vec3::Zero();  // its creep, m
    Shapes shapes{};
    Vec3 at = Vec3::Zero();  // m, of `place_near`
  } foot_;
  Shapes bearing_{};
  ModalState state_, published_;  // at `time_`; of the newest sample
  ModalNumbers force_{};          // of the tool, held from the last tick on, N/sqrt(kg)
  /// Load of other tools on the modes: a line in time from the sample at `t` on.
  struct Trend {
    Time t{};
    ModalNumbers load{}, rate{};  // N/sqrt(kg), and a second
    double at(std::size_t mode, Time now) const noexcept;
  };
  struct Others {
    Trend now, before;
    bool driven = false;  // whether there are others
  } others_;
  Time time_{}, tick_{}, tick_before_{}, compared_{};
  ModalNumbers present_{};
  Vec3 drift_ = Vec3::Zero();
  TickMemory<ModalState> past_;  // as it is known by now
};

}  // namespace palpate::client
