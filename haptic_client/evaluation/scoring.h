#pragma once
#include <limits>
#include <string>
#include <vector>

#include "common/error_table.h"
#include "common/force_jumps.h"
#include "haptic_client/evaluation/past_ticks.h"
#include "haptic_client/evaluation/truth.h"
#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {

/// Errors of all scored laws in one stretch of time. Adds up, for `Timeline`.
struct ErrorSums {
  double contact = 0, reference_squared = 0;  ///< ticks in which the reference pushes; N^2, sum
  std::array<double, kMaxLaws> error{};       ///< N, sum of |e| per law
  ErrorSums& operator+=(const ErrorSums& other) noexcept;
};

/// Runs laws beside the rendered one, on the same samples and motion, and scores each when the
/// next sample arrives: the reference is the force on the path really taken between two samples
/// (`BetweenSamples`), compared with what the law gave at each tick t_n <= t < t_(n+1), with the samples it
/// had then. So the latency of the link counts, as it does for the hand. The `paper_` errors have the
/// straight line in time (Picinbono and Lombardo 1999, section 4) as their reference; a capture without
/// latency gives the paper's own protocol. No law is scored across an outage; what was rendered is, also
/// where no law is. Haptic thread, after the force was written; no allocation.
class Scoring {
 public:
  /// `laws`: at most `kMaxLaws` names of `extrapolators()`. `where`: for the `Error` about a name.
  /// `blend` (s): see `ForceEstimate`. `truth`: the reference instead, of the `paper_` errors too; must
  /// outlive this.
  Scoring(const std::vector<std::string>& laws, double rate_hz, const std::string& where, double blend = 0,
          const Truth* truth = nullptr);

  /// Compares the force between samples with the truth, too, where there is one. Call it before the first
  /// tick.
  void judge_between_samples();

  /// Scores one tick with the tool at `p_W` (m) at `t`; `taken`: the sample that the pipeline took in this
  /// tick, or null; `rendered`: the force on the hand that holds the tool, if one does. Scored ticks are
  /// added to `sums`.
  void tick(const Vec3& p_W, Time t, const Sample* taken, ErrorSums& sums,
            const std::optional<RenderedForce>& rendered = {}) noexcept;

  /// Returns the data that the laws use beyond the triplet.
  Request request() const noexcept;
  const std::vector<std::string>& names() const noexcept { return names_; }
  ErrorMetrics metrics(std::size_t law) const noexcept;
  /// Returns how many ticks between samples had this reference force, and which kind most had; without a
  /// truth they were scored against it.
  std::uint64_t between(ReferenceKind kind) const noexcept {
    return between_[static_cast<std::size_t>(kind)];
  }
  ReferenceKind mostly_between() const noexcept;
  /// The own error of that force; nothing unless `judge_between_samples`.
  ErrorMetrics between_metrics() const noexcept { return own_ ? own_->metrics() : ErrorMetrics{}; }
  /// Work that the law did on the tool beyond that of the reference, in percent of what the reference
  /// exchanged with it both ways; on a closed path in an elastic tissue that energy comes from nowhere. NaN:
  /// there was none.
  double energy_percent(std::size_t law) const noexcept {
    return exchanged_ > 0 ? 100 * excess_[law] / (exchanged_ / 2) : std::numeric_limits<double>::quiet_NaN();
  }
  /// Returns the jumps between the samples that were taken; nothing where they had no tangents.
  std::optional<ForceJumps> unexplained_jumps() const noexcept { return jumps_.jumps(); }
  /// Error of what was rendered, in the ticks that could be judged.
  const RenderedError& rendered() const noexcept { return rendered_; }
  /// See `PastTicks`.
  std::uint64_t unjudged() const noexcept { return past_.unjudged(); }
  std::uint64_t unsettled() const noexcept { return past_.unsettled(); }
  /// Which simpler laws stood in for it, in how many of `ticks()`.
  const Substitutes& substitutes(std::size_t law) const noexcept { return substitutes_[law]; }
  std::uint64_t ticks() const noexcept { return ticks_; }    ///< since the first sample
  std::uint64_t scored() const noexcept { return scored_; }  ///< ticks
  /// Returns the forces of the laws at the newest tick, N, world.
  const std::array<Vec3, kMaxLaws>& forces() const noexcept { return force_; }

  /// A tick, counted from 0, and the force that the laws were held against there, N, world.
  struct ScoredTick {
    std::uint64_t number = 0;
    Vec3 reference;
  };
  /// Returns the ticks that the last `tick` scored; they are earlier ones.
  std::span<const ScoredTick> newly_scored() const noexcept { return newly_scored_; }

 private:
  void take(const Sample& sample, const PathTick& now, ErrorSums& sums) noexcept;
  void judge(const PastTick& tick, const RightForce& right, ErrorSums& sums) noexcept;
  void score(const PastTick& tick, const Vec3& right, ErrorSums& sums) noexcept;

  UnexplainedJumps jumps_;
  std::vector<std::string> names_;
  std::vector<ForceEstimate> laws_;
  std::vector<ErrorTable> tables_, paper_;  // the latter against the line
  PastTicks past_;
  RenderedError rendered_;
  std::array<std::uint64_t, kReferenceKinds> between_{};  // ticks
  std::optional<ErrorTable> own_;                         // of the force between samples, against the truth
  double rate_hz_;
  std::array<Vec3, kMaxLaws> force_;
  std::array<Substitutes, kMaxLaws> substitutes_;
  std::uint64_t ticks_ = 0;
  std::uint64_t scored_ = 0;
  const Truth* truth_;
  std::array<double, kMaxLaws> excess_{};  // J
  double exchanged_ = 0;                   // J
  std::vector<ScoredTick> newly_scored_;
  std::uint64_t number_ = 0;  // of ticks so far
  PastTick newest_{};         // not waiting yet: how far it moves is known at the next tick
  Vec3 place_ = Vec3::Zero();
  bool ticked_ = false;
};

}  // namespace palpate::client
