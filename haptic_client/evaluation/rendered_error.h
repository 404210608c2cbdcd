#pragma once
#include "common/error_table.h"

namespace palpate::client {

/// The force of a tick on its way to the hand, N, world frame.
struct RenderedForce {
  Vec3 law = Vec3::Zero();      ///< what the law said
  Vec3 faded = Vec3::Zero();    ///< what soft start and fades left of it
  Vec3 written = Vec3::Zero();  ///< what was written to the device, behind the whole safety chain
};

/// Error of the force on the hand, % of the root mean square of the force that was right. NaN: nothing was
/// touched.
struct RenderedErrorParts {
  ErrorSizes hand;                   ///< |written - right|
  double extrapolation_percent = 0;  ///< mean |law - right| between samples that follow each other
  double outages_percent = 0;        ///< the same where no sample came for longer than `kOutage`
  double fades_percent = 0;          ///< mean |faded - law|: soft start, fades of old and unsettled forces
  double limits_percent = 0;         ///< mean |written - faded|: passivity, damping, largest force and slew
};

/// Adds up by how much the force that was written to the device missed the one that was right, and why. By
/// the triangle inequality the mean error is at most the sum of its parts. Ticks count as in `ErrorTable`.
/// Haptic thread; does not allocate; costs about what `ErrorTable` does.
class RenderedError {
 public:
  explicit RenderedError(double rate_hz) : table_(rate_hz) {}
  /// Adds one tick, in the order of time. `outage`: no sample came for longer than `kOutage` around it.
  void add(const RenderedForce& rendered, const ReferenceForce& right, bool outage) noexcept;
  RenderedErrorParts parts() const noexcept;
  /// Returns how many ticks were added.
  std::uint64_t judged() const noexcept { return judged_; }

 private:
  ErrorTable table_;
  double extrapolation_ = 0, outages_ = 0, fades_ = 0, limits_ = 0, error_ = 0;  // N, sums
  std::uint64_t judged_ = 0;
};

}  // namespace palpate::client
