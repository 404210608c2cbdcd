#pragma once
#include <array>
#include <memory>
#include <vector>

#include "haptic_client/extrapolation/extrapolator.h"
#include "haptic_client/extrapolation/tick_memory.h"

namespace palpate::client {

/// Of several laws that run side by side, the one whose recent predictions were best. What a law gave at the
/// tick that a sample answers, from the samples of then, is its prediction of that sample: so the delay
/// counts, as it does for the hand. Each law has the mean size of its errors, over about the last 32
/// samples with contact; one that was better by a fifth takes over (follow the leader, with hysteresis), and
/// `ForceEstimate` blends it in. Of equals, and before the first sample, the last one. A tick costs what all
/// of them cost together.
/// While the tool cuts, and for eight samples from any cut on, tissue may be gone that no sample has told of
/// yet, and what is left is softer than all laws expect: none may give more than the largest of the last
/// eight samples (while it cuts, 3 % more), and from a cut on any law that was better takes over.
class BestRecent : public Extrapolator {
 public:
  struct Law {
    std::string_view name;
    std::unique_ptr<Extrapolator> law;
  };
  static constexpr std::size_t kMost = 8;

  /// 1 to `kMost` laws, the most trusted last.
  explicit BestRecent(std::vector<Law> laws);

  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  void surface_cut() noexcept override;
  void begin_tick(Time now) noexcept override;
  Vec3 force(const Vec3& p, Time t) noexcept override;
  Wants wants() const noexcept override;
  bool stepped_down() const noexcept override { return laws_[chosen_].law->stepped_down(); }
  std::string_view stand_in() const noexcept override;

 private:
  using Forces = std::array<Vec3, kMost>;  // N, of the laws
  void judge(const Forces& given, const Vec3& right) noexcept;
  bool after_cut() const { return cut_at_ > 0 && samples_ < cut_at_ + kAfterCut; }

  std::vector<Law> laws_;
  std::vector<char> sees_surface_;
  std::array<double, kMost> error_{};  // N, mean
  double judged_ = 0;                  // samples, up to those that the mean is of
  std::size_t chosen_;
  bool free_ = true, cutting_ = false;         // the newest sample saw no contact; its tool cut
  static constexpr std::size_t kAfterCut = 8;  // samples
  std::array<double, kAfterCut> sizes_{};      // N, of the last ones
  std::size_t samples_ = 0, cut_at_ = 0;       // so far; of those, when tissue was cut last, and one
  Time now_{};
  TickMemory<Forces> ticks_;
};

}  // namespace palpate::client
