#pragma once
#include <array>
#include <memory>
#include <vector>

#include "haptic_client/extrapolation/extrapolator.h"
#include "haptic_client/extrapolation/tick_memory.h"

namespace palpate::client {

/// Law that follows the best recent predictions of several laws that run side by side. The prediction of a
/// sample is what a law returned at the tick that the sample answers, from the samples known then. So the
/// delay counts, as it does for the hand. Each law has the mean size of its errors, over about the last 32
/// samples with contact. A law that was better by a fifth takes over (follow the leader, with hysteresis),
/// and `ForceEstimate` blends it in. Among equals, and before the first sample, the last law is used. A tick
/// costs the sum of all laws. While the tool cuts, and for eight samples after any cut, tissue may be removed
/// that no sample accounts for yet. The remaining tissue is then softer than all laws expect. So no law may
/// exceed the largest force of the last eight samples (while it cuts, 3 % more). After a cut any law that was
/// better takes over.
class BestRecent : public Extrapolator {
 public:
  struct Law {
    std::string_view name;
    std::unique_ptr<Extrapolator> law;
  };
  static constexpr std::size_t kMost = 8;  ///< laws; `best_recent` has 7

  /// 1 to `kMost` laws, the most trusted last.
  explicit BestRecent(std::vector<Law> laws);

  void update(const Sample& sample) noexcept override;
  void restart() noexcept override;
  void surface_cut() noexcept override;
  void start_tick(Time now) noexcept override;
  Vec3 force(const Vec3& p, Time t) noexcept override;
  Request request() const noexcept override;
  bool stepped_down() const noexcept override { return laws_[chosen_].law->stepped_down(); }
  std::string_view substitute() const noexcept override;

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
