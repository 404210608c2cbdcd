#pragma once
#include <limits>
#include <string>
#include <vector>

#include "common/error_table.h"
#include "common/force_jumps.h"
#include "haptic_client/evaluation/followed_contact.h"
#include "haptic_client/evaluation/truth.h"
#include "haptic_client/extrapolation/force_estimate.h"

namespace palpate::client {

/// Laws scored side by side: as many as a page can show.
constexpr std::size_t kMaxLaws = protocol::Telemetry::kMostLaws;

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
/// latency gives the paper's own protocol. Nothing is scored across an outage. Haptic thread, after the force
/// was written; no allocation.
class Scoring {
 public:
  /// `laws`: at most `kMaxLaws` names of `extrapolators()`; none: nothing is done. `where`: for the `Error`
  /// about a name.
  /// `blend` (s): see `ForceEstimate`. `truth`: the reference instead, of the `paper_` errors too; must
  /// outlive this.
  Scoring(const std::vector<std::string>& laws, double rate_hz, const std::string& where, double blend = 0,
          const Truth* truth = nullptr);

  /// Compares the force between samples with the truth, too, where there is one. Call it before the first
  /// tick.
  void judge_between_samples();

  /// Scores one tick with the tool at `p_W` (m) at `t`; `taken`: the sample that the pipeline took in this
  /// tick, or null. Scored ticks are added to `sums`.
  void tick(const Vec3& p_W, Time t, const Sample* taken, ErrorSums& sums) noexcept;

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
  /// After how many others a tick is scored at most, or never.
  static std::size_t longest_wait(double rate_hz);

 private:
  struct Pending {
    PathTick path;
    Vec3 moved;  // until the next tick, m
    std::array<Vec3, kMaxLaws> force;
    std::optional<Vec3> right = {};  // by the truth, N
    std::uint64_t number = 0;
  };
  void take(const Sample& sample, const PathTick& now, ErrorSums& sums) noexcept;
  void score_between(const Sample& before, const Sample& after, const PathTick& now,
                     ErrorSums& sums) noexcept;
  void score(const Pending& tick, const Vec3& reference, ErrorSums& sums) noexcept;
  void wait(const Pending& tick) noexcept;
  const Pending& pending(std::size_t i) const noexcept { return pending_[(first_ + i) % pending_.size()]; }

  UnexplainedJumps jumps_;
  std::vector<std::string> names_;
  std::vector<ForceEstimate> laws_;
  std::vector<ErrorTable> tables_, paper_;                // the latter against the line
  std::unique_ptr<FollowedContact> contact_;              // null: no law asks for the surface
  std::array<std::uint64_t, kReferenceKinds> between_{};  // ticks
  std::optional<ErrorTable> own_;                         // of the force between samples, against the truth
  double rate_hz_;
  std::array<Vec3, kMaxLaws> force_;
  std::array<Substitutes, kMaxLaws> substitutes_;
  std::uint64_t ticks_ = 0;
  std::vector<Pending> pending_;  // a ring: ticks that wait for the sample after them
  std::size_t first_ = 0, waiting_ = 0;
  std::uint64_t scored_ = 0;
  const Truth* truth_;
  std::array<double, kMaxLaws> excess_{};  // J
  double exchanged_ = 0;                   // J
  std::vector<ScoredTick> newly_scored_;
  std::uint64_t number_ = 0;  // of ticks so far
  Pending newest_{};          // not waiting yet: how far it moves is known at the next tick
  Vec3 place_ = Vec3::Zero();
  bool ticked_ = false;
};

}  // namespace palpate::client
