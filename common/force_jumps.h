#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/histogram.h"
#include "common/report.h"
#include "common/time.h"
#include "common/types.h"

namespace palpate {

/// Jumps of a force over a run.
struct ForceJumps {
  std::uint64_t count = 0;     ///< of more than 5 % of the largest |F|
  double largest_percent = 0;  ///< the largest one, also where it is smaller, of the largest |F|
};

/// Writes the two as `NAMEs` and `largest_NAME_percent`; nothing where they were not measured.
void add_to(Json& report, const std::string& name, const std::optional<ForceJumps>& jumps);
/// Returns what `add_to` wrote; nothing where it is absent, or null.
std::optional<ForceJumps> jumps_in(const Json& report, const std::string& name);
/// Returns "the force of the simulation itself jumped 2 times, largest 45.8 % of peak".
std::string snaps_text(const ForceJumps& snaps);
/// Returns such a sentence on the jumps that `UnexplainedJumps` counts.
std::string unexplained_text(const ForceJumps& jumps);

/// Sizes of jumps in flat memory (40 KiB), counted against a peak that is known only at the end. The bound of
/// 5 % holds within 0.4 %.
class JumpSizes {
 public:
  void add(double newton) noexcept;
  void see_force(double newton) noexcept;
  /// Nothing before a force.
  std::optional<ForceJumps> of_peak() const noexcept;

 private:
  Histogram nN_;
  double peak_ = 0, largest_ = 0;
};

/// Counts the snaps of a simulation along a densely sampled motion: changes of force within 0.5 ms that the
/// motion does not explain. With dF = F(t + 0.5 ms) - F(t), the motion explains each change between those of
/// the 1 ms before t and of the 1 ms after t + 0.5 ms, scaled to 0.5 ms; a snap is the distance of dF from
/// the line between those two. It is the height of a step on any ramp, and zero where the speed changes, at
/// the onset of contact of a spring and, to third order, on any smooth motion, however fast. Of changes less
/// than 0.5 ms apart the largest counts. Times are rounded to samples, so that the count does not depend on
/// their rate. One thread.
class SnapCounter {
 public:
  static constexpr double kLeastRate = 1999;  ///< Hz, less than which nothing is counted

  /// `rate_hz`: of the samples.
  explicit SnapCounter(double rate_hz);

  /// Adds the force (N) at `t`, in the order of time. Counts nothing across a gap.
  void add(const Vec3& force, Time t);
  /// Nothing where samples were too slow or never pushed.
  std::optional<ForceJumps> snaps() const;

 private:
  const Vec3& back(std::size_t samples) const { return ring_[(added_ - 1 - samples) % ring_.size()]; }
  double unexplained() const;

  Time gap_;
  std::size_t within_, around_;  // samples in 0.5 ms and in 1 ms
  std::vector<Vec3> ring_;       // the newest forces, N
  std::size_t added_ = 0;        // since the last gap
  Time last_{};
  JumpSizes sizes_;
  double candidate_ = 0;          // N, the largest change of late
  std::size_t candidate_at_ = 0;  // as `added_`
};

/// A force as a server publishes it, with what that says of its neighbourhood.
struct PublishedForce {
  std::uint64_t number = 0;  ///< of the sample; it begins again in a new session
  Time t{};
  Vec3 p = Vec3::Zero(), f = Vec3::Zero();  ///< m, N; of the tool
  Vec3 surface_v = Vec3::Zero();            ///< of the organ there, m/s
  std::optional<Mat3> tangent = {};         ///< dF/dp, N/m
  std::uint32_t cuts = 0;                   ///< another number: another surface
};

/// Counts jumps between consecutive samples of a session, at their own rate, that the published linearisation
/// does not explain: with d the motion of the tool relative to the organ, the tangents explain each change
/// between K_n d and K_(n+1) d (K = 0 where the tool is free), and a jump is the distance of F_(n+1) - F_n
/// from the line between the two. A snap is one, and so is a force that curves between two samples more than
/// both tangents say. Not counted between samples more than 0.3 s apart, without tangents, of two sessions or
/// of different cuts. No allocation.
class UnexplainedJumps {
 public:
  void add(const PublishedForce& sample) noexcept;
  /// Nothing before two samples with tangents.
  std::optional<ForceJumps> jumps() const noexcept;

 private:
  JumpSizes sizes_;
  std::optional<PublishedForce> last_;
  std::uint64_t pairs_ = 0;
};

}  // namespace palpate
